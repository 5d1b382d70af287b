// The first guess of a building's shape: its dominant directions, wall lines, which cells between them are inside (graph cut), and parts with roofs.
// Refined by fit/fit_shape.h.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "buildings/building.h"
#include "buildings/candidates/find_candidates.h"
#include "buildings/points/surface_points.h"

namespace skyquilt::buildings {

// A direction modulo 90 degrees from weighted evidence: roof planes' falls, wall normals, edges of the outline (structure.md section 4).
struct Direction {
  double yaw_rad = 0.0;  // 0 to pi/2, counter-clockwise from east
  double sigma_rad = 1.0;
  double concentration = 0.0;  // R, 0 to 1; below 0.5 the building has no dominant directions
};
Direction FindDirection(const Candidate& candidate, const PointCloud& cloud);
// Directions of neighbours (within reach_m) that differ by less than twice their standard deviation become one; others stay. Order is kept.
std::vector<Direction> ShareDirections(std::span<const Direction> directions, std::span<const Eigen::Vector2d> places, double reach_m);

struct ShapeGuess {
  Shape shape;
  bool manhattan = true;  // false: no dominant directions; the shape is the least-area rectangle
};
// Wall lines from steep points, else from edges of the roof; cells by graph cut (Boost.Graph, boykov_kolmogorov_max_flow): covered by roof or not,
// cuts cheap where walls are; then overlapping rectangles of cells with one roof each: flat, gable or hip by BIC (fit/roof_choice.h).
// ground_z: of the shape. Nothing when the candidate has too few points.
std::optional<ShapeGuess> FindShape(const Candidate& candidate, const Direction& direction, const PointCloud& cloud, double ground_z, double gsd_m);

}  // namespace skyquilt::buildings
