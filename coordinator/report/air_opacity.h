// Matter where there is none: how much of the light from the true surface a scene swallows on its way to the camera ("floaters").
// Needs a simulated survey's true depth.
#pragma once

#include <cstdint>

#include "coordinator/report/photo_scorer.h"
#include "core/base/thread_pool.h"
#include "core/render/scene.h"

namespace skyquilt::report {

// Air that counts ends so far in front of the true surface, along the ray: what a surface's own blur takes is not dirt in the air. A photo's blur
// grows with its ground sampling distance (here: the distance on the surface between rays one pixel apart), so the larger of both counts.
inline constexpr double kAirClearance_m = 1.0, kAirClearance_gsd = 5.0;

struct AirOpacity {
  double sum = 0.0;  // of opacities in [0, 1], each gathered from the camera to the clearance in front of the true surface
  int64_t rays = 0;

  AirOpacity& operator+=(const AirOpacity& other);
  double Mean() const;  // NaN without rays
};

// Over a grid of pixels of one photo that are scored and have a true depth. `findings` as ScorePhoto gave them for this task.
AirOpacity MeasureAirOpacity(const render::Scene& scene, const PhotoTask& task, const PhotoFindings& findings, base::ThreadPool& threads);

}  // namespace skyquilt::report
