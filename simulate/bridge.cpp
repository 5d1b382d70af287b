#include "simulate/bridge.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;

constexpr double kHalfLength_m = 0.5 * kDeckLength_m + kRampLength_m;
constexpr double kStep_m = 3.0;  // divides deck and ramps
constexpr size_t kSteps = 32;
static_assert(kStep_m * kSteps == 2.0 * kHalfLength_m);
constexpr double kAboveGround_m = 0.05;  // of the road where a ramp begins
constexpr double kIntoGround_m = 1.0;
constexpr float kDeckThickness_m = 1.0F;
constexpr float kRailHeight_m = 0.9F, kRailThickness_m = 0.25F;
constexpr size_t kPierSteps = 3;  // from the centre to a pier: it stands beside the street below

double AlongOf(size_t step) {
  return kStep_m * static_cast<double>(step) - kHalfLength_m;
}

class BridgeBuilder {
 public:
  BridgeBuilder(const Bridge& bridge, Mesh& mesh) : turn_(Vector2d::Zero(), bridge.yaw_deg), centre_(bridge.centre), mesh_(mesh) {}

  struct Section {
    float x, top, bottom;
  };
  // Top and sides between two cross-sections that reach from y0 to y1.
  void AddBeam(const Section& a, const Section& b, float y0, float y1, Part top) {
    mesh_.AddQuad(At(a.x, y0, a.top), At(b.x, y0, b.top), At(b.x, y1, b.top), At(a.x, y1, a.top), {top, 0});
    mesh_.AddQuad(At(a.x, y0, a.bottom), At(b.x, y0, b.bottom), At(b.x, y0, b.top), At(a.x, y0, a.top), kSide);
    mesh_.AddQuad(At(b.x, y1, b.bottom), At(a.x, y1, a.bottom), At(a.x, y1, a.top), At(b.x, y1, b.top), kSide);
  }
  void AddUnderside(float x0, float x1, float y, float z) { mesh_.AddQuad(At(x0, y, z), At(x1, y, z), At(x1, -y, z), At(x0, -y, z), kSide); }
  // An upright face across the bridge that looks to +x or to -x.
  void AddEnd(const Section& at, float y0, float y1, bool to_plus) {
    const float from = to_plus ? y0 : y1, to = to_plus ? y1 : y0;
    mesh_.AddQuad(At(at.x, from, at.bottom), At(at.x, to, at.bottom), At(at.x, to, at.top), At(at.x, from, at.top), kSide);
  }
  void AddPier(const Section& at, float deck_thickness_m) {
    const auto yaw = static_cast<float>(std::atan2(turn_.sine(), turn_.cosine()));
    mesh_.AddBox(At(at.x, 0.0F, at.bottom), {0.5F, 3.0F, 0.0F}, at.top - deck_thickness_m - at.bottom, yaw, kSide, kSide);
  }

 private:
  static constexpr Tag kSide{Part::kBridgeConcrete, 0};
  Vector3f At(float x, float y, float z) const {
    const Vector2d at = centre_ + turn_.TurnedDirection({static_cast<double>(x), static_cast<double>(y)});
    return {static_cast<float>(at.x()), static_cast<float>(at.y()), z};
  }
  PlaneTurn turn_;
  Vector2d centre_;
  Mesh& mesh_;
};

}  // namespace

void Bridge::StandOn(const std::function<double(const Vector2d&)>& ground) {
  const PlaneTurn turn(Vector2d::Zero(), yaw_deg);
  const double deck_z_m = ground(centre) + height_m;
  road_z_m.clear();
  bottom_z_m.clear();
  for (size_t step = 0; step <= kSteps; ++step) {
    double highest = -1e9, lowest = 1e9;
    for (const double across : {-0.5, 0.0, 0.5}) {
      const double z = ground(centre + turn.TurnedDirection({AlongOf(step), across * kBridgeWidth_m}));
      highest = std::max(highest, z);
      lowest = std::min(lowest, z);
    }
    // The ramps follow the ground below, so that it comes out of them nowhere.
    const double share = std::min((kHalfLength_m - std::abs(AlongOf(step))) / kRampLength_m, 1.0);
    const double foot = highest + kAboveGround_m;
    road_z_m.push_back(std::lerp(foot, deck_z_m, share));
    bottom_z_m.push_back(lowest - kIntoGround_m);
  }
}

double Bridge::DistanceTo(const Vector2d& at) const {
  return DistanceToRectangle(Local(at), {kHalfLength_m, 0.5 * kBridgeWidth_m});
}

std::optional<Bridge::RoadPoint> Bridge::RoadFor(const Vector2d& at, const Vector2d& direction) const {
  const PlaneTurn turn(Vector2d::Zero(), yaw_deg);
  const Vector2d axis = turn.TurnedDirection(Vector2d::UnitX());
  if (DistanceTo(at) > 0.0 || std::abs(axis.dot(direction)) < 0.7) return std::nullopt;
  const double steps = (Local(at).x() + kHalfLength_m) / kStep_m;
  const size_t step = std::min(static_cast<size_t>(std::max(steps, 0.0)), kSteps - 1);
  const double rise_m = road_z_m[step + 1] - road_z_m[step];
  return RoadPoint{road_z_m[step] + (steps - static_cast<double>(step)) * rise_m, rise_m / kStep_m * axis};
}

void AddBridge(const Bridge& bridge, Mesh& mesh) {
  BridgeBuilder builder(bridge, mesh);
  constexpr auto kHalf = static_cast<float>(0.5 * kBridgeWidth_m);
  const auto SectionAt = [&](size_t step) {
    return BridgeBuilder::Section{static_cast<float>(AlongOf(step)), static_cast<float>(bridge.road_z_m[step]),
                                  static_cast<float>(bridge.bottom_z_m[step])};
  };
  const auto RailAt = [&](size_t step) {
    const BridgeBuilder::Section road = SectionAt(step);
    return BridgeBuilder::Section{road.x, road.top + kRailHeight_m, road.top};
  };
  constexpr auto kRampSteps = static_cast<size_t>(kRampLength_m / kStep_m);
  for (size_t step = 0; step < kSteps; ++step) {
    BridgeBuilder::Section a = SectionAt(step), b = SectionAt(step + 1);
    const bool on_deck = step >= kRampSteps && step < kSteps - kRampSteps;
    if (on_deck) {
      a.bottom = a.top - kDeckThickness_m;
      b.bottom = b.top - kDeckThickness_m;
      builder.AddUnderside(a.x, b.x, kHalf, a.bottom);
    }
    builder.AddBeam(a, b, -kHalf, kHalf, Part::kBridgeRoad);
    for (const float edge : {-kHalf, kHalf - kRailThickness_m})
      builder.AddBeam(RailAt(step), RailAt(step + 1), edge, edge + kRailThickness_m, Part::kBridgeConcrete);
  }
  for (const bool to_plus : {false, true}) {
    const size_t foot = to_plus ? kSteps : 0, abutment = to_plus ? kSteps - kRampSteps : kRampSteps;
    builder.AddEnd(SectionAt(foot), -kHalf, kHalf, to_plus);
    for (const float edge : {-kHalf, kHalf - kRailThickness_m}) builder.AddEnd(RailAt(foot), edge, edge + kRailThickness_m, to_plus);
    builder.AddEnd(SectionAt(abutment), -kHalf, kHalf, !to_plus);
    const size_t pier = to_plus ? kSteps / 2 + kPierSteps : kSteps / 2 - kPierSteps;
    builder.AddPier(SectionAt(pier), kDeckThickness_m);
  }
}

}  // namespace skyquilt::simulate
