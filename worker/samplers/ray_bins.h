// Bins along a ray for samplers that look for surfaces instead of marching through occupied cells: n bins have n + 1 ascending edges, each a share of
// the way between the ray's ends, 0..1 (Barron et al. 2022, mip-NeRF 360, section 3).
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "core/encoding/space_map.h"
#include "core/geo/ray_box.h"
#include "core/render/trained_field.h"

namespace skyquilt::worker {

// Where on a ray the share s is. In a block's box even. In a contracted frame even up to half the width of the uncontracted square, beyond it even in
// inverse distance, as nerfacto spaces its first samples (Tancik et al. 2023).
class RaySpacing {
 public:
  // interval: of the ray inside the field, metres; not empty.
  RaySpacing(const encoding::SpaceMap& map, const geo::Interval& interval);
  // Metres from the ray's origin.
  double Distance(double s) const;

 private:
  double reach_m_ = std::numeric_limits<double>::infinity();  // where even spacing ends
  double first_ = 0.0, last_ = 1.0;                           // of the interval, after spacing; without reach_m_ in metres
};

// A ray and the part of it that is inside the field.
struct BinnedRay {
  Eigen::Vector3d origin_enu, direction_enu;
  geo::Interval interval;  // metres, not empty
};

// The samples that stand for bins of a ray.
class RayPlaces {
 public:
  RayPlaces(const render::TrainedField& field, const BinnedRay& ray) : field_(field), ray_(ray), spacing_(field.map, ray.interval) {}
  struct Bin {
    double t, length_m;    // middle and length along the ray
    double unit_length_m;  // length after contraction, to which the density refers
  };
  Bin Of(double begin, double end) const;

 private:
  const render::TrainedField& field_;
  const BinnedRay& ray_;
  RaySpacing spacing_;
};

// Writes even edges, of which all but the first and the last are moved by (jitter - 1/2) bins. jitter: in [0, 1).
void EvenEdges(float jitter, std::span<float> edges);

// Draws edges.size() edges where the bins have weight: at (k + jitter) / edges.size() of the weight, k = 0, 1, ... Bins count with their weight to
// the power of `anneal` (0: all alike, 1: as they are), and uniform_share of the edges, 0..1, is spread evenly between the ends, so that a surface is
// found that the bins do not know. Without any weight all are even. bin_edges: bins + 1; weights: >= 0, finite.
void ResampleEdges(std::span<const float> bin_edges, std::span<const float> weights, double anneal, double uniform_share, float jitter,
                   std::span<float> edges);

// The compositing weights of bins from their optical depths; may be the same array. Returns the transmittance behind the last one.
template <typename T>
T WeightsOfTaus(std::span<const T> tau, T* weights) {
  T transmittance = T(1);
  for (size_t i = 0; i < tau.size(); ++i) {
    const T after = transmittance * std::exp(-tau[i]);
    weights[i] = transmittance - after;
    transmittance = after;
  }
  return transmittance;
}
// From derivatives of a loss by weights to those by optical depths (core/render/composite.h). transmittance: behind the last bin.
template <typename T>
void WeightsBackward(std::span<const T> weights, T transmittance, const T* weight_gradient, T* tau_gradient) {
  T behind = T(0);
  for (size_t i = weights.size(); i-- > 0;) {
    tau_gradient[i] = transmittance * weight_gradient[i] - behind;
    behind += weights[i] * weight_gradient[i];
    transmittance += weights[i];
  }
}

}  // namespace skyquilt::worker
