// Divides the time of a run among its stages, and decides what is given up for it. Pure: no clock, no files, no ranks.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/planning/reductions.h"
#include "coordinator/project/settings.h"

namespace skyquilt::coordinator {

// Of the time that is left this share is planned; the rest is for what was not foreseen.
constexpr double kPlannedShare = 0.96;
// Training gets at least this share of what is left after the poses.
constexpr double kTrainingShare = 0.5;

struct PlannedStage {
  std::string name;
  double seconds = 0.0;
};

struct Plan {
  double within_s = 0.0;              // the total
  double used_s = 0.0;                // of it, before this plan
  std::vector<PlannedStage> stages;   // that are still to be done, in their order; those that are not made are left out
  int image_width = 0;                // of photos in training, pixels; 0: full size
  double training_s = 0.0;            // of stage "train", decoding of photos and set-up included; 0 when it is done
  std::vector<Reduction> reductions;  // of those that were offered
  bool feasible = true;               // false: too little time, although all that helps was given up

  double Seconds() const;  // of all stages
  double EndS() const { return used_s + Seconds(); }
  const PlannedStage* Find(const std::string& stage) const;  // null: not made, or done
};

struct PlanRequest {
  double within_s = 0.0;
  double used_s = 0.0;
  std::vector<std::string> stages;         // that are still to be done, in their order
  Settings settings = {};                  // before any of `reductions`
  std::vector<Reduction> reductions = {};  // that may still be made, in the order in which they give way
  // Predicted; 0: not made. "train" is not asked for.
  std::function<double(const std::string& stage, const Settings& settings)> seconds;
  std::optional<double> fixed_training_s;  // the user gave the training time or steps: it is taken as it is
};

// Gives up as little as possible, in the order of request.reductions and only what saves time, until all stages end in time and training has
// kTrainingShare of what is left after the poses. What is left then goes to training. Where nothing more can be given up, training gets that share
// all the same and the plan is not feasible. More time never means that more is given up.
Plan MakePlan(const PlanRequest& request);

}  // namespace skyquilt::coordinator
