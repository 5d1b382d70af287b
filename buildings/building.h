// What is found of a building: its shape as parts on common axes, solids, and measures with their uncertainty.
// Frames: survey ENU in metres (x east, y north, z up); a building's own axes u, v are ENU turned by yaw about `origin`. Without a known scale
// "metres" are units of the local frame (BuildingSet::metric is false).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "buildings/geometry/polygon.h"
#include "buildings/solids/solid.h"

namespace skyquilt::buildings {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// A figure with one standard deviation; NaN: not known.
struct Measure {
  double value = kUnknown;
  double sigma = kUnknown;
};

// kOther: no parametric roof fits; the part is a block up to its median roof height.
enum class RoofKind : uint8_t { kFlat, kGable, kHip, kOther };
const char* NameOf(RoofKind roof);            // "flat", "gable", "hip", "other"
RoofKind RoofNamed(const std::string& name);  // throws base::UsageError

// A rectangle of walls with a roof. Walls are the lines u = u[u0], u[u1], v = v[v0], v[v1] of the shape; u0 < u1, v0 < v1.
// Gable: two slopes that meet at a level ridge halfway between the walls, along u or v. Hip: four slopes of equal pitch, the ridge along the longer
// side (along_u says which). Eave: height of the roof's plane above the wall line. Flat and other: eave_z == ridge_z.
struct Part {
  int u0 = 0, u1 = 1, v0 = 0, v1 = 1;
  RoofKind roof = RoofKind::kFlat;
  bool along_u = true;  // direction of the ridge
  double eave_z = 0.0;  // ENU metres
  double ridge_z = 0.0;
  int joins = -1;  // index of a pitched part into whose roof this gable's ridge runs on, up to its middle; -1: none
};

// A Manhattan shape: parts may overlap in plan; the roof is the highest of them everywhere, the footprint their union.
struct Shape {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  // ENU
  double yaw_rad = 0.0;                              // of the u axis, counter-clockwise from east
  std::vector<double> u, v;                          // positions of wall lines along the axes, rising, metres from the origin
  std::vector<Part> parts;                           // at least one
  double ground_z = 0.0;                             // ENU metres

  Eigen::Vector2d AxisU() const;
  Eigen::Vector2d AxisV() const;
  Eigen::Vector2d EnuFrom(const Eigen::Vector2d& uv) const;
  Eigen::Vector2d FromEnu(const Eigen::Vector2d& enu) const;
  // Rectangle of a part in u, v: min and max corner. With roof: extended under Part::joins.
  Eigen::Vector2d MinOf(const Part& part, bool roof) const;
  Eigen::Vector2d MaxOf(const Part& part, bool roof) const;
};
// Height of the roof of one part at a place in u, v, continued beyond its walls.
double RoofHeight(const Shape& shape, const Part& part, const Eigen::Vector2d& uv);
// Highest roof of all parts that cover the place (joined roofs included); NaN outside all walls. part: index of that part, may be null.
double RoofHeight(const Shape& shape, const Eigen::Vector2d& uv, int* part = nullptr);

struct Measures {
  Measure ground_m;  // heights of ENU z here; files convert them to the height system of the maps
  Measure eave_m;    // of the largest part
  Measure ridge_m;   // highest of all parts; flat roofs: the deck
  Measure height_m;  // ridge_m - ground_m
  Measure length_m;  // between outer walls, of the rectangle around the walls along the building's axes; the longer side
  Measure width_m;
  Measure yaw_deg;  // of the length axis, counter-clockwise from east, 0 to 180
  Measure footprint_m2;
  Measure roof_m2;  // sloped area over the walls, without overhang
  Measure volume_m3;
  Measure pitch_deg;       // of the largest part; 0 for flat roofs
  double wall_seen = 0.0;  // share of the area of outer walls that is within 2 GSD of the surface of at least three views
};

struct Building {
  int id = 0;  // from 1, in the order of the list
  Shape shape;
  RoofKind roof = RoofKind::kFlat;  // of the largest part; kOther also for compound shapes that no parts describe
  Polygon footprint;                // walls, ENU east and north
  std::vector<Polygon> roofprint;   // outline of the roof as seen from above, with overhangs
  double overhang_m = 0.0;          // of pitched roofs, as found or assumed
  bool overhang_measured = false;
  Measures measures;
  Solid lod12;  // block: footprint up to the area-weighted roof height
  Solid lod22;  // with its roof; same as lod12 when lod22_valid is false
  bool lod22_valid = true;
  bool accepted = true;       // at least 85 % of the roof's points lie within 2 GSD of the model, which the survey's edge does not cut
  double share_within = 0.0;  // that share
  double residual_m = 0.0;    // robust standard deviation (1.48 MAD) of the roof's points from it
  int64_t roof_points = 0, wall_points = 0;
  bool walls_from_points = false;  // false: walls stand where the roof ends, less the overhang
  bool given = false;              // the outline was given (--footprints)
  std::string given_id;            // its identity in that file, may be empty
  std::string note;                // what a person should know, one sentence; may be empty
};

struct BuildingSet {
  std::vector<Building> buildings;
  bool metric = true;        // lengths are metres; false: of unknown scale, no unit may be printed
  double scale = 1.0;        // already applied to all lengths: factor of --scale-bar, 1 without
  std::string scale_source;  // "geo-reference", "scale bar" (here or of the survey), "unknown"
  double gsd_m = 0.0;
};

}  // namespace skyquilt::buildings
