// Matter where there is none: how much of the light from the true surface a scene swallows on its way to the camera ("floaters").
// Needs a simulated survey's true depth.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/scene/scene.h"
#include "evaluate/photo_scorer.h"

namespace skyquilt::evaluate {

// Air that counts ends this far in front of the true surface, metres: what a surface's own blur takes is not floater opacity.
inline constexpr double kFloaterClearance_m = 1.0;
// The same farther from surfaces: blur falls off, what floats stays. Ascending, from kFloaterClearance_m.
inline constexpr std::array<double, 5> kFloaterProfile_m = {kFloaterClearance_m, 2.0, 5.0, 10.0, 20.0};

struct FloaterOpacity {
  // Per clearance of kFloaterProfile_m: opacities in [0, 1], each gathered from the camera to the clearance in front of the true surface, of the rays
  // that are longer than that.
  std::array<double, kFloaterProfile_m.size()> sum = {};
  std::array<int64_t, kFloaterProfile_m.size()> rays = {};

  FloaterOpacity& operator+=(const FloaterOpacity& other);
  double Mean() const { return Mean(0); }  // to kFloaterClearance_m; NaN without rays
  double Mean(size_t clearance) const;
  // (clearance in metres, mean opacity).
  std::vector<std::pair<double, double>> Profile() const;
};

// Over a grid of pixels of one photo that are scored and have a true depth. `findings` as ScorePhoto gave them for this task.
FloaterOpacity MeasureFloaterOpacity(const scene::Scene& scene, const PhotoTask& task, const PhotoFindings& findings, base::ThreadPool& threads);

}  // namespace skyquilt::evaluate
