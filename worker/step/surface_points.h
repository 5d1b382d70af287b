// Points at which some rays of a packet end, where the normal of the density is trained: their positions in the field and what the optimiser needs
// to bring the gradient into the tables of the encoding.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/field/hash_field.h"
#include "core/field/optimizer.h"

namespace skyquilt::worker {

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

}  // namespace skyquilt::worker
