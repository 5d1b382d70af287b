#include <limits>

#include "core/render/blend.h"
#include "core/render/ray_engine.h"

namespace skyquilt::render {

EngineOptions EngineOptions::For(const brightness::Luminance& luminance) {
  EngineOptions options;
  if (!luminance.On()) return options;
  options.concealing = luminance.product ? Concealing::kProduct : Concealing::kGain;
  // In a product even samples of small weight dim those behind them.
  if (luminance.product) options.colour_threshold = -1.0F;
  return options;
}

geo::Interval BlendInterval(const TrainedField& block, const Ray& ray) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d reach(block.blend_m, block.blend_m, kInfinity);
  return geo::RayBox(ray.origin_enu, ray.direction_enu, block.box.min_enu - reach, block.box.max_enu + reach);
}

double BlendWeights(const FieldSet& fields, std::span<const int> candidates, double x, double y, std::span<double> weights) {
  double sum = 0.0;
  for (size_t c = 0; c < candidates.size(); ++c) {
    const TrainedField& f = *fields.blocks[static_cast<size_t>(candidates[c])];
    weights[c] = BlockRamp(f.box.min_enu, f.box.max_enu, f.blend_m, x, y);
    sum += weights[c];
  }
  if (sum > 1.0) {
    for (double& weight : weights) weight /= sum;
    sum = 1.0;
  }
  return 1.0 - sum;
}

}  // namespace skyquilt::render
