#include "worker/step/packet_normals.h"

#include <optional>

#include "core/render/footprint.h"
#include "worker/losses/normal_loss.h"

namespace skyquilt::worker {
namespace {

using Eigen::Vector3d;

// Where the log density changes by less over a voxel there is no surface, and the derivative of its direction would be huge.
constexpr double kLeastSlopePerVoxel = 0.05;
// The head's normals along a ray have one direction when the length of their mean is above this.
constexpr double kLeastAgreement = 0.5;

Vector3d Column(const float* rows, size_t stride, size_t column) {
  return {static_cast<double>(rows[column]), static_cast<double>(rows[stride + column]), static_cast<double>(rows[2 * stride + column])};
}

void AddToColumn(const Vector3d& v, float* rows, size_t stride, size_t column) {
  for (size_t axis = 0; axis < 3; ++axis) rows[axis * stride + column] += static_cast<float>(v[static_cast<Eigen::Index>(axis)]);
}

}  // namespace

const float* PacketNormals::Add(const PacketSamples& s, const PacketEnds& ends, SurfacePoints& points, float* network_gradient, LossSums& sums) {
  end_views_.clear();
  for (size_t k = 0; k < s.views.size(); ++k) {
    if (s.Ray(k).segment >= 0 && ends.ends()[k].sharp) end_views_.push_back({k, ends.ends()[k].mean_m});
  }
  const auto n = static_cast<int64_t>(end_views_.size());
  const field::HashField& field = shared_.field;
  points.Reset(n, field);
  if (n == 0) return nullptr;
  PlacePoints(s, points);
  field.DensityGradient(s.step->weights, s.step->grid, points.at, n, slope_);
  const bool head = field.config().normal_head && s.step->priors.normals > 0.0;
  if (head) {
    const auto floats = static_cast<size_t>(field::kNormalRows) * s.a.stride;
    Grow(predicted_, floats);
    predicted_gradient_.assign(floats, 0.0F);
    field.PredictNormals(s.step->weights, s.a.geometry(), s.a.stride, s.Padded(), predicted_.data(), s.a.stride);
  }
  slope_along_.assign(3 * slope_.stride, 0.0F);
  for (size_t i = 0; i < end_views_.size(); ++i) AddLoss(s, i, head, sums);
  field.DensityGradientBackward(s.step->weights, s.step->grid, points.at, n, slope_along_.data(), slope_, network_gradient);
  const auto keep_rows = [&](const float* from, size_t rows, float* to) {
    for (size_t row = 0; row < rows; ++row) std::copy_n(from + row * slope_.stride, n, to + row * points.stride);
  };
  keep_rows(slope_along_.data(), 3, points.along.data());
  keep_rows(slope_.feature_gradient, static_cast<size_t>(field.encoding().OutputRows()), points.feature_gradient.data());
  if (!head) return nullptr;
  Grow(geometry_gradient_, static_cast<size_t>(field::kGeometryRows) * s.a.stride);
  field.NormalHeadBackward(s.step->weights, predicted_gradient_.data(), s.a.stride, s.a.geometry(), s.a.stride, s.Padded(), geometry_gradient_.data(),
                           network_gradient);
  return geometry_gradient_.data();
}

void PacketNormals::PlacePoints(const PacketSamples& s, SurfacePoints& points) const {
  const encoding::SpaceMap& map = shared_.target.map;
  const int positions = points.at.points;
  for (size_t i = 0; i < end_views_.size(); ++i) {
    const PixelRay& ray = s.Ray(end_views_[i].view).ray;
    const double t = end_views_[i].distance_m, width_m = static_cast<double>(ray.pixel_pitch) * t;
    const render::Ray axis{.origin_enu = ray.origin_enu, .direction_enu = ray.direction_enu, .pixel_pitch = ray.pixel_pitch};
    render::Cone(map, axis, positions)
        .Positions(t, shared_.target.step_m, width_m, {}, points.x.data() + i, points.y.data() + i, points.z.data() + i, points.stride);
    points.sharpness[i] = render::SharpnessOf(width_m, map.VolumeScale(ray.origin_enu + t * ray.direction_enu), positions);
  }
}

void PacketNormals::AddLoss(const PacketSamples& s, size_t point, bool head, LossSums& sums) {
  const auto [view, distance_m] = end_views_[point];
  const StepPriors& priors = s.step->priors;
  const PixelRay& ray = s.Ray(view).ray;
  const Vector3d x = ray.origin_enu + distance_m * ray.direction_enu;
  const Eigen::Matrix3d unit_per_enu = shared_.target.map.UnitPerEnu(x);
  const Vector3d outward = -(unit_per_enu.transpose() * Column(slope_.gradient, slope_.stride, point));
  const bool has_slope = outward.norm() * priors.voxel_m > kLeastSlopePerVoxel;
  const auto share = static_cast<double>(s.step->ray_share);
  const Vector3d towards_camera = -ray.direction_enu;

  const PointPlane* const plane = priors.known_planes != nullptr ? priors.known_planes->At(x, priors.voxel_m) : nullptr;
  std::optional<Vector3d> known;
  if (plane != nullptr) known = plane->normal.dot(towards_camera) < 0.0 ? Vector3d(-plane->normal) : plane->normal;

  std::optional<Vector3d> of_head;
  const auto begin = static_cast<size_t>(s.views[view].begin), count = static_cast<size_t>(s.views[view].count);
  if (head) {
    const std::optional<Vector3d> target = known ? known : has_slope ? std::optional(render::UnitNormal<double>(outward)) : std::nullopt;
    Vector3d mean = Vector3d::Zero();
    for (size_t i = begin; i < begin + count; ++i) {
      const Vector3d predicted = Column(predicted_.data(), s.a.stride, i);
      const auto weight = static_cast<double>(s.weight[i]);
      mean += weight * render::UnitNormal<double>(predicted);
      if (!target) continue;
      const VectorLoss<double> loss = NormalLoss<double>(priors.normals * weight, predicted, *target);
      sums.loss += loss.value;
      AddToColumn(share * loss.gradient, predicted_gradient_.data(), s.a.stride, i);
    }
    if (mean.norm() > kLeastAgreement) of_head = mean.normalized();
  }
  if (!has_slope) return;
  VectorLoss<double> loss;
  const auto add = [&loss](const VectorLoss<double>& more) {
    loss.value += more.value;
    loss.gradient += more.gradient;
  };
  if (priors.normals > 0.0 && (known || of_head)) add(NormalLoss<double>(priors.normals, outward, known ? *known : *of_head));
  if (priors.orientation > 0.0) add(OrientationLoss<double>(priors.orientation, outward, towards_camera));
  sums.loss += loss.value;
  AddToColumn(-share * (unit_per_enu * loss.gradient), slope_along_.data(), slope_.stride, point);
}

}  // namespace skyquilt::worker
