// Stage buildings: from the points of a finished surface to measured buildings.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "buildings/building.h"
#include "buildings/buildings_options.h"
#include "buildings/candidates/find_candidates.h"
#include "buildings/points/surface_points.h"
#include "core/base/thread_pool.h"
#include "core/geo/place_accuracy.h"

namespace skyquilt::buildings {

struct BuildingsInput {
  BuildingsOptions options;
  const PointCloud* cloud = nullptr;
  const GroundGrid* ground = nullptr;
  std::vector<GivenOutline> footprints;  // empty: buildings are found
  std::vector<Eigen::Vector3d> matched;  // points that were matched in photos, ENU; they deny roofs that only the field has. May be empty
  bool georeferenced = false;
  geo::PlaceAccuracy accuracy;
  double gsd_m = 0.0;  // of the finest block
};

// Buildings from west to east by the middle of their footprints, numbered from 1. Candidates that no shape describes become blocks (RoofKind::kOther)
// with a note, or are left out: when they have no planes, when matched points deny their roof, or when they are neither level nor of any shape and no
// matched point confirms them. Deterministic for any number of threads. Throws base::UsageError (options, a scale bar of length 0),
// base::Interrupted.
BuildingSet MakeBuildings(const BuildingsInput& input, base::ThreadPool& threads);

}  // namespace skyquilt::buildings
