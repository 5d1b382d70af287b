#include <algorithm>
#include <cmath>
#include <utility>

#include "buildings/fit/height_mode.h"
#include "buildings/fit/wall_groups.h"
#include "buildings/fit/wall_strips.h"
#include "core/base/order_statistics.h"

namespace skyquilt::buildings {
namespace {

constexpr double kLeastRim_m = 1.0;
constexpr double kRimCorner_gsd = 2.5;
constexpr double kNearRim_gsd = 2.0;  // from the densest distance
constexpr size_t kLeastRimPoints = 8;
constexpr size_t kMostEdgePoints = 600;

// The end of a roof by counting, where its side was not seen: along a stretch of wall, points beyond a line inside over points per metre farther in.
constexpr double kStretch_m = 1.5;
constexpr double kInside_m = 0.8;  // the line
constexpr double kDeep_m = 1.5;    // of the strip in which points per metre are counted
constexpr double kBeyond_m = 1.5;
constexpr double kEndOff_gsd = 0.2;  // the surface goes over the rim
constexpr double kEndParapet_m = 1.3;
constexpr double kUnder_gsd = 1.0;  // the roof ends beyond its seeming rim by more than this

Observation EdgeObservation(const StripKey& key, const Parameters& parameters, bool pitched) {
  Observation o;
  o.kind = ObservationKind::kLine;
  o.axis = key.axis;
  o.line = key.line;
  o.side = key.side;
  o.part = key.part;
  o.parameter = parameters.overhang(pitched);
  o.reach = 1.0;
  return o;
}

Group RimGroup(const StripKey& key, const Strip& strip, const FitPoints& points, const Shape& shape, const Parameters& parameters,
               const WallSelection& selection) {
  const double gsd = selection.gsd_m;
  const Rim rim = RimOf(strip.pitched, strip.sloped);
  const double expected = (strip.pitched ? selection.overhang_m : 0.0) + rim.off_gsd * gsd;
  std::vector<StripPoint> chosen;
  std::vector<double> distance;
  for (const StripPoint& one : PointsOf(strip, points, shape, selection.overhang_m, kRimCorner_gsd * gsd, selection.window_m + std::abs(expected))) {
    if (one.below < rim.from_gsd * gsd || one.below > rim.to_gsd * gsd || std::abs(one.out - expected) > selection.window_m) continue;
    chosen.push_back(one);
    distance.push_back(one.out);
  }
  Group group;
  if (chosen.size() < kLeastRimPoints) return group;
  const double peak = Modes(distance, {}, gsd).front().at;
  for (size_t i = 0; i < chosen.size(); ++i) {
    if (std::abs(distance[i] - peak) > kNearRim_gsd * gsd) continue;
    Observation o = EdgeObservation(key, parameters, strip.pitched);
    o.place = chosen[i].point->place;
    o.value = rim.off_gsd * gsd;
    group.observations.push_back(o);
    group.at.emplace_back(chosen[i].along, chosen[i].point->z);
  }
  group.area_m2 = static_cast<double>(group.observations.size()) * points.spacing_m * points.spacing_m;
  group.Thin(kMostEdgePoints);
  if (group.observations.size() < kLeastRimPoints) group = Group();
  return group;
}

Group EndGroup(const StripKey& key, const Strip& strip, const FitPoints& points, const Shape& shape, const Parameters& parameters,
               const WallSelection& selection) {
  const double gsd = selection.gsd_m;
  const Part& part = shape.parts[static_cast<size_t>(key.part)];
  const double tilt = 1.0 / std::sqrt(1.0 + strip.rise * strip.rise);
  Group group;
  for (const WallPiece& piece : strip.pieces) {
    const double margin = std::min(kRimCorner_gsd * gsd, 0.2 * (piece.to - piece.from));
    const double length = piece.to - piece.from - 2.0 * margin;
    const auto stretches = std::max(1, static_cast<int>(length / kStretch_m));
    std::vector<double> deep(static_cast<size_t>(stretches), 0.0), beyond(deep);
    for (const FitPoint& point : points.roof) {
      const Eigen::Vector2d uv = InAxes(shape, point.place);
      const double place = (uv[1 - piece.axis] - piece.from - margin) / length * stretches;
      const double out = InFront(shape, piece, uv);
      if (place < 0.0 || place >= stretches || out < -kInside_m - kDeep_m || out > kBeyond_m) continue;
      const double off = tilt * (point.z - RoofHeight(shape, part, uv));
      if (off < -2.0 * gsd || off > (strip.pitched ? 2.0 * gsd : kEndParapet_m)) continue;
      (out < -kInside_m ? deep : beyond)[static_cast<size_t>(place)] += 1.0;
    }
    const double expected = kDeep_m * length / stretches * tilt / (points.spacing_m * points.spacing_m);
    for (int i = 0; i < stretches; ++i) {
      const auto k = static_cast<size_t>(i);
      if (deep[k] < 0.4 * std::max(expected, 5.0)) continue;
      const double end = -kInside_m + beyond[k] * kDeep_m / deep[k];
      if (end > kBeyond_m) continue;
      Eigen::Vector2d uv;
      const double along = piece.from + margin + (i + 0.5) * length / stretches;
      uv[piece.axis] = (piece.axis == 0 ? shape.u : shape.v)[static_cast<size_t>(piece.line)] + piece.side * end;
      uv[1 - piece.axis] = along;
      Observation o = EdgeObservation(key, parameters, strip.pitched);
      o.place = uv.x() * shape.AxisU() + uv.y() * shape.AxisV();
      o.value = kEndOff_gsd * gsd;
      group.observations.push_back(o);
      group.at.emplace_back(along, 0.0);
    }
  }
  group.area_m2 = 0.0;
  return group;
}

// Of a group's observations in front of their line, without what is known of their systematic error.
double MedianPlace(const Group& group, const Shape& shape) {
  std::vector<double> places;
  for (const Observation& o : group.observations) {
    const double at = (o.axis == 0 ? shape.u : shape.v)[static_cast<size_t>(o.line)];
    places.push_back(o.side * (InAxes(shape, o.place)[o.axis] - at) - o.value);
  }
  return base::Median(std::move(places));
}

}  // namespace

Rim RimOf(bool pitched, bool sloped) {
  if (!pitched) return {-1.0, 5.5, 0.2};
  return sloped ? Rim{0.5, 5.0, -0.65} : Rim{1.5, 6.0, -0.3};
}

std::vector<Group> EdgeGroups(const FitPoints& points, const Shape& shape, const Parameters& parameters, const WallSelection& selection) {
  std::vector<Group> groups;
  for (const auto& [key, strip] : StripsOf(shape, kLeastRim_m)) {
    Group group = RimGroup(key, strip, points, shape, parameters, selection);
    if (group.observations.empty() || strip.pitched) {
      // Obliques may look under an overhang: then what is steep there is the wall, and the roof ends farther out.
      Group end = EndGroup(key, strip, points, shape, parameters, selection);
      if (group.observations.empty() ||
          (!end.observations.empty() && MedianPlace(end, shape) > MedianPlace(group, shape) + kUnder_gsd * selection.gsd_m))
        group = std::move(end);
    }
    if (!group.observations.empty()) groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace skyquilt::buildings
