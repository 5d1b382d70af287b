// Made buildings for tests: exact shapes, solids and measures. Needs no library, so that every folder of buildings/ can be tested without the others:
// add ../sample_buildings.cpp to the sources of a test. Points on them: sample_clouds.h.
#pragma once

#include <Eigen/Core>

#include "buildings/building.h"

namespace skyquilt::buildings {

// A house on axes u, v: the main part between the walls u = 0 .. length_m and v = 0 .. width_m, turned by yaw about `origin`.
struct HousePlan {
  RoofKind roof = RoofKind::kGable;
  bool along_u = true;  // direction of a gable's ridge; a hip's is along the longer side
  double length_m = 12.0, width_m = 8.0;
  double ground_z = 100.0, eave_z = 105.0, ridge_z = 108.0;  // flat: the deck is at eave_z
  Eigen::Vector2d origin = Eigen::Vector2d(20.0, 30.0);      // ENU
  double yaw_rad = 0.0;
  double overhang_m = 0.4;  // of pitched roofs
};

// Everything of Building that follows from the shape is exact: footprint, roofprint, both solids, measures (sigmas unknown).
Building MadeHouse(const HousePlan& plan, int id = 1);

// A gable wing at the main part's south wall (v < 0), between u = from_m and to_m, with the main part's eaves; its ridge runs into the main roof.
struct WingPlan {
  double from_m = 3.0, to_m = 8.0, depth_m = 5.0;
  double ridge_z = 107.0;  // not above the main ridge
};
// plan.roof is gable along u.
Building MadeTHouse(const HousePlan& plan, const WingPlan& wing, int id = 1);

// Flat: the main part, and a lower wing along its south wall from u = 0 to wing_m. plan.eave_z is the main deck.
Building MadeLHouse(const HousePlan& plan, double wing_m = 5.0, double depth_m = 4.0, double wing_deck_z = 103.0, int id = 1);

// Flat with a courtyard: four parts around it, all walls `depth_m` from the outer ones.
Building MadeCourtyard(const HousePlan& plan, double depth_m = 3.0, int id = 1);

// From the axes of the shape to ENU.
Eigen::Vector2d EnuOf(const Shape& shape, const Eigen::Vector2d& uv);
// The rectangle of a part's roof in u, v: its walls, an overhang on all sides of a pitched roof, and up to the middle of the part that it joins.
struct RoofBox {
  Eigen::Vector2d low, high;
};
RoofBox RoofBoxOf(const Shape& shape, const Part& part, double overhang_m);
// Rise per metre; 0 for flat roofs.
double SlopeOf(const Shape& shape, const Part& part);
// Height of the highest roof over a place, the overhangs included; NaN beside it. part: index of that part, may be null.
double MadeRoofHeight(const Building& building, const Eigen::Vector2d& uv, int* part = nullptr);

}  // namespace skyquilt::buildings
