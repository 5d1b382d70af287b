// True buildings and found ones that agree with them, for tests of their scores.
#pragma once

#include <cmath>
#include <numbers>
#include <utility>

#include "evaluate/buildings/buildings_scorer.h"
#include "evaluate/buildings/match_buildings.h"
#include "tests/buildings/sample_buildings.h"

namespace skyquilt::evaluate::buildings {

inline Polygon Square(double west, double south, double size_m) {
  return {{{west, south}, {west + size_m, south}, {west + size_m, south + size_m}, {west, south + size_m}}, {}};
}

// What the truth says of a building that was measured without error.
inline TrueBuilding TruthOf(const Building& building) {
  const skyquilt::buildings::Measures& measures = building.measures;
  TrueBuilding truth;
  truth.id = building.id - 1;
  truth.shape = "rectangle";
  truth.kind = "house";
  truth.roof = building.roof;
  truth.walls = building.footprint;
  truth.ground_z_m = measures.ground_m.value;
  truth.eave_z_m = measures.eave_m.value;
  truth.ridge_z_m = measures.ridge_m.value;
  truth.length_m = measures.length_m.value;
  truth.width_m = measures.width_m.value;
  truth.yaw_deg = measures.yaw_deg.value;
  truth.area_m2 = measures.footprint_m2.value;
  return truth;
}

// Gable, hip and flat roofs side by side, 40 m apart; the sheds among them have less than 50 m2.
inline BuildingSet MadeTown(int n) {
  BuildingSet set;
  set.scale_source = "geo-reference";
  set.gsd_m = 0.2;
  for (int i = 0; i < n; ++i) {
    skyquilt::buildings::HousePlan plan;
    plan.roof = i % 3 == 0 ? RoofKind::kGable : i % 3 == 1 ? RoofKind::kHip : RoofKind::kFlat;
    plan.length_m = i % 4 == 3 ? 7.0 : 12.0 + 0.5 * i;
    plan.width_m = i % 4 == 3 ? 5.0 : 8.0;
    plan.origin = {40.0 * (i % 8), 40.0 * std::floor(i / 8.0)};
    plan.yaw_rad = 0.1 * i;
    set.buildings.push_back(skyquilt::buildings::MadeHouse(plan, i + 1));
  }
  return set;
}

inline ComparedBuildings Compared(BuildingSet set, TrueBuildings truth) {
  ComparedBuildings compared;
  compared.matches = MatchBuildings(set, truth);
  compared.set = std::move(set);
  compared.truth = std::move(truth);
  return compared;
}

inline TrueBuildings TruthOf(const BuildingSet& set) {
  TrueBuildings truth;
  for (const Building& building : set.buildings) truth.outlines.push_back(TruthOf(building));
  return truth;
}

}  // namespace skyquilt::evaluate::buildings
