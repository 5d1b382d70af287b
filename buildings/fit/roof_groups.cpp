#include "buildings/fit/roof_groups.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "buildings/fit/height_mode.h"
#include "core/base/order_statistics.h"

namespace skyquilt::buildings {
namespace {

constexpr double kRounded_gsd = 1.5;  // of rims, ridges and valleys of the surface
constexpr double kParapet_m = 1.0;    // from the rim of a flat roof
constexpr double kParapetHeight_m = 1.3;
constexpr double kShareOfPart = 0.2;  // of the width of a part is the most that is left out on one side
constexpr double kSameNormal = 0.6;   // least cosine between the normals of a point and its plane
constexpr double kStrongRoofMode = 0.4;
constexpr size_t kMostRoofPoints = 1200;  // of a plane

// A plane of the roof of a part: the wall line it rises from (axis -1: level).
struct PlaneKey {
  int part = -1, axis = -1, side = 0;
  bool operator==(const PlaneKey&) const = default;
  friend bool operator<(const PlaneKey& a, const PlaneKey& b) { return std::tie(a.part, a.axis, a.side) < std::tie(b.part, b.axis, b.side); }
};

// Parts with rectangles and planes, for many questions about one shape.
class RoofMap {
 public:
  RoofMap(const Shape& shape, double overhang_m) : shape_(shape) {
    for (const Part& part : shape.parts) {
      const Eigen::Vector2d reach = Eigen::Vector2d::Constant(IsPitched(part) ? overhang_m : 0.0);
      low_.push_back(shape.MinOf(part, true) - reach);
      high_.push_back(shape.MaxOf(part, true) + reach);
    }
  }

  // The highest plane over a place; no part beside all roofs.
  PlaneKey At(const Eigen::Vector2d& uv, double* height = nullptr) const {
    PlaneKey top;
    double highest = 0.0;
    for (size_t p = 0; p < low_.size(); ++p) {
      if (((uv - low_[p]).array() < 0.0).any() || ((high_[p] - uv).array() < 0.0).any()) continue;
      const double z = RoofHeight(shape_, shape_.parts[p], uv);
      if (top.part >= 0 && z <= highest) continue;
      highest = z;
      top = PlaneOf(static_cast<int>(p), uv);
    }
    if (height != nullptr) *height = highest;
    return top;
  }
  // Whether the same plane continues to all sides, this far.
  bool IsWithin(const PlaneKey& key, const Eigen::Vector2d& uv, double margin_m) const {
    for (const double du : {-margin_m, 0.0, margin_m}) {
      for (const double dv : {-margin_m, 0.0, margin_m}) {
        if (At(uv + Eigen::Vector2d(du, dv)) != key) return false;
      }
    }
    return true;
  }
  double MarginOf(int part, double rounded_m) const {
    const Part& one = shape_.parts[static_cast<size_t>(part)];
    const double width = (shape_.MaxOf(one, false) - shape_.MinOf(one, false)).minCoeff();
    const double half = one.roof == RoofKind::kGable || one.roof == RoofKind::kHip ? 0.5 * width : width;
    return std::min(IsPitched(one) ? rounded_m : std::max(kParapet_m, rounded_m), kShareOfPart * half);
  }

 private:
  PlaneKey PlaneOf(int p, const Eigen::Vector2d& uv) const {
    const Part& part = shape_.parts[static_cast<size_t>(p)];
    if (!IsPitched(part)) return {p};
    const Eigen::Vector2d low = shape_.MinOf(part, false), high = shape_.MaxOf(part, false);
    PlaneKey nearest{p, part.along_u ? 1 : 0, -1};
    double distance = std::numeric_limits<double>::infinity();
    for (const int axis : {0, 1}) {
      if (part.roof == RoofKind::kGable && axis != (part.along_u ? 1 : 0)) continue;
      for (const int side : {-1, 1}) {
        const double inside = side < 0 ? uv[axis] - low[axis] : high[axis] - uv[axis];
        if (inside < distance) {
          distance = inside;
          nearest = {p, axis, side};
        }
      }
    }
    return nearest;
  }

  const Shape& shape_;
  std::vector<Eigen::Vector2d> low_, high_;
};

double RiseOf(const Shape& shape, const Part& part) {
  if (!IsPitched(part)) return 0.0;
  const Eigen::Vector2d half = 0.5 * (shape.MaxOf(part, false) - shape.MinOf(part, false));
  const double reach = part.roof == RoofKind::kHip ? half.minCoeff() : half[part.along_u ? 1 : 0];
  return reach > 0.0 ? (part.ridge_z - part.eave_z) / reach : 0.0;
}

// What the residual of a point on this plane needs besides the point.
Observation PlaneObservation(const Shape& shape, const PlaneKey& key) {
  const Part& part = shape.parts[static_cast<size_t>(key.part)];
  Observation o;
  o.kind = ObservationKind::kRoof;
  o.part = key.part;
  if (key.axis < 0) return o;
  const double rise = RiseOf(shape, part);
  o.tilt = 1.0 / std::sqrt(1.0 + rise * rise);
  o.axis = key.axis;
  o.side = key.side;
  o.line = key.axis == 0 ? (key.side < 0 ? part.u0 : part.u1) : (key.side < 0 ? part.v0 : part.v1);
  o.half_axis = part.along_u ? 1 : 0;
  if (part.roof == RoofKind::kHip) {
    const Eigen::Vector2d size = shape.MaxOf(part, false) - shape.MinOf(part, false);
    o.half_axis = size.x() <= size.y() ? 0 : 1;
  }
  o.half_low = o.half_axis == 0 ? part.u0 : part.v0;
  o.half_high = o.half_axis == 0 ? part.u1 : part.v1;
  return o;
}

Eigen::Vector3d NormalOf(const Shape& shape, const PlaneKey& key) {
  if (key.axis < 0) return Eigen::Vector3d::UnitZ();
  const double rise = RiseOf(shape, shape.parts[static_cast<size_t>(key.part)]);
  const Eigen::Vector2d out = key.side * (key.axis == 0 ? shape.AxisU() : shape.AxisV());
  return Eigen::Vector3d(rise * out.x(), rise * out.y(), 1.0).normalized();
}

}  // namespace

std::vector<Group> RoofGroups(const FitPoints& points, const Shape& shape, const RoofSelection& selection) {
  const RoofMap map(shape, selection.overhang_m);
  std::map<PlaneKey, Group> groups;
  std::vector<double> margin;
  margin.reserve(shape.parts.size());
  for (int p = 0; p < static_cast<int>(shape.parts.size()); ++p) margin.push_back(map.MarginOf(p, kRounded_gsd * selection.gsd_m));
  for (const FitPoint& point : points.roof) {
    const Eigen::Vector2d uv = InAxes(shape, point.place);
    double height = 0.0;
    const PlaneKey key = map.At(uv, &height);
    if (key.part < 0) continue;
    Observation o = PlaneObservation(shape, key);
    if (o.tilt * std::abs(point.z - height) > selection.window_m || point.normal.dot(NormalOf(shape, key)) < kSameNormal) continue;
    if (!map.IsWithin(key, uv, margin[static_cast<size_t>(key.part)])) continue;
    o.place = point.place;
    o.height = point.z;
    Group& group = groups[key];
    group.observations.push_back(o);
    group.at.push_back(uv);
  }
  std::vector<Group> list;
  for (auto& [key, group] : groups) {
    group.area_m2 = static_cast<double>(group.observations.size()) * points.spacing_m * points.spacing_m;
    group.Thin(kMostRoofPoints);
    list.push_back(std::move(group));
  }
  return list;
}

void SetLevels(const FitPoints& points, double gsd_m, Shape* shape) {
  const RoofMap map(*shape, 0.0);
  std::vector<std::vector<double>> inner(shape->parts.size()), all(shape->parts.size());
  for (const FitPoint& point : points.roof) {
    const Eigen::Vector2d uv = InAxes(*shape, point.place);
    const PlaneKey key = map.At(uv);
    if (key.part < 0) continue;
    const auto p = static_cast<size_t>(key.part);
    all[p].push_back(point.z);
    if (map.IsWithin(key, uv, map.MarginOf(key.part, kRounded_gsd * gsd_m))) inner[p].push_back(point.z);
  }
  for (size_t p = 0; p < shape->parts.size(); ++p) {
    Part& part = shape->parts[p];
    const std::vector<double>& heights = inner[p].size() >= 5 ? inner[p] : all[p];
    if (IsPitched(part) || heights.empty()) continue;
    part.eave_z = part.roof == RoofKind::kFlat ? LowestStrongMode(heights, gsd_m, kStrongRoofMode)->at : base::Median(heights);
    part.ridge_z = part.eave_z;
  }
}

RoofAgreement AgreementOf(const FitPoints& points, const Shape& shape, double overhang_m, double tolerance_m) {
  // Roofs are asked for a little beyond their rims, which are rounded.
  const RoofMap map(shape, overhang_m + tolerance_m);
  std::vector<double> distances;
  size_t within = 0, counted = 0;
  for (const FitPoint& point : points.roof) {
    const Eigen::Vector2d uv = InAxes(shape, point.place);
    double height = 0.0;
    const PlaneKey key = map.At(uv, &height);
    ++counted;
    if (key.part < 0) {
      // Beside all walls: a flat roof's rim.
      for (const Part& part : shape.parts) {
        const Eigen::Array2d out = (shape.MinOf(part, false) - uv).cwiseMax(uv - shape.MaxOf(part, false)).array();
        if (out.maxCoeff() > tolerance_m || point.z > part.eave_z + kParapetHeight_m || point.z < part.eave_z - tolerance_m) continue;
        ++within;
        break;
      }
      continue;
    }
    const Part& part = shape.parts[static_cast<size_t>(key.part)];
    const double distance = PlaneObservation(shape, key).tilt * std::abs(point.z - height);
    if (distance <= tolerance_m) {
      ++within;
    } else if (!IsPitched(part) && point.z > height && point.z <= height + kParapetHeight_m &&
               !map.IsWithin(key, uv, map.MarginOf(key.part, tolerance_m))) {
      --counted;  // a parapet, which the shape leaves out on purpose
    }
    distances.push_back(distance);
  }
  RoofAgreement agreement;
  if (counted > 0) agreement.share_within = static_cast<double>(within) / static_cast<double>(counted);
  if (!distances.empty()) agreement.residual_m = base::kMadToSigma * base::Median(std::move(distances));
  return agreement;
}

}  // namespace skyquilt::buildings
