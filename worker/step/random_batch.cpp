#include "worker/step/random_batch.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "core/base/random.h"

namespace skyquilt::worker {

RayBatch RandomBatch(int64_t samples, int samples_per_ray, int feature_rows, uint64_t seed, double step) {
  RayBatch batch;
  base::Random random(seed);
  const auto n = static_cast<size_t>(samples_per_ray);
  std::vector<float> x(n), y(n), z(n), t(n), unit_length(n, 1.0F);
  const std::vector<float> sharpness(n, std::numeric_limits<float>::infinity());
  const std::vector<int32_t> cell(n, 0);
  for (int64_t i = 0; i < std::max<int64_t>(1, samples / samples_per_ray); ++i) {
    BatchRay ray;
    ray.ray.origin_enu = Eigen::Vector3d::Zero();
    ray.ray.direction_enu = Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
    for (float& channel : ray.ray.target_srgb) channel = random.Uniform();
    for (float& channel : ray.background) channel = random.Uniform();
    ray.count = samples_per_ray;
    for (size_t k = 0; k < n; ++k) {
      if (k == 0 || step == 0.0) {
        x[k] = random.Uniform();
        y[k] = random.Uniform();
        z[k] = random.Uniform();
      } else {
        const Eigen::Vector3f next = Eigen::Vector3f(x[k - 1], y[k - 1], z[k - 1]) + (step * ray.ray.direction_enu).cast<float>();
        x[k] = std::clamp(next.x(), 0.0F, 1.0F);
        y[k] = std::clamp(next.y(), 0.0F, 1.0F);
        z[k] = std::clamp(next.z(), 0.0F, 1.0F);
      }
      t[k] = static_cast<float>(k) / static_cast<float>(n);
    }
    batch.Append(ray, x.data(), y.data(), z.data(), sharpness.data(), t.data(), unit_length.data(), cell.data());
  }
  batch.LayOutFeatures(feature_rows);
  return batch;
}

}  // namespace skyquilt::worker
