// Matter where there is none: how much of the light from the true surface a scene swallows on its way to the camera ("floaters").
// Needs a simulated survey's true depth.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "coordinator/report/photo_scorer.h"
#include "core/base/thread_pool.h"
#include "core/render/scene.h"

namespace skyquilt::report {

// Air that counts ends so far in front of the true surface, along the ray: what a surface's own blur takes is not dirt in the air. A photo's blur
// grows with its ground sampling distance (here: the distance on the surface between rays one pixel apart), so the larger of both counts.
inline constexpr double kAirClearance_m = 1.0, kAirClearance_gsd = 5.0;
// How far from surfaces dirt hangs: the same, ending so far in front of them.
inline constexpr std::array<double, 5> kAirProfile_m = {1.0, 2.0, 5.0, 10.0, 20.0};

class AirOpacity {
 public:
  AirOpacity& operator+=(const AirOpacity& other);
  // Opacity in [0, 1], mean over rays, gathered from the camera to the clearance in front of the true surface. NaN without rays.
  double Mean() const { return clear_.Mean(); }
  // (clearance in metres, mean opacity) for kAirProfile_m, of the rays that are longer than that; NaN without any.
  std::vector<std::pair<double, double>> Profile() const;

 private:
  friend AirOpacity MeasureAirOpacity(const render::Scene& scene, const PhotoTask& task, const PhotoFindings& findings, base::ThreadPool& threads);
  struct Pool {
    double sum = 0.0;
    int64_t rays = 0;
    double Mean() const;
  };
  Pool clear_;
  std::array<Pool, kAirProfile_m.size()> profile_;
};

// Over a grid of pixels of one photo that are scored and have a true depth. `findings` as ScorePhoto gave them for this task.
AirOpacity MeasureAirOpacity(const render::Scene& scene, const PhotoTask& task, const PhotoFindings& findings, base::ThreadPool& threads);

}  // namespace skyquilt::report
