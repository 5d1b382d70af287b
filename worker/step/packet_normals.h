// Losses of normals where rays of segments end: of the density's gradient there, and of the normals that the head predicts at the rays' samples. The
// density learns from the head and the head from the density, each taking the other as given; on a plane of sparse points both learn its normal.
// Only in steps with such priors.
#pragma once

#include <algorithm>
#include <vector>

#include "core/field/optimizer.h"
#include "worker/step/packet_ends.h"

namespace skyquilt::worker {

// Points at which some rays of a packet end, where the normal of the density is trained: their positions in the field and what the optimiser needs
// to bring the gradient into the tables of the encoding.
struct SurfacePoints {
  // Makes room for n points of a field; n = 0: there are none.
  void Reset(int64_t n, const field::HashField& field) {
    count = n;
    const int points = std::max(1, field.config().multisample);
    stride = kernel::StrideFor(n);
    for (auto* v : {&x, &y, &z}) v->assign(stride * static_cast<size_t>(points), 0.0F);
    sharpness.assign(stride, 0.0F);
    along.assign(3 * stride, 0.0F);
    feature_gradient.assign(static_cast<size_t>(field.encoding().OutputRows()) * stride, 0.0F);
    at = {x.data(), y.data(), z.data(), field.config().Cones() ? sharpness.data() : nullptr, points, stride};
  }
  // Valid until the next Reset.
  field::FeatureGradient Gradient() const { return {0, count, feature_gradient.data(), stride, along.data(), &at}; }

  int64_t count = 0;
  size_t stride = 0;                    // of all rows
  std::vector<float> x, y, z;           // unit frame; a row per position of a point
  std::vector<float> sharpness;         // of the footprints
  std::vector<float> along;             // 3 rows: d loss / d gradient of the log density
  std::vector<float> feature_gradient;  // d log density / d feature
  kernel::Positions at;
};

class PacketNormals {
 public:
  explicit PacketNormals(const PacketShared& shared) : shared_(shared) {}

  // After PacketLosses. Writes the packet's surface points and adds to network_gradient. Returns the gradient by the samples' geometry
  // (field::kGeometryRows rows of s.a.stride) for the networks' backward pass; null when there is none.
  const float* Add(const PacketSamples& s, const PacketEnds& ends, SurfacePoints& points, float* network_gradient, LossSums& sums);

 private:
  // A view whose end has such a loss, and where it ends.
  struct EndView {
    size_t view;
    double distance_m;
  };
  void PlacePoints(const PacketSamples& s, SurfacePoints& points) const;
  void AddLoss(const PacketSamples& s, size_t point, bool head, LossSums& sums);

  const PacketShared& shared_;
  std::vector<EndView> end_views_;  // per surface point
  field::DensitySlope slope_;       // at the surface points
  std::vector<float> slope_along_;  // 3 rows of slope_.stride: by the gradient of the log density
  // Per sample, with a normal head: its rows and their gradient; rows of the geometry's gradient.
  std::vector<float> predicted_, predicted_gradient_, geometry_gradient_;
};

}  // namespace skyquilt::worker
