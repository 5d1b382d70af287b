// Things that are put on the plots of a city: pads, trees, parked cars; and who fills the cells of varied towns. Private to the folder.
#pragma once

#include <Eigen/Core>

#include "simulate/city_layout.h"

namespace skyquilt::simulate {

inline constexpr double kHighestInWood_m = 14.0;

PavedArea MakePad(PadKind kind, const Eigen::Vector2d& centre, const Eigen::Vector2d& half, double yaw_deg = 0.0);
// Not where it would touch a building or stand in a pond.
void AddGardenTree(const Eigen::Vector2d& position, double low_m, double high_m, CityContents& contents, base::Random& random);
// Adds trees until the cell has `density` times as many as from index `first_tree` on, as far as there is room beside buildings and on unpaved
// ground.
void MultiplyTrees(double density, size_t first_tree, const Cell& cell, CityContents& contents, base::Random& random);
// Keeps this share of all trees.
void ThinTrees(double share, CityContents& contents);
void FlatRoofed(Building& building, double height_m, double parapet_m);
// Two lines of cars along x; fill: share of the places that are taken.
void AddParking(Cell& cell, const Eigen::Vector2d& centre, const Eigen::Vector2d& half, double fill, CityContents& contents, base::Random& random);

// Like the plain cells of the same kinds, with buildings of many shapes (option simulate.building_shapes).
void FurnishVariedHouses(const CityPlan& plan, Cell& cell, CityContents& contents, base::Random& random);
void FurnishVariedFlats(Cell& cell, CityContents& contents, base::Random& random);
void FurnishVariedTowers(Cell& cell, CityContents& contents, base::Random& random);

}  // namespace skyquilt::simulate
