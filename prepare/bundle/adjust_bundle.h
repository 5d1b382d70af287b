// Bundle adjustment (Triggs et al., Bundle Adjustment - A Modern Synthesis, 2000) with Ceres: poses, lenses and points at once.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "prepare/bundle/bundle_problem.h"

namespace skyquilt::prepare::bundle {

struct BundleStage {
  // Errors beyond this many units lose weight: linear in the error (Huber) when `gentle`, else (Cauchy) almost all of it.
  double loss = 1.0;
  bool gentle = false;
  bool free_lens = true;
  bool lens_prior = true;        // free lenses are held near their initial numbers (LensSigma)
  double gps_factor = 1.0;       // on the accuracy of the positions
  double angle_sigma_deg = 3.0;  // of the tagged directions
  int max_iterations = 20;
  double tolerance = 1e-4;                 // stops when the cost falls by less than this share
  std::span<const KnownPoint> known = {};  // points of `tracks` with a measured place, at most one per track
  double known_loss = 3.0;                 // errors of their places beyond this many sigmas count linearly
};

// What a lens may be without having been measured, one standard deviation of each number from its initial value.
Lens LensSigma(const BundleLens& lens);
// Numbers of a lens that stay what they are.
std::vector<int> HeldNumbersOf(const BundleLens& lens);
// Positions with an error beyond this many sigmas lose almost all weight (Cauchy).
constexpr double kTagLoss = 2.0;

// Adjusts all placed photos that are not held and the points of `tracks` to the entries that agree. The placed photos of a shot get one pose, and the
// tags of its first tagged one count for it. Uses one thread: with several, Ceres adds what points say about photos in the order in which the threads
// come to them, so that two runs on one machine would differ, and poses with them. Throws base::Interrupted. False when no solution is found; then
// nothing has changed. `on_iteration` is called after each. `shift`: of the positions, with its value to begin with; null: none.
bool AdjustBundle(BundleProblem& bundle, std::span<const uint32_t> tracks, const BundleStage& stage, const std::function<void()>& on_iteration,
                  Eigen::Vector3d* shift = nullptr);

}  // namespace skyquilt::prepare::bundle
