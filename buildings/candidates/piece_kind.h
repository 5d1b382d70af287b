// Tells planar pieces of roofs from those of trees, cars and walls.
#pragma once

#include "buildings/buildings_options.h"
#include "buildings/planes/grow_planes.h"
#include "buildings/points/surface_points.h"

namespace skyquilt::buildings {

enum class PieceKind : uint8_t {
  kNone,      // vegetation, a wall, or too low
  kAttached,  // may be a small part of a roof beside others
  kRoof,      // may be a building by itself
};

struct PlanePiece {
  RoofPlane plane;
  PieceKind kind = PieceKind::kNone;
  bool green = false;     // a roof although it is green
  double height_m = 0.0;  // above the ground, median of its points; NaN where there is no ground
};

// plane_distance_m: PlaneOptions::distance_m with which the plane was grown.
PlanePiece JudgePiece(RoofPlane plane, const PointCloud& cloud, const GroundGrid& ground, const BuildingsOptions& options, double plane_distance_m);

}  // namespace skyquilt::buildings
