// Measures the depth of a scene against sparse points of structure from motion that training never saw (Survey::kept_points): the only check of
// depth on surveys without true depth. Rays go from cameras through points that their photos observed, so nothing hides the points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/geo/block_box.h"
#include "core/image/pixel_cache.h"
#include "core/render/ray.h"
#include "core/scene/scene.h"
#include "core/survey/survey.h"
#include "evaluate/measured.h"

namespace skyquilt::evaluate::photos {

// Rays through one point, from photos spread over those that observed it; held-out ones first.
inline constexpr int kRaysPerKeptPoint = 4;
inline constexpr size_t kMostKeptRays = 20'000;

struct KeptRay {
  size_t point = 0;  // index into Survey::kept_points
  int photo = 0;     // index into Survey::photos
  render::Ray ray = {};
  double true_m = 0.0;  // distance of the point along the ray
  double gsd_m = 0.0;   // at the point: its distance times the angle of a pixel of the photo at full size (camera::PixelPitch)
};

// Rays through the points that lie in the plan of a block's core box and were observed by two training photos or more. Where they are more than
// `most`, points are chosen by a hash of their index. widths: of each photo at the size of training, pixels, for the width of the rays.
std::vector<KeptRay> KeptRays(const survey::Survey& survey, std::span<const int> widths, std::span<const geo::BlockBox> boxes, size_t most);

// Depth of the scene along rays to the kept points: rendered distance minus distance of the point,
// positive behind it. Median, median of the absolute values, and NMAD (1.4826 times the median distance from the median), in metres and in units of
// the photo's ground sampling distance there.
struct KeptPointErrors {
  int64_t points = 0;
  int64_t rays = 0;  // 0: nothing was measured
  double median_m = kNotMeasured, median_abs_m = kNotMeasured, nmad_m = kNotMeasured;
  double median_gsd = kNotMeasured, median_abs_gsd = kNotMeasured, nmad_gsd = kNotMeasured;
  double share_beyond_10_gsd = kNotMeasured;  // of the rays, those that never become half opaque included
};

// rendered: one per ray. A ray that never becomes half opaque has an infinite error. Metres are left unmeasured in surveys without a place on Earth,
// whose unit is unknown.
KeptPointErrors CompareKeptRays(std::span<const KeptRay> rays, std::span<const render::RayColor> rendered, bool georeferenced);

// No rays when the survey has no kept points or no tracks.
KeptPointErrors MeasureKeptPoints(const scene::Scene& scene, const survey::Survey& survey, const image::PixelCache& pixels,
                                  std::span<const geo::BlockBox> boxes, base::ThreadPool& threads);

}  // namespace skyquilt::evaluate::photos
