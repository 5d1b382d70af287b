#include "buildings/fit/wall_groups.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "buildings/fit/height_mode.h"
#include "buildings/fit/wall_strips.h"

namespace skyquilt::buildings {
namespace {

constexpr double kLowestWall_m = 1.0;
constexpr double kWallCorner_gsd = 2.5;   // left out at the ends of walls
constexpr double kFoot_gsd = 2.5;         // and at their feet
constexpr double kHidden_gsd = 9.5;       // below the rim of an overhang
constexpr double kRimEnds_gsd = 4.0;      // from there the surface goes back from the rim
constexpr double kWallBegins_gsd = 15.0;  // to the wall, evenly
constexpr double kRim_gsd = 5.5;          // below that of a flat roof: counted there
constexpr double kNearWall_gsd = 3.0;     // from the densest distance
constexpr size_t kLeastWallPoints = 12;
constexpr double kLeastCover = 0.3;  // of the length of a wall with points
constexpr double kBin_m = 0.5;
constexpr double kFullTrust = 0.6;  // views relative to the roof's above which points count fully
constexpr size_t kMostWallPoints = 1200;

double TrustOf(double views, double roof_views) {
  if (!(roof_views > 0.0)) return 1.0;
  const double share = std::clamp(views / roof_views / kFullTrust, 0.1, 1.0);
  return share * share;
}

double CoveredShare(const Strip& strip, const std::vector<StripPoint>& points) {
  std::set<long> bins;
  for (const StripPoint& point : points) bins.insert(std::lround(point.along / kBin_m));
  return static_cast<double>(bins.size()) * kBin_m / std::max(strip.Length(), kBin_m);
}

}  // namespace

double SetBack_gsd(double views, double roof_views) {
  if (!(roof_views > 0.0)) return 0.0;
  const double missing = std::max(0.0, 0.85 - views / roof_views);
  return 0.2 + 4.7 * missing * missing;
}

std::vector<Group> WallGroups(const FitPoints& points, const Shape& shape, const Parameters& parameters, const WallSelection& selection) {
  const double gsd = selection.gsd_m;
  std::vector<Group> groups;
  for (const auto& [key, strip] : StripsOf(shape, kLowestWall_m)) {
    const double top = (strip.pitched ? kHidden_gsd : kRim_gsd) * gsd;
    std::vector<StripPoint> chosen;
    std::vector<double> distance, trust, reach;
    for (const StripPoint& one : PointsOf(strip, points, shape, selection.overhang_m, kWallCorner_gsd * gsd, 2.0 * selection.window_m)) {
      if (one.below < top || one.above < kFoot_gsd * gsd) continue;
      // Low walls are not seen under an overhang.
      if (strip.pitched && one.below + one.above < (kWallBegins_gsd + kFoot_gsd) * gsd) continue;
      const double in_front = strip.pitched ? std::clamp((kWallBegins_gsd - one.below / gsd) / (kWallBegins_gsd - kRimEnds_gsd), 0.0, 1.0) : 0.0;
      const double set_back = SetBack_gsd(one.point->views, points.roof_views) * gsd;
      const double off = one.out + set_back - in_front * selection.overhang_m;
      if (std::abs(off) > selection.window_m) continue;
      chosen.push_back(one);
      distance.push_back(off);
      reach.push_back(in_front);
      trust.push_back(TrustOf(one.point->views, points.roof_views));
    }
    if (chosen.size() < kLeastWallPoints) continue;
    const std::vector<Mode> modes = Modes(distance, trust, gsd);
    Group group;
    std::vector<StripPoint> near;
    for (size_t i = 0; i < chosen.size(); ++i) {
      if (std::abs(distance[i] - modes.front().at) > kNearWall_gsd * gsd) continue;
      near.push_back(chosen[i]);
      Observation o;
      o.kind = ObservationKind::kLine;
      o.parameter = parameters.overhang(strip.pitched);
      o.reach = reach[i];
      o.place = chosen[i].point->place;
      o.axis = key.axis;
      o.line = key.line;
      o.side = key.side;
      o.part = key.part;
      o.trust = trust[i];
      o.value = -SetBack_gsd(chosen[i].point->views, points.roof_views) * gsd;
      group.observations.push_back(o);
      group.at.emplace_back(chosen[i].along, chosen[i].point->z);
    }
    if (near.size() < kLeastWallPoints || CoveredShare(strip, near) < kLeastCover) continue;
    group.area_m2 = static_cast<double>(near.size()) * points.spacing_m * points.spacing_m;
    group.Thin(kMostWallPoints);
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace skyquilt::buildings
