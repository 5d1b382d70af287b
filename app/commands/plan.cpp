#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/command.h"
#include "app/settings/duration.h"
#include "coordinator/planning/measure_rates.h"
#include "coordinator/planning/needs.h"
#include "coordinator/planning/plan_text.h"
#include "coordinator/stages/photo_inputs.h"
#include "coordinator/stages/timed_run.h"
#include "core/base/amounts.h"
#include "core/base/errors.h"
#include "core/base/json_text.h"
#include "core/base/system.h"
#include "core/base/thread_pool.h"
#include "prepare/input/zones.h"

namespace skyquilt::app {
namespace {

struct PlanFlags {
  std::vector<std::string> photos;
  std::string model;
  std::string out = ".";
  std::vector<std::string> within;
  int ranks = 1, machines = 1;
  bool json = false;
};

// The folder of the photos; of several ones a folder with links to them, which ends with this.
class PhotosToPlan {
 public:
  PhotosToPlan(const std::vector<std::string>& photos, std::filesystem::path links) : links_(std::move(links)) {
    for (const std::string& folder : photos) {
      if (std::filesystem::is_directory(folder)) continue;
      throw base::InputError(folder, "no such folder",
                             "Give the folder that holds the photos; of videos, 'skyquilt prepare VIDEO -o DIR' makes photos in DIR/survey/frames");
    }
    const std::vector<std::filesystem::path> zones = coordinator::ZonesAmong(photos);
    folder_ = zones.empty() ? std::filesystem::path(photos.front()) : prepare::input::LinkZones(zones, links_);
  }
  ~PhotosToPlan() {
    std::error_code ignored;
    std::filesystem::remove_all(links_, ignored);
  }
  PhotosToPlan(const PhotosToPlan&) = delete;
  PhotosToPlan& operator=(const PhotosToPlan&) = delete;

  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path links_, folder_;
};

// The totals that were asked for, or usual ones.
std::vector<double> TotalsOf(const PlanFlags& flags, const coordinator::Settings& settings, const coordinator::Predictor& predictor,
                             const coordinator::Room& room) {
  std::vector<double> totals;
  for (const std::string& text : flags.within) totals.push_back(ParseDurationSeconds(text));
  if (!totals.empty()) return totals;
  if (settings.run.within_s > 0.0) return {settings.run.within_s};
  return coordinator::UsualTotals([&](double within_s) { return coordinator::PlanOfNewRun(predictor, settings, within_s, room); });
}

struct PlanAndNeeds {
  coordinator::Plan plan;
  coordinator::Needs needs;
};

void PrintPlans(const PlanFlags& flags, const coordinator::WorkSize& size, const std::vector<PlanAndNeeds>& plans, const coordinator::Needs& needs,
                const coordinator::Room& room, const coordinator::Rates& rates) {
  if (flags.json) {
    nlohmann::ordered_json json = {{"photos", size.photos},
                                   {"held_out", size.held_out},
                                   {"photo_pixels", size.photo_pixels},
                                   {"ranks", size.ranks},
                                   {"rates",
                                    {{"decoded_pixels", rates.decoded_pixels},
                                     {"feature_pixels", rates.feature_pixels},
                                     {"matched_pairs", rates.matched_pairs},
                                     {"samples", rates.samples},
                                     {"rays", rates.rays}}},
                                   {"needs", coordinator::NeedsJson(needs, room)},
                                   {"plans", nlohmann::ordered_json::array()}};
    for (const PlanAndNeeds& one : plans) {
      json["plans"].push_back(coordinator::PlanJson(one.plan));
      json["plans"].back()["needs"] = coordinator::NeedsJson(one.needs, room);
    }
    std::cout << base::JsonText(json, 2) << "\n";
    return;
  }
  std::cout << fmt::format("{} photos of {}pixels, {} held out; {} rank(s) on {} machine(s) such as {}\n", size.photos,
                           base::FormatCount(size.photo_pixels), size.held_out, size.ranks, size.machines, base::MachineDescription())
            << fmt::format("measured: {} training samples/s, {}pixels/s searched for features, {:.0f} pairs/s; guessed: {} rays/s\n",
                           base::FormatCount(rates.samples), base::FormatCount(rates.feature_pixels), rates.matched_pairs,
                           base::FormatCount(rates.rays));
  for (const PlanAndNeeds& one : plans) {
    std::cout << "\n" << coordinator::PlanText(one.plan) << "\n  " << coordinator::NeedsText(one.needs, room) << "\n";
  }
}

void ShowPlans(const CommandState& state, const PlanFlags& flags, const std::vector<config::Override>& overrides) {
  const coordinator::Settings settings = state.Load({}, overrides);
  const std::string trial = "skyquilt_plan_" + fmt::format("{:016x}", std::hash<std::string>{}(base::UtcTimestamp() + flags.photos.front()));
  const std::filesystem::path temporary = std::filesystem::temp_directory_path();
  const PhotosToPlan photos(flags.photos, temporary / (trial + "_zones"));
  if (flags.machines > flags.ranks) throw base::UsageError("--machines is more than --ranks: every machine needs a rank");
  base::ThreadPool threads(settings.run.threads);
  coordinator::WorkSize size = coordinator::CountPhotos(photos.folder(), flags.model, settings, {}, threads);
  size.ranks = flags.ranks;
  size.machines = flags.machines;
  const coordinator::Rates rates =
      coordinator::MeasureRates(size, settings, {.photos = photos.folder(), .model = flags.model, .work_folder = temporary / trial}, threads);
  const coordinator::Predictor predictor(size, rates);
  const coordinator::Needs needs = coordinator::NeedsOf(size, settings);
  const coordinator::Room room = coordinator::RoomFor(flags.out, settings);
  std::vector<PlanAndNeeds> plans;
  for (const double within_s : TotalsOf(flags, settings, predictor, room)) {
    const coordinator::Plan plan = coordinator::PlanOfNewRun(predictor, settings, within_s, room);
    coordinator::Settings planned = settings;
    planned.run.image_width = plan.image_width;
    plans.push_back({plan, coordinator::NeedsOf(size, planned)});
  }
  PrintPlans(flags, size, plans, needs, room, rates);
  // Told last, so that the reason is seen beside the numbers.
  coordinator::RequireRoom(needs, room, flags.out);
}

}  // namespace

void AddPlan(CLI::App& app, CommandState& state) {
  const auto flags = std::make_shared<PlanFlags>();
  const auto overrides = std::make_shared<std::vector<config::Override>>();
  CLI::App* command = app.add_subcommand("plan", "say in seconds what a run of photos would take: time of each stage, memory, disk");
  command->add_option("photos", flags->photos, "folder with photos, several of them, or a simulated survey")->required()->type_name("FOLDER...");
  command->add_option("-o,--out", flags->out, "project folder that the run would have, for its free disk; default: this folder")->type_name("FOLDER");
  command->add_option("--within", flags->within, "total times to plan for, such as 5min,20min,1h; default: three that suit the photos")
      ->delimiter(',')
      ->type_name("TIME,...");
  command->add_option("--ranks", flags->ranks, "plan for so many ranks under mpirun; default: 1")->check(CLI::Range(1, 100000))->type_name("N");
  command->add_option("--machines", flags->machines, "that the ranks are on, each as fast as this one; default: 1")
      ->check(CLI::Range(1, 100000))
      ->type_name("N");
  AddModelFlag(*command, flags->model);
  AddOptionFlag(*command, overrides, "--image-width", "run.image_width",
                "scale photos down to this width in pixels for training and scoring; 0: full size; auto: by the time");
  AddMemoryFlag(*command, overrides);
  command->add_flag("--json", flags->json, "print JSON");
  command->footer(
      "Examples:\n"
      "  skyquilt plan photos/\n"
      "  skyquilt plan photos/ --within 10min,1h --config quality\n"
      "  skyquilt plan photos/ --ranks 9 --machines 4\n"
      "Nothing is written. Exit status 2 or 3 when memory or disk cannot be enough.");
  command->callback([&state, flags, overrides] { state.run_command = [&state, flags, overrides] { ShowPlans(state, *flags, *overrides); }; });
}

}  // namespace skyquilt::app
