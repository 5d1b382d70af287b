#include "evaluate/surface/samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/base/random.h"

namespace skyquilt::evaluate::surface {

std::vector<SurfaceSample> SampleSurface(std::span<const Eigen::Vector3f> position, std::span<const std::array<uint32_t, 3>> triangle,
                                         const std::function<bool(uint32_t)>& is_used, double area_m2, int64_t max_samples) {
  std::vector<SurfaceSample> samples;
  std::vector<uint32_t> used;
  std::vector<double> up_to;  // sum of the areas of the used triangles, each included
  double total_m2 = 0.0;
  for (uint32_t i = 0; i < triangle.size(); ++i) {
    if (!is_used(i)) continue;
    const auto& corner = triangle[i];
    const Eigen::Vector3d a = position[corner[0]].cast<double>(), b = position[corner[1]].cast<double>(), c = position[corner[2]].cast<double>();
    const double area = 0.5 * (b - a).cross(c - a).norm();
    if (!(area > 0.0) || !std::isfinite(area)) continue;
    total_m2 += area;
    used.push_back(i);
    up_to.push_back(total_m2);
  }
  if (used.empty() || !(area_m2 > 0.0) || max_samples <= 0) return samples;
  const auto n = static_cast<int64_t>(std::clamp(std::ceil(total_m2 / area_m2), 1.0, static_cast<double>(max_samples)));
  samples.reserve(static_cast<size_t>(n));
  base::Random random(2024);
  size_t at = 0;
  for (int64_t k = 0; k < n; ++k) {
    const double place = (static_cast<double>(k) + random.UniformDouble()) * total_m2 / static_cast<double>(n);
    while (at + 1 < used.size() && up_to[at] <= place) ++at;
    // Uniform in the triangle (Osada et al. 2002, eq. 1).
    const float root = std::sqrt(random.Uniform()), share = random.Uniform();
    const auto& corner = triangle[used[at]];
    samples.push_back(
        {(1.0F - root) * position[corner[0]] + root * (1.0F - share) * position[corner[1]] + root * share * position[corner[2]], used[at]});
  }
  return samples;
}

}  // namespace skyquilt::evaluate::surface
