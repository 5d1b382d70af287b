// What a trained field says at single points: the sample that a ray of a rendering would take there (core/render/ray_engine.h), without the ray.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/render/scratch_pool.h"
#include "core/render/trained_field.h"

namespace skyquilt::render {

// Survey ENU, metres.
struct QueryPoint {
  Eigen::Vector3d x_in_enu = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction_enu = -Eigen::Vector3d::UnitZ();  // of the light's way backwards: from the viewer to the point; length 1
  double footprint_m = 0.0;                                   // width of the pixel there; 0: the finest that the field was trained with
  double blend = 1.0;                                         // weight of the field at this point
};

// Sums over fields: of optical depth per metre, and of the same times the display values at reference exposure.
struct PointSum {
  double density = 0.0;
  double rgb_times_density[3] = {0.0, 0.0, 0.0};
};

// Evaluates points in one field. Not thread-safe: one object per thread.
class PointEvaluator {
 public:
  // Most points of one call.
  static constexpr size_t kMost = field::kChunk;

  // Adds the field's part to the sums of at most kMost points: density = blend * exp(h0 + bias) / step, which is what the renderer's samples have per
  // metre; nothing where it takes no samples, outside the field's box and in cells that are free. The field must be loaded. colors: false: only the
  // densities are wanted.
  void Add(const TrainedField& f, std::span<const QueryPoint> points, bool colors, std::span<PointSum> sums);

 private:
  void PlacePoints(const TrainedField& f, std::span<const QueryPoint> points);
  void EvaluateColors(const TrainedField& f, std::span<const QueryPoint> points);

  ScratchPool scratch_;
  std::vector<size_t> inside_;              // indices of the points that are evaluated
  std::vector<Eigen::Vector3f> unit_;       // their positions in the unit frame
  std::vector<float> x_, y_, z_;            // planes of their positions
  std::vector<float> sharpness_;            // per evaluated point
  std::vector<float> features_, geometry_;  // rows of field::kChunkStride, as all below
  std::vector<float> depth_;                // optical depth of one marching step
  std::vector<float> color_in_, color_;
};

}  // namespace skyquilt::render
