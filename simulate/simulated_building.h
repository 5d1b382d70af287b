// A building of a simulated place, or one part of it. Its sizes are known exactly, so that heights measured in a reconstruction can be checked
// against them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "simulate/tagged_mesh.h"

namespace skyquilt::simulate {

enum class BuildingKind { kHouse, kShed, kApartment, kTower, kHall, kGarage };
enum class RoofKind { kFlat, kGable, kHip };
// What the outline looks like from above, or for a set-back from the side.
enum class BuildingShape { kRectangle, kL, kT, kSetback, kRow, kCourtyard };
const char* KindName(BuildingKind kind);
const char* RoofName(RoofKind roof);
const char* ShapeName(BuildingShape shape);

inline constexpr double kRoofOverhang_m = 0.4;  // of all pitched roofs of plain places

// A rectangle of walls with a roof. Several that share walls or stand on each other are one outline (compound.h): nobody can tell their owners apart
// from above.
struct Building {
  BuildingKind kind = BuildingKind::kHouse;
  RoofKind roof = RoofKind::kGable;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // ENU metres
  double yaw_deg = 0.0;                              // of the length axis, counter-clockwise from east
  double length_m = 10.0;                            // between the outer walls
  double width_m = 8.0;                              // <= length_m
  double eave_height_m = 5.0;                        // top of the long walls (flat roof: the roof deck), above ground_z_m
  double ridge_height_m = 8.0;                       // above ground_z_m; flat roof: the eave height
  double parapet_height_m = 0.0;                     // above a flat roof's deck
  double overhang_m = kRoofOverhang_m;               // of a pitched roof beyond walls that stand free; not used by flat roofs
  double ground_z_m = 0.0;                           // ENU height of the ground at the centre
  double foundation_m = 1.5;                         // the walls begin this far below ground_z_m
  uint32_t seed = 0;

  BuildingShape shape = BuildingShape::kRectangle;  // of the whole outline
  uint32_t outline = 0;                             // which one; its parts follow each other in lists
  bool joined = false;                              // this part belongs to the outline of the building before it in lists
  double base_height_m = 0.0;                       // height of the deck that it stands on, above ground_z_m; 0: it stands on the ground
  // Walls at +x, +y, -x, -y of its own axes that stand against another part. The roof ends there, without overhang or parapet.
  std::array<bool, 4> shared = {};
  bool bare_roof = false;  // no chimney, stair housing or machines
  // A gable may run on at its -x end into the slope of another part's roof: height of that slope above its wall, over ground_z_m, and its rise per
  // metre. 0: it ends at the wall.
  double onto_eave_height_m = 0.0;
  double onto_rise = 0.0;

  // Rise of a pitched roof per metre; 0 for flat ones.
  double RoofRise() const { return (ridge_height_m - eave_height_m) / (0.5 * width_m); }
  // How far the roof reaches beyond walls that stand free; 0 for flat ones.
  double RoofOverhang() const { return roof == RoofKind::kFlat ? 0.0 : overhang_m; }
  // Height of the roof's lowest edge, above ground_z_m.
  double RoofEdgeHeight() const { return eave_height_m - RoofRise() * RoofOverhang(); }
  // Unit vector of the length axis, east and north.
  Eigen::Vector2d Axis() const;
  // A point in the building's own axes, metres: x along the length, y along the width, z above ground_z_m.
  Eigen::Vector3f Local(const Eigen::Vector3f& x_in_enu) const { return Local(x_in_enu, Axis().cast<float>()); }
  // The same for a caller that already has Axis().
  Eigen::Vector3f Local(const Eigen::Vector3f& x_in_enu, const Eigen::Vector2f& axis) const;
  // Horizontal distance of a point (east, north) to the walls, metres; negative inside.
  double DistanceTo(const Eigen::Vector2d& point) const;
};

// Free room between two buildings, metres, their overhangs not counted: never more than the distance of their walls; negative: they overlap.
double Clearance(const Building& a, const Building& b);

// Adds the building's triangles, tagged with `index`. The walls' foundation leaves no gap on slopes.
void AddBuilding(const Building& building, uint32_t index, Mesh& mesh);

}  // namespace skyquilt::simulate
