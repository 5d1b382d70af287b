#include "worker/samplers/ray_bins.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::worker {
namespace {

// Even for ratios up to 1, then in inverse ratio; continuous with its slope.
double Spaced(double ratio) {
  return ratio < 1.0 ? 0.5 * ratio : 1.0 - 0.5 / ratio;
}

double Ratio(double spaced) {
  return spaced < 0.5 ? 2.0 * spaced : 0.5 / (1.0 - spaced);
}

}  // namespace

RaySpacing::RaySpacing(const encoding::SpaceMap& map, const geo::Interval& interval) {
  if (!map.contracted()) {
    first_ = interval.t_near;
    last_ = interval.t_far;
    return;
  }
  reach_m_ = 0.5 * (map.max_enu() - map.min_enu()).head<2>().maxCoeff();
  first_ = Spaced(interval.t_near / reach_m_);
  last_ = Spaced(interval.t_far / reach_m_);
}

double RaySpacing::Distance(double s) const {
  const double at = first_ + s * (last_ - first_);
  return std::isinf(reach_m_) ? at : reach_m_ * Ratio(at);
}

RayPlaces::Bin RayPlaces::Of(double begin, double end) const {
  const double from = spacing_.Distance(begin), to = spacing_.Distance(end);
  Bin bin{.t = 0.5 * (from + to), .length_m = to - from, .unit_length_m = to - from};
  if (field_.map.contracted()) bin.unit_length_m *= field_.map.LocalScale(ray_.origin_enu + bin.t * ray_.direction_enu);
  return bin;
}

void EvenEdges(float jitter, std::span<float> edges) {
  const auto bins = static_cast<float>(edges.size() - 1);
  for (size_t k = 0; k < edges.size(); ++k) edges[k] = (static_cast<float>(k) + jitter - 0.5F) / bins;
  edges.front() = 0.0F;
  edges.back() = 1.0F;
}

void ResampleEdges(std::span<const float> bin_edges, std::span<const float> weights, double anneal, double uniform_share, float jitter,
                   std::span<float> edges) {
  const size_t bins = weights.size();
  const auto annealed = [&](size_t i) {
    const auto w = static_cast<double>(weights[i]);
    return anneal == 1.0 ? w : w > 0.0 ? std::pow(w, anneal) : 0.0;
  };
  double total = 0.0;
  for (size_t i = 0; i < bins; ++i) total += annealed(i);
  const double even = total > 1e-12 ? uniform_share : 1.0;
  const double per_weight = total > 1e-12 ? (1.0 - even) / total : 0.0;
  const double length = static_cast<double>(bin_edges[bins]) - static_cast<double>(bin_edges[0]);
  const double per_length = length > 0.0 ? even / length : 0.0;
  size_t i = 0;
  double before = 0.0;  // share of all edges before bin i
  const auto share_of = [&](size_t bin) {
    return per_weight * annealed(bin) + per_length * (static_cast<double>(bin_edges[bin + 1]) - static_cast<double>(bin_edges[bin]));
  };
  double share = share_of(0);
  for (size_t k = 0; k < edges.size(); ++k) {
    const double wanted = (static_cast<double>(k) + static_cast<double>(jitter)) / static_cast<double>(edges.size());
    while (i + 1 < bins && before + share <= wanted) {
      before += share;
      share = share_of(++i);
    }
    const double within = share > 0.0 ? std::clamp((wanted - before) / share, 0.0, 1.0) : 0.5;
    const auto low = static_cast<double>(bin_edges[i]), high = static_cast<double>(bin_edges[i + 1]);
    edges[k] = static_cast<float>(low + within * (high - low));
  }
}

}  // namespace skyquilt::worker
