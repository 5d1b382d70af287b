// A bridge that carries a street over its crossing with another one: a level deck on piers between two solid ramps, no wider than the street. It is
// not a building; a method that looks for buildings may take it for one.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "simulate/plane_turn.h"
#include "simulate/tagged_mesh.h"

namespace skyquilt::simulate {

inline constexpr double kBridgeWidth_m = 8.0;  // parapets included
inline constexpr double kDeckLength_m = 30.0;
inline constexpr double kRampLength_m = 33.0;

struct Bridge {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // of the deck, on the crossing; ENU metres
  double yaw_deg = 0.0;                              // of the street that it carries, counter-clockwise from east
  double height_m = 5.5;                             // of the road on the deck, above the ground at the centre
  int street = 0;                                    // number of that street (GroundSample::street)
  // Set by StandOn.
  std::vector<double> road_z_m;    // ENU heights of the road at equal steps along it, from one foot to the other
  std::vector<double> bottom_z_m;  // below the ground at the same places

  // `ground`: ENU height of the ground at a place (east, north).
  void StandOn(const std::function<double(const Eigen::Vector2d&)>& ground);
  // A place along the street and across it, metres from the centre.
  Eigen::Vector2d Local(const Eigen::Vector2d& at) const { return PlaneTurn(centre, yaw_deg).TurnedBack(at) - centre; }
  // Horizontal distance to deck and ramps; negative on them.
  double DistanceTo(const Eigen::Vector2d& at) const;
  struct RoadPoint {
    double z_m = 0.0;                                // ENU
    Eigen::Vector2d rise = Eigen::Vector2d::Zero();  // per metre to the east and to the north
  };
  // Of traffic at a place that goes along `direction` (unit); none for traffic beside the bridge or below it.
  std::optional<RoadPoint> RoadFor(const Eigen::Vector2d& at, const Eigen::Vector2d& direction) const;
};

// Adds the triangles of a bridge that stands on its ground, tagged with object 0.
void AddBridge(const Bridge& bridge, Mesh& mesh);

}  // namespace skyquilt::simulate
