#include "core/scene/point_query.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/render/ray_engine.h"

namespace skyquilt::scene {
namespace {

constexpr double kLeastBlend = 1e-4;  // of a sample of a rendering

// A point that a field has a part in.
struct Part {
  size_t point = 0;
  double blend = 0.0;
};

// The blocks in order, then the context.
using Parts = std::vector<std::vector<Part>>;

Parts PartsOf(const FieldStore& store, const render::GroundIndex& index, std::span<const Eigen::Vector3d> x_in_enu) {
  const render::FieldSet fields{store.Blocks(), store.HasContext() ? &store.context() : nullptr};
  Parts parts(fields.blocks.size() + 1);
  std::vector<int> near;
  std::vector<double> weights;
  for (size_t i = 0; i < x_in_enu.size(); ++i) {
    const Eigen::Vector3d& x = x_in_enu[i];
    if (!x.allFinite()) continue;
    index.Find({.origin_enu = {x.x(), x.y(), 0.0}, .direction_enu = -Eigen::Vector3d::UnitZ()}, {-1.0, 1.0}, &near);
    weights.resize(near.size());
    const double of_context = render::BlendWeights(fields, near, x.x(), x.y(), weights);
    for (size_t c = 0; c < near.size(); ++c) {
      if (weights[c] > kLeastBlend) parts[static_cast<size_t>(near[c])].push_back({i, weights[c]});
    }
    if (fields.context != nullptr && of_context > kLeastBlend) parts.back().push_back({i, of_context});
  }
  return parts;
}

}  // namespace

void QueryPoints(FieldStore& store, const render::GroundIndex& index, std::span<const Eigen::Vector3d> x_in_enu,
                 std::span<const Eigen::Vector3d> direction_enu, const PointOptions& options, std::span<PointColor> out, base::ThreadPool& threads) {
  SKYQUILT_CHECK(out.size() == x_in_enu.size() && (direction_enu.size() == 1 || direction_enu.size() == x_in_enu.size()),
                 std::to_string(x_in_enu.size()) + " points, " + std::to_string(direction_enu.size()) + " directions");
  const Parts parts = PartsOf(store, index, x_in_enu);
  std::vector<render::PointSum> sums(x_in_enu.size());
  std::vector<render::PointEvaluator> evaluators(static_cast<size_t>(threads.size()));
  for (size_t k = 0; k < parts.size(); ++k) {
    if (parts[k].empty()) continue;
    const bool is_context = k + 1 == parts.size();
    const int block = static_cast<int>(k);
    store.EnsureLoaded(is_context ? std::span<const int>() : std::span(&block, 1));
    const render::TrainedField& f = is_context ? store.context() : store.block(block);
    constexpr size_t kEach = render::PointEvaluator::kMost;
    threads.ParallelFor(static_cast<int64_t>((parts[k].size() + kEach - 1) / kEach), [&](int64_t task, int thread) {
      base::ThrowIfCancelled();
      const size_t begin = static_cast<size_t>(task) * kEach;
      const std::span<const Part> some = std::span(parts[k]).subspan(begin, std::min(kEach, parts[k].size() - begin));
      std::vector<render::QueryPoint> points;
      std::vector<render::PointSum> added(some.size());
      points.reserve(some.size());
      for (const Part& part : some) {
        points.push_back({x_in_enu[part.point], direction_enu[direction_enu.size() == 1 ? 0 : part.point], options.footprint_m, part.blend});
      }
      evaluators[static_cast<size_t>(thread)].Add(f, points, options.colors, added);
      for (size_t j = 0; j < some.size(); ++j) {
        render::PointSum& sum = sums[some[j].point];
        sum.density += added[j].density;
        for (size_t c = 0; c < 3; ++c) sum.rgb_times_density[c] += added[j].rgb_times_density[c];
      }
    });
  }
  for (size_t i = 0; i < out.size(); ++i) {
    out[i] = {};
    if (!x_in_enu[i].allFinite()) {
      out[i].density = std::numeric_limits<float>::quiet_NaN();
      continue;
    }
    out[i].density = static_cast<float>(sums[i].density);
    if (!options.colors || !(sums[i].density > 0.0)) continue;
    for (size_t c = 0; c < 3; ++c) out[i].rgb_srgb[c] = static_cast<float>(sums[i].rgb_times_density[c] / sums[i].density);
  }
}

}  // namespace skyquilt::scene
