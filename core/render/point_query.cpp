#include "core/render/point_query.h"

#include <algorithm>

#include "core/base/errors.h"
#include "core/render/footprint.h"
#include "core/render/march.h"

namespace skyquilt::render {
namespace {

constexpr float kMaxPointLogTau = 30.0F;  // as in renderings
// A rendering's samples are half a step of the field long, or as long as their pixel is wide.
constexpr double kShortestPiece = 0.5;

bool IsInside(const encoding::SpaceMap& map, const Eigen::Vector3d& x_in_enu) {
  if (!map.contracted()) return (x_in_enu.array() >= map.min_enu().array()).all() && (x_in_enu.array() <= map.max_enu().array()).all();
  if (!(x_in_enu.z() >= map.min_enu().z() && x_in_enu.z() <= map.max_enu().z())) return false;
  // A ray up from the slab's lower face meets it, unless the place is too far out.
  return !FieldInterval(map, {x_in_enu.x(), x_in_enu.y(), map.min_enu().z()}, Eigen::Vector3d::UnitZ()).Empty();
}

size_t PositionsPerPoint(const TrainedField& f) {
  return static_cast<size_t>(std::max(1, f.config.multisample));
}

}  // namespace

// Writes the positions of the points that are evaluated, and their footprints.
void PointEvaluator::PlacePoints(const TrainedField& f, std::span<const QueryPoint> points) {
  inside_.clear();
  unit_.clear();
  for (size_t i = 0; i < points.size(); ++i) {
    if (!(points[i].blend > 0.0) || !IsInside(f.map, points[i].x_in_enu)) continue;
    const Eigen::Vector3f p = f.map.UnitFromEnu(points[i].x_in_enu);
    if (!f.occupancy.occupied[static_cast<size_t>(f.occupancy.IndexAt(p.x(), p.y(), p.z()))]) continue;
    inside_.push_back(i);
    unit_.push_back(p);
  }
  const size_t n = inside_.size();
  for (std::vector<float>* plane : {&x_, &y_, &z_}) plane->resize(std::max(plane->size(), n * PositionsPerPoint(f)));
  sharpness_.resize(std::max(sharpness_.size(), n));
  for (size_t j = 0; j < n; ++j) {
    x_[j] = unit_[j].x();
    y_[j] = unit_[j].y();
    z_[j] = unit_[j].z();
    if (!f.config.Cones()) continue;
    const QueryPoint& point = points[inside_[j]];
    const double width_m = TrainedWidth(f, point.footprint_m);
    sharpness_[j] = SharpnessOf(width_m, f.map.VolumeScale(point.x_in_enu), f.config.multisample);
    if (f.config.multisample == 1) continue;
    const Ray column{.origin_enu = point.x_in_enu, .direction_enu = point.direction_enu, .pixel_width = static_cast<float>(width_m)};
    const double length_m = std::max(kShortestPiece * f.step_m, point.footprint_m);
    Cone(f.map, column, f.config.multisample).Positions(0.0, length_m, width_m, Turn::Alternating(0), &x_[j], &y_[j], &z_[j], n);
  }
}

void PointEvaluator::EvaluateColors(const TrainedField& trained, std::span<const QueryPoint> points) {
  const field::HashField& f = *trained.field;
  const auto n = static_cast<int64_t>(inside_.size());
  const int64_t padded = kernel::Padded(n);
  const field::Activations& scratch = scratch_[scratch_.For(f)];
  const auto inputs = static_cast<size_t>(f.ColorInputRows());
  color_in_.assign(inputs * field::kChunkStride, 0.0F);
  color_.resize(static_cast<size_t>(field::kColorRows) * field::kChunkStride);
  for (size_t row = 0; row < field::kGeometryRows; ++row) {
    std::copy_n(geometry_.data() + row * field::kChunkStride, n, color_in_.data() + row * field::kChunkStride);
  }
  float* const directions = color_in_.data() + static_cast<size_t>(field::kGeometryRows) * field::kChunkStride;
  // Points that are seen from the same direction share its encoding.
  for (size_t j = 0; j < inside_.size();) {
    const Eigen::Vector3d& direction = points[inside_[j]].direction_enu;
    size_t end = j + 1;
    while (end < inside_.size() && points[inside_[end]].direction_enu == direction) ++end;
    const Eigen::Vector3f d = direction.cast<float>();
    f.EncodeDirection(d.data(), static_cast<int64_t>(end - j), directions + j, field::kChunkStride);
    j = end;
  }
  f.Color(trained.weights, color_in_.data(), field::kChunkStride, padded, scratch.color_hidden, scratch.stride, color_.data(), field::kChunkStride);
  for (size_t c = 0; c < 3; ++c) {
    float* const row = color_.data() + c * field::kChunkStride;
    kernel::Sigmoid(row, padded, static_cast<float>(trained.config.color_range), row);
  }
}

void PointEvaluator::Add(const TrainedField& trained, std::span<const QueryPoint> points, bool colors, std::span<PointSum> sums) {
  SKYQUILT_CHECK(points.size() <= kMost && sums.size() == points.size(), std::to_string(points.size()) + " points");
  SKYQUILT_CHECK(trained.field != nullptr, "field '" + trained.name + "' is not loaded");
  PlacePoints(trained, points);
  const auto n = static_cast<int64_t>(inside_.size());
  if (n == 0) return;
  const field::HashField& f = *trained.field;
  const int64_t padded = kernel::Padded(n);
  const auto rows = static_cast<size_t>(f.FeatureRows());
  features_.resize(std::max(features_.size(), rows * field::kChunkStride));
  geometry_.resize(static_cast<size_t>(field::kGeometryRows) * field::kChunkStride);
  depth_.resize(field::kChunkStride);
  const kernel::Positions at{
      x_.data(),     y_.data(), z_.data(), trained.config.Cones() ? sharpness_.data() : nullptr, static_cast<int>(PositionsPerPoint(trained)),
      inside_.size()};
  f.EncodeSerial(trained.parameters.grid, at, n, features_.data(), field::kChunkStride);
  for (size_t row = 0; row < rows; ++row) std::fill_n(features_.data() + row * field::kChunkStride + n, padded - n, 0.0F);
  const field::Activations& scratch = scratch_[scratch_.For(f)];
  f.Density(trained.weights, features_.data(), field::kChunkStride, padded, scratch.density_hidden, scratch.stride, geometry_.data(),
            field::kChunkStride);
  f.StepTau(geometry_.data(), padded, kMaxPointLogTau, depth_.data());
  if (colors) EvaluateColors(trained, points);
  for (size_t j = 0; j < inside_.size(); ++j) {
    const QueryPoint& point = points[inside_[j]];
    PointSum& sum = sums[inside_[j]];
    const double density = point.blend * static_cast<double>(depth_[j]) * trained.map.LocalScale(point.x_in_enu) / trained.step_m;
    sum.density += density;
    if (!colors) continue;
    for (size_t c = 0; c < 3; ++c) sum.rgb_times_density[c] += density * static_cast<double>(color_[c * field::kChunkStride + j]);
  }
}

}  // namespace skyquilt::render
