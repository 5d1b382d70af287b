#include "core/scene/scales.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/log.h"
#include "core/scene/scene_file.h"

namespace skyquilt::scene {
namespace {

constexpr double kFar = 2.0;  // times the trained range
// Of the pixels of one request. Single rays at the horizon or close to a roof do not matter.
constexpr double kFewestShare = 0.25;

}  // namespace

Scales GetScales(const checkpoint::ArchiveReader& scene) {
  Scales scales;
  bool first = true;
  const int64_t blocks = scene.IntAttribute("blocks");
  for (int64_t i = 0; i < blocks; ++i) {
    const std::string prefix = BlockPrefix(i);
    if (!scene.HasAttribute(prefix + "multisample")) continue;
    scales.multisample = std::max(scales.multisample, static_cast<int>(scene.IntAttribute(prefix + "multisample")));
    const double low = scene.DoubleAttribute(prefix + "footprint_min_m"), high = scene.DoubleAttribute(prefix + "footprint_max_m");
    scales.footprint_min_m = first ? low : std::min(scales.footprint_min_m, low);
    scales.footprint_max_m = first ? high : std::max(scales.footprint_max_m, high);
    first = false;
  }
  return scales;
}

void ScaleCheck::Check(std::span<const render::Ray> rays, std::span<const render::RayColor> colors) {
  if (warned_ || !scales_.Cones() || !(scales_.footprint_max_m > 0.0)) return;
  size_t seen = 0, wide = 0, narrow = 0;
  double sum_log = 0.0;
  for (size_t i = 0; i < rays.size(); ++i) {
    const double width_m = rays[i].Footprint(static_cast<double>(colors[i].depth_median));
    if (!(width_m > 0.0) || !std::isfinite(width_m)) continue;
    ++seen;
    sum_log += std::log(width_m);
    if (width_m > kFar * scales_.footprint_max_m) ++wide;
    if (width_m * kFar < scales_.footprint_min_m) ++narrow;
  }
  const double share = kFewestShare * static_cast<double>(seen);
  if (seen == 0 || (static_cast<double>(wide) <= share && static_cast<double>(narrow) <= share)) return;
  warned_ = true;
  const bool too_wide = wide > narrow;
  base::LogWarning("pixels of about {:.2g} m are rendered, but the scene was trained with {:.2g} to {:.2g} m per pixel: {}",
                   std::exp(sum_log / static_cast<double>(seen)), scales_.footprint_min_m, scales_.footprint_max_m,
                   too_wide ? "expect aliasing. Render larger images and reduce them, or train with smaller photos too (train.pyramid)"
                            : "they show no more detail than the photos did");
}

}  // namespace skyquilt::scene
