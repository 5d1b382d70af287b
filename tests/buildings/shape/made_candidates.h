// Candidates for tests of the shape: points sampled on made buildings, with noise.
#pragma once

#include <cstdint>
#include <vector>

#include "buildings/building.h"
#include "buildings/candidates/find_candidates.h"
#include "buildings/points/surface_points.h"

namespace skyquilt::buildings {

struct MadePlan {
  double overhang_m = 0.4;  // of pitched parts
  double noise_m = 0.08;    // along the normal
  double normal_noise = 0.15;
  double wall_share = 0.7;  // of the wall points that were seen
  uint64_t seed = 1;
};

struct MadeCandidate {
  PointCloud cloud;
  Candidate candidate;
};

// Points on the highest roof everywhere and on the walls between roofs of different heights. boxes: of what stands on the roofs; not of `shape`.
MadeCandidate MakeCandidate(const Shape& shape, const MadePlan& plan = {}, const std::vector<Part>& boxes = {});
// A flat cylinder.
MadeCandidate MakeRoundCandidate(double radius_m, double height_m, const MadePlan& plan = {});

Shape AxesAt(double yaw_deg, std::vector<double> u, std::vector<double> v);
Part FlatPart(int u0, int u1, int v0, int v1, double z);
Part PitchedPart(RoofKind roof, int u0, int u1, int v0, int v1, bool along_u, double eave_z, double ridge_z, int joins = -1);

// Intersection over union of the walls of two shapes, by counting places on a grid of 0.2 m.
double OverlapOf(const Shape& a, const Shape& b);

}  // namespace skyquilt::buildings
