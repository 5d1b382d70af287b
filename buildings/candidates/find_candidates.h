// Which points of the surface may be buildings: what stands above the ground, is planar and no vegetation; or what is inside given outlines.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "buildings/buildings_options.h"
#include "buildings/geometry/polygon.h"
#include "buildings/planes/grow_planes.h"
#include "buildings/points/surface_points.h"
#include "core/base/thread_pool.h"

namespace skyquilt::buildings {

struct Candidate {
  std::vector<uint32_t> roof;     // points of roof planes and of what stands on them, indices into the cloud
  std::vector<uint32_t> wall;     // steep points (|normal.z| < 0.35) within 2 m of the outline and below the roof
  std::vector<uint32_t> ground;   // ground points in a ring of 0.5 to 3 m around the outline
  std::vector<RoofPlane> planes;  // of the roof, largest first
  Polygon outline;                // of the roof seen from above, ENU, along raster cells (finding) or as given
  bool given = false;
  std::string given_id;
  double edge_share = 0.0;  // of the outline's length that is where the survey ends; the building may go on there
};

struct GivenOutline {
  Polygon outline;  // ENU
  std::string id;
};

// Largest outline first. Points are candidates when they rise at least options.min_height_m above the ground and belong to a planar piece of at least
// 4 m2 that is not vegetation (excess green of its colours at most options.max_green unless it is large, even and planar; normals that do not
// scatter). Pieces that touch seen from above are one candidate. Outlines smaller than options.min_area_m2 are left out, and so is what hardly drops
// to its surroundings (water, ghosts at the edge of the survey), what runs on at both ends (bridges), and what is made of small planes only (crowns
// of trees; more strictly where hardly anything of the surface is green, so that colours cannot tell vegetation). The outline holds parapets and
// boxes on the roof; courtyards from 4 m2 are holes. Limits: trucks and containers above min_height_m and min_area_m2 are candidates; so are bridges
// that leave the survey at both ends, and hedges cut flat that are not green. A house that is hidden by trees on most of its border may be missed.
std::vector<Candidate> FindCandidates(const PointCloud& cloud, const GroundGrid& ground, const BuildingsOptions& options, double gsd_m,
                                      base::ThreadPool& threads);
// The same for known outlines: one candidate each, in their order, without points where the surface has none there.
std::vector<Candidate> CandidatesIn(std::span<const GivenOutline> outlines, const PointCloud& cloud, const GroundGrid& ground,
                                    const BuildingsOptions& options, double gsd_m, base::ThreadPool& threads);

}  // namespace skyquilt::buildings
