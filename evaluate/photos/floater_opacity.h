// Measures floaters, density in the free space in front of surfaces: the opacity of rays from the camera to just in front of the true surface, which
// should be 0. Needs the true depth of a simulated survey.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/scene/scene.h"
#include "evaluate/photos/photo_scorer.h"

namespace skyquilt::evaluate::photos {

// Free space ends this far in front of the true surface, metres, so that a slightly blurred surface does not count as a floater.
inline constexpr double kFloaterClearance_m = 1.0;
// Larger clearances tell floaters from blur: blur is only near surfaces. Ascending, from kFloaterClearance_m.
inline constexpr std::array<double, 5> kFloaterProfile_m = {kFloaterClearance_m, 2.0, 5.0, 10.0, 20.0};

struct FloaterOpacity {
  // Per clearance of kFloaterProfile_m: sum of the opacities (each in [0, 1]) from the camera to that distance in front of the true surface, and the
  // number of rays long enough for it.
  std::array<double, kFloaterProfile_m.size()> sum = {};
  std::array<int64_t, kFloaterProfile_m.size()> rays = {};

  FloaterOpacity& operator+=(const FloaterOpacity& other);
  double Mean() const { return Mean(0); }  // to kFloaterClearance_m; NaN without rays
  double Mean(size_t clearance) const;
  // Pairs (clearance in metres, mean opacity).
  std::vector<std::pair<double, double>> Profile() const;
};

// Measures a grid of pixels of one photo that are scored and have a true depth. findings: result of ScorePhoto for this task.
FloaterOpacity MeasureFloaterOpacity(const scene::Scene& scene, const HeldOutPhoto& task, const PhotoResult& findings, base::ThreadPool& threads);

}  // namespace skyquilt::evaluate::photos
