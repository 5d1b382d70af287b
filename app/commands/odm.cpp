#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <new>

#include "app/commands/command.h"
#include "app/settings/duration.h"
#include "app/settings/presets.h"
#include "core/base/amounts.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/system.h"
#include "core/base/thread_pool.h"
#include "odm/dataset_lock.h"
#include "odm/map_options.h"
#include "odm/option_table.h"
#include "odm/quality.h"
#include "odm/request.h"
#include "odm/run_odm.h"

namespace skyquilt::app {
namespace {

constexpr int kOutOfMemory = 137;  // what NodeODM shows as "not enough memory"

struct OdmSettings {
  coordinator::Settings settings;
  std::optional<coordinator::Settings> level;
};

double TimeBudgetSeconds(const std::string& text) {
  try {
    return ParseDurationSeconds(text);
  } catch (const base::UsageError& error) {
    throw base::UsageError(std::string("--skyquilt-time-budget: ") + error.what());
  }
}

// Defaults, then the preset, then OpenDroneMap's options, then the file of --skyquilt-config, then --skyquilt-time-budget.
OdmSettings SettingsOf(const CommandState& state, const odm::Request& request, const odm::Dataset& dataset, const odm::Effort& effort) {
  const std::string named = request.Text("--skyquilt-config");
  const std::vector<std::string> presets = ConfigNames();
  const bool is_preset = std::find(presets.begin(), presets.end(), named) != presets.end() && !std::filesystem::is_regular_file(named);
  const std::string boundary = odm::ProvideBoundary(request, dataset);
  CommandState preset = state;
  preset.config = is_preset ? named : effort.preset;
  OdmSettings made{.settings = preset.Load({}, {}), .level = preset.LoadForLevelPhotos({})};
  const auto finish = [&](coordinator::Settings settings) {
    odm::ApplyRequest(request, dataset, effort, 0.0, boundary, &settings);
    if (!named.empty() && !is_preset) {
      CommandState file = state;
      file.config = named;
      settings = file.LoadOver(std::move(settings));
    }
    const std::string budget = request.Text("--skyquilt-time-budget");
    if (!budget.empty()) settings.run.time_budget_s = TimeBudgetSeconds(budget);
    // A file may ask for steps or for seconds instead.
    const bool decided = settings.run.time_budget_s > 0.0 || settings.train.steps > 0 || settings.train.seconds > 0.0;
    if (!decided) settings.run.time_budget_s = effort.training_s;
    return settings;
  };
  made.settings = finish(std::move(made.settings));
  if (made.level) made.level = finish(*std::move(made.level));
  made.settings.Check();
  return made;
}

void RunOdmCommand(const CommandState& state, const std::vector<std::string>& words) {
  const odm::Request request = odm::Request::Parse(words);
  if (request.help()) {
    fmt::print("Usage: skyquilt odm --project-path FOLDER [options] NAME\n\nOpenDroneMap's command line: photos are in FOLDER/NAME/images.\n\n{}",
               odm::OptionsHelp());
    return;
  }
  if (request.version()) {
    fmt::print("skyquilt {}\n", SKYQUILT_VERSION);
    return;
  }
  const int threads = request.Has("--max-concurrency") ? static_cast<int>(std::clamp(request.Number("--max-concurrency"), 0.0, 4096.0)) : 0;
  base::ThreadPool pool(threads);
  const odm::Dataset dataset = odm::FindDataset(request, pool);
  const coordinator::Project project = coordinator::Project::Create(dataset.project);
  const odm::DatasetLock lock(project.folder);
  const odm::Workload workload{.photos = dataset.photos, .megapixels = dataset.megapixels, .cores = pool.size()};
  const odm::Effort effort =
      odm::EffortOf(request.Text("--pc-quality"), request.Text("--feature-quality"), request.Has("--fast-orthophoto"), workload);
  OdmSettings made = SettingsOf(state, request, dataset, effort);
  coordinator::Pipeline pipeline = state.Begin(project, std::move(made.settings), false);
  pipeline.level_settings = std::move(made.level);
  base::LogInfo("Skyquilt {} with OpenDroneMap's options: {} photo(s) of {:.1f} megapixels, {} thread(s)", SKYQUILT_VERSION, workload.photos,
                workload.megapixels, workload.cores);
  if (pipeline.settings.run.time_budget_s > 0.0) {
    base::LogInfo("training takes about {}; --skyquilt-time-budget sets another time", base::FormatDuration(pipeline.settings.run.time_budget_s));
  }
  for (const std::string& line : odm::OpeningLines(request, dataset)) base::LogInfo("{}", line);
  odm::RunOdm(pipeline, request, dataset);
  base::LogInfo("results are in {}", dataset.folder.string());
}

}  // namespace

void AddOdm(CLI::App& app, CommandState& state) {
  CLI::App* command = app.add_subcommand("odm", "OpenDroneMap's command line and folders, for NodeODM and WebODM: 'skyquilt odm --help'");
  // What follows was not given to the parser (cli.cpp): its options are OpenDroneMap's.
  command->callback([&state] {
    const auto out_of_memory = std::make_shared<bool>(false);
    state.run_command = [&state, out_of_memory] {
      try {
        RunOdmCommand(state, state.rest);
      } catch (const std::bad_alloc&) {
        *out_of_memory = true;
        throw;
      }
    };
    state.status_for_caller = [out_of_memory](int status) { return *out_of_memory ? kOutOfMemory : odm::StatusForCaller(status); };
  });
}

}  // namespace skyquilt::app
