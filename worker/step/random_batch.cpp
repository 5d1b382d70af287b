#include "worker/step/random_batch.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "core/base/random.h"

namespace skyquilt::worker {

RayBatch RandomBatch(int64_t samples, int samples_per_ray, int feature_rows, uint64_t seed) {
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
      x[k] = random.Uniform();
      y[k] = random.Uniform();
      z[k] = random.Uniform();
      t[k] = static_cast<float>(k) / static_cast<float>(n);
    }
    batch.Append(ray, x.data(), y.data(), z.data(), sharpness.data(), t.data(), unit_length.data(), cell.data());
  }
  batch.LayOutFeatures(feature_rows);
  return batch;
}

}  // namespace skyquilt::worker
