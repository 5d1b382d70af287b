#include "tests/buildings/files/sample_set.h"

#include "tests/buildings/sample_buildings.h"

namespace skyquilt::buildings {

surface::MapFrame SampleFrame(bool georeferenced) {
  scene::SceneInfo info;
  info.origin = {48.4, 9.99, 520.0};
  info.georeferenced = georeferenced;
  info.height_reference = geo::HeightReference::kEllipsoid;
  info.min_enu = Eigen::Vector3d(-150.0, -100.0, -20.0);
  info.max_enu = Eigen::Vector3d(350.0, 300.0, 60.0);
  info.gsd_m = 0.1;
  return surface::MapFrame(info);
}

BuildingSet SampleSet() {
  BuildingSet set;
  set.scale_source = "geo-reference";
  set.gsd_m = 0.1;
  const HousePlan gable = {.ground_z = -3.1, .eave_z = 1.9, .ridge_z = 5.25, .origin = {20.0, 30.0}, .yaw_rad = 0.37};
  HousePlan hip = gable;
  hip.roof = RoofKind::kHip;
  hip.origin = {80.0, -20.0};
  HousePlan yard = {.roof = RoofKind::kFlat, .length_m = 30.0, .width_m = 24.0, .ground_z = -2.0, .eave_z = 7.0, .origin = {150.0, 90.0}};
  yard.yaw_rad = 1.2;
  HousePlan l = yard;
  l.origin = {-90.0, 10.0};
  l.eave_z = 4.0;
  set.buildings = {MadeHouse(gable, 1), MadeHouse(hip, 2), MadeCourtyard(yard, 6.0, 3), MadeLHouse(l, 10.0, 6.0, 1.0, 4)};
  for (Building& building : set.buildings) {
    Measures& m = building.measures;
    double sigma = 0.01 * building.id;
    for (Measure* measure : {&m.ground_m, &m.eave_m, &m.ridge_m, &m.height_m, &m.length_m, &m.width_m, &m.yaw_deg, &m.footprint_m2, &m.roof_m2,
                             &m.volume_m3, &m.pitch_deg}) {
      measure->sigma = sigma += 0.01;
    }
    m.wall_seen = 0.25 * building.id - 0.1;
    building.share_within = 0.97;
    building.residual_m = 0.08;
    building.roof_points = 1200 + building.id;
    building.wall_points = 300;
  }
  Building& named = set.buildings[1];
  named.note = "the neighbour says \"mine\", and\nthe roof is green; ünïcode ⌂";
  named.given = true;
  named.given_id = "way/12, \"B\"";
  named.accepted = false;
  Building& unknown = set.buildings[3];
  unknown.roof = RoofKind::kOther;
  unknown.measures.pitch_deg = {};
  unknown.measures.ridge_m.sigma = kUnknown;
  unknown.measures.volume_m3.value = kUnknown;
  unknown.lod22_valid = false;
  unknown.lod22 = unknown.lod12;
  return set;
}

}  // namespace skyquilt::buildings
