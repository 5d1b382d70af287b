#include "coordinator/planning/plan.h"

#include <algorithm>

namespace skyquilt::coordinator {
namespace {

// Poses may have used up everything: then training gets so much of the total, to show anything at all.
constexpr double kLeastTrainingOfTotal = 0.02;
constexpr double kWorthwhile_s = 0.05;
constexpr double kRounding_s = 1e-6;

struct PlanTimes {
  double before_s = 0.0, after_s = 0.0;  // of training; without a training all is after it
};

PlanTimes TimesOf(const PlanRequest& request, const Settings& settings) {
  PlanTimes times;
  bool before = std::find(request.stages.begin(), request.stages.end(), "train") != request.stages.end();
  for (const std::string& stage : request.stages) {
    if (stage == "train") {
      before = false;
    } else {
      (before ? times.before_s : times.after_s) += request.seconds(stage, settings);
    }
  }
  return times;
}

}  // namespace

double Plan::Seconds() const {
  double sum = 0.0;
  for (const PlannedStage& stage : stages) sum += stage.seconds;
  return sum;
}

const PlannedStage* Plan::Find(const std::string& stage) const {
  const auto found = std::find_if(stages.begin(), stages.end(), [&stage](const PlannedStage& one) { return one.name == stage; });
  return found == stages.end() ? nullptr : &*found;
}

Plan MakePlan(const PlanRequest& request) {
  Plan plan{.within_s = request.within_s, .used_s = request.used_s};
  Settings settings = request.settings;
  const bool trains = std::find(request.stages.begin(), request.stages.end(), "train") != request.stages.end();
  const double planned_s = kPlannedShare * std::max(0.0, request.within_s - request.used_s);
  PlanTimes times = TimesOf(request, settings);
  const auto left_s = [&] { return std::max(0.0, planned_s - times.before_s); };
  const auto least_training_s = [&] {
    return request.fixed_training_s.value_or(std::max(kTrainingShare * left_s(), kLeastTrainingOfTotal * request.within_s));
  };
  const auto fits = [&] { return trains ? times.after_s + least_training_s() <= left_s() + kRounding_s : times.after_s <= planned_s + kRounding_s; };
  for (const Reduction& reduction : request.reductions) {
    if (fits()) break;
    Settings less = settings;
    Apply(reduction, &less);
    const PlanTimes saved = TimesOf(request, less);
    if (saved.before_s + saved.after_s > times.before_s + times.after_s - kWorthwhile_s) continue;
    settings = std::move(less);
    times = saved;
    plan.reductions.push_back(reduction);
  }
  plan.image_width = settings.run.image_width;
  plan.feasible = fits();
  if (trains) {
    plan.training_s = request.fixed_training_s.value_or(std::max(least_training_s(), left_s() - times.after_s));
  }
  for (const std::string& stage : request.stages) {
    const double seconds = stage == "train" ? plan.training_s : request.seconds(stage, settings);
    if (seconds > 0.0) plan.stages.push_back({stage, seconds});
  }
  return plan;
}

}  // namespace skyquilt::coordinator
