// Says in words what is wrong with control points, and what to do about it.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/survey/control_fit.h"
#include "core/survey/geo_fit.h"
#include "prepare/control/fit/control_similarity.h"
#include "prepare/control/reading/control_points.h"

namespace skyquilt::prepare::control {

// Why the survey cannot be placed by control points, as a sentence without its full stop, and what to do.
struct NoControl {
  std::string finding, advice;
};
// `usable`: labels of the control points with height and at least two marks that agree.
NoControl WhyNoControl(SimilarityFailure failure, const std::vector<std::string>& usable);

// Why there was no adjustment.
enum class NotAdjusted { kNo, kNoObservations, kUnknownLens, kNoSolution };

// The worst first. `misfit`: see ControlAdjustment; `fit` is complete.
std::vector<survey::Problem> ControlProblems(const ControlPoints& control, const survey::ControlFit& fit, NotAdjusted not_adjusted, double misfit);

}  // namespace skyquilt::prepare::control
