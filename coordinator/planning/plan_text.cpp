#include "coordinator/planning/plan_text.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "core/base/amounts.h"
#include "core/base/json_text.h"

namespace skyquilt::coordinator {
namespace {

constexpr std::array<double, 19> kUsualMinutes = {1, 2, 3, 5, 7, 10, 15, 20, 30, 45, 60, 90, 120, 180, 240, 360, 480, 720, 1440};

double UsualFrom(double seconds) {
  const auto found =
      std::find_if(kUsualMinutes.begin(), kUsualMinutes.end(), [seconds](double minutes) { return 60.0 * minutes >= 0.999 * seconds; });
  return 60.0 * (found == kUsualMinutes.end() ? kUsualMinutes.back() : *found);
}

}  // namespace

std::string PlanText(const Plan& plan) {
  std::string text = fmt::format("plan for {} in all", base::FormatDuration(plan.within_s));
  if (plan.used_s >= 1.0) text += fmt::format(", of which {} are used", base::FormatDuration(plan.used_s));
  text += fmt::format("; the end after {}", base::FormatDuration(plan.EndS()));
  if (plan.image_width > 0) text += fmt::format("; photos are trained at a width of {} pixels at most", plan.image_width);
  for (const PlannedStage& stage : plan.stages) text += fmt::format("\n  {:<10} {:>8}", stage.name, base::FormatDuration(stage.seconds));
  for (const std::string& given_up : TextsOf(plan.reductions)) text += "\n  for this: " + given_up;
  if (!plan.feasible) {
    text += "\n  this is too short: what can be given up is given up, training has its least share, and the run may take longer";
  }
  return text;
}

std::string NeedsText(const Needs& needs, const Room& room) {
  return fmt::format("memory for training {}B of {}B, disk {}B of {}B that are free", base::FormatCount(needs.memory),
                     base::FormatCount(room.memory_limit), base::FormatCount(needs.disk), base::FormatCount(room.disk));
}

nlohmann::ordered_json PlanJson(const Plan& plan) {
  nlohmann::ordered_json stages = nlohmann::ordered_json::object();
  for (const PlannedStage& stage : plan.stages) stages[stage.name] = stage.seconds;
  return {{"within_s", plan.within_s},
          {"used_s", plan.used_s},
          {"end_s", plan.EndS()},
          {"training_s", plan.training_s},
          {"image_width", plan.image_width},
          {"stages", stages},
          {"given_up", TextsOf(plan.reductions)},
          {"feasible", plan.feasible}};
}

nlohmann::ordered_json NeedsJson(const Needs& needs, const Room& room) {
  return {{"memory_bytes", needs.memory},
          {"least_memory_bytes", needs.least_memory},
          {"memory_limit_bytes", room.memory_limit},
          {"disk_bytes", needs.disk},
          {"free_disk_bytes", base::NumberOrNull(room.disk)}};
}

std::string TimesJson(const evaluate::metrics::RunTimes& times) {
  nlohmann::ordered_json stages = nlohmann::ordered_json::array();
  for (const evaluate::metrics::StageTimes& stage : times.stages) {
    stages.push_back({{"stage", stage.stage},
                      {"planned_s", base::NumberOrNull(stage.planned_s)},
                      {"predicted_s", base::NumberOrNull(stage.predicted_s)},
                      {"took_s", base::NumberOrNull(stage.took_s)}});
  }
  const nlohmann::ordered_json json = {{"within_s", times.within_s}, {"used_s", times.used_s}, {"stages", stages}, {"given_up", times.given_up}};
  return base::JsonText(json, 2) + "\n";
}

std::vector<double> UsualTotals(const std::function<Plan(double within_s)>& whole) {
  double middle = 60.0 * kUsualMinutes.back();
  for (const double minutes : kUsualMinutes) {
    const Plan plan = whole(60.0 * minutes);
    if (!plan.feasible || !plan.reductions.empty()) continue;
    middle = 60.0 * minutes;
    break;
  }
  std::vector<double> totals = {UsualFrom(middle / 3.0), middle, UsualFrom(3.0 * middle)};
  std::sort(totals.begin(), totals.end());
  totals.erase(std::unique(totals.begin(), totals.end()), totals.end());
  return totals;
}

}  // namespace skyquilt::coordinator
