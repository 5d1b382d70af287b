#include "simulate/plot_furnish.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulate/noise.h"

namespace skyquilt::simulate {

using Eigen::Vector2d;

PavedArea MakePad(PadKind kind, const Vector2d& centre, const Vector2d& half, double yaw_deg) {
  const double yaw = yaw_deg * std::numbers::pi / 180.0;
  PavedArea pad;
  pad.kind = kind;
  pad.centre = centre.cast<float>();
  pad.half = half.cast<float>();
  pad.cosine = static_cast<float>(std::cos(yaw));
  pad.sine = static_cast<float>(std::sin(yaw));
  return pad;
}

void AddGardenTree(const Vector2d& position, double low_m, double high_m, CityContents& contents, base::Random& random) {
  Tree tree;
  tree.position = position;
  tree.height_m = random.Uniform(low_m, high_m);
  tree.crown_radius_m = random.Uniform(0.28, 0.38) * tree.height_m;
  tree.conifer = random.UniformDouble() < 0.2;
  tree.seed = random.NextU32();
  if (TreeFits(tree, contents, 0)) contents.trees.push_back(tree);
}

void MultiplyTrees(double density, size_t first_tree, const Cell& cell, CityContents& contents, base::Random& random) {
  const auto n_more = static_cast<int>(std::lround((density - 1.0) * static_cast<double>(contents.trees.size() - first_tree)));
  for (int i = 0; i < n_more; ++i) {
    const double at_y = random.Uniform(cell.min.y() + 2.0, cell.max.y() - 2.0), at_x = random.Uniform(cell.min.x() + 2.0, cell.max.x() - 2.0);
    const Vector2d at(at_x, at_y);
    const bool paved = std::any_of(cell.pads.begin(), cell.pads.end(), [&](const PavedArea& pad) {
      const Eigen::Vector2f local = pad.Local(static_cast<float>(at.x()), static_cast<float>(at.y()));
      return DistanceToRectangle(local.cast<double>(), pad.half.cast<double>()) < 0.5;
    });
    if (!paved) AddGardenTree(at, 4.0, cell.kind == CellKind::kWood ? kHighestInWood_m : 9.0, contents, random);
  }
}

void ThinTrees(double share, CityContents& contents) {
  std::erase_if(contents.trees, [share](const Tree& tree) { return static_cast<double>(HashUnit(8, 0, tree.seed)) >= share; });
}

void FlatRoofed(Building& building, double height_m, double parapet_m) {
  building.roof = RoofKind::kFlat;
  building.eave_height_m = height_m;
  building.ridge_height_m = height_m;
  building.parapet_height_m = parapet_m;
}

void AddParking(Cell& cell, const Vector2d& centre, const Vector2d& half, double fill, CityContents& contents, base::Random& random) {
  cell.pads.push_back(MakePad(PadKind::kParking, centre, half));
  for (double x = centre.x() - half.x() + 1.35; x < centre.x() + half.x() - 1.0; x += 2.7) {
    for (const double side : {-1.0, 1.0}) {
      const double pick = random.UniformDouble();
      const double turn = random.Uniform(-2.0, 2.0);
      const uint32_t seed = random.NextU32();
      if (pick > fill) continue;
      Car car;
      car.position = {x, centre.y() + side * (half.y() - 2.5)};
      car.yaw_deg = 90.0 + turn;
      car.seed = seed;
      contents.parked.push_back(car);
    }
  }
}

}  // namespace skyquilt::simulate
