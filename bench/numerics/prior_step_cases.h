// Cases of the group of priors that train: steps with weights of any size, without any, and their gradients against double.
#pragma once

#include <vector>

#include "bench/numerics/numeric_case.h"
#include "bench/numerics/synthetic_scene.h"
#include "core/survey/survey.h"

namespace skyquilt::bench {

std::vector<NumericCase> PriorStepCases(bool quick);

// Sparse points of a level surface in the synthetic scene.
survey::Survey LevelPoints(const SyntheticOptions& scene, double height_m);

}  // namespace skyquilt::bench
