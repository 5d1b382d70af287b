// Initially occupied cells: between the sparse points, or near the surfaces of the context.
#include "worker/start/starting_occupancy.h"

#include <gtest/gtest.h>

#include "core/base/random.h"

namespace skyquilt::worker {
namespace {

// A box of 40 x 40 x 20 m with cells of half a metre, all seen.
render::TrainedField EmptyField() {
  render::TrainedField f;
  f.map = encoding::SpaceMap::Box({0.0, 0.0, 0.0}, {40.0, 40.0, 20.0});
  double extent[3];
  for (int axis = 0; axis < 3; ++axis) extent[axis] = f.map.extent()[axis];
  f.occupancy = field::OccupancyGrid::Make(extent, 0.5 * f.map.units_per_metre(), 4'000'000);
  f.step_m = 0.25;
  return f;
}

bool Occupied(const render::TrainedField& f, double x, double y, double z) {
  const Eigen::Vector3f unit = f.map.UnitFromEnu({x, y, z});
  return f.occupancy.occupied[static_cast<size_t>(f.occupancy.IndexAt(unit.x(), unit.y(), unit.z()))];
}

survey::SparsePoint PointAt(double x, double y, double z) {
  survey::SparsePoint point;
  point.x_in_enu = {x, y, z};
  return point;
}

// Ground at 3 m with a tower of 15 m over x, y in 18..22, and no points at all where x > 30.
survey::Survey TownOfOneTower() {
  survey::Survey survey;
  base::Random random(5, 0);
  for (int i = 0; i < 6000; ++i) {
    const double x = random.Uniform(0.0, 30.0), y = random.Uniform(0.0, 40.0);
    const bool tower = std::abs(x - 20.0) < 2.0 && std::abs(y - 20.0) < 2.0;
    survey.points.push_back(PointAt(x, y, tower ? 15.0 : 3.0));
  }
  survey.points.push_back(PointAt(-5.0, 10.0, 19.0));  // outside the box: must be ignored
  return survey;
}

TEST(StartingOccupancy, PointsBoundTheSurface) {
  render::TrainedField f = EmptyField();
  StartFromPoints(TownOfOneTower(), f);
  EXPECT_TRUE(Occupied(f, 8.0, 30.0, 3.0)) << "the ground";
  EXPECT_FALSE(Occupied(f, 8.0, 30.0, 6.0)) << "free space above the ground";
  EXPECT_FALSE(Occupied(f, 1.0, 10.0, 18.0)) << "a point outside the box is ignored";
  EXPECT_TRUE(Occupied(f, 20.0, 20.0, 15.0)) << "the roof";
  EXPECT_TRUE(Occupied(f, 20.0, 20.0, 9.0)) << "walls";
  EXPECT_TRUE(Occupied(f, 17.5, 20.0, 9.0)) << "next to the tower, in a neighbouring column";
  EXPECT_FALSE(Occupied(f, 20.0, 20.0, 17.0)) << "free space above the roof";
  EXPECT_FALSE(Occupied(f, 32.5, 30.0, 10.0)) << "the ground is continued for a few columns beyond the points";
  EXPECT_TRUE(Occupied(f, 32.5, 30.0, 3.0));
  EXPECT_TRUE(Occupied(f, 38.0, 20.0, 17.0)) << "nothing is known far from points";
}

TEST(StartingOccupancy, WithoutPointsEverythingSeenStays) {
  render::TrainedField f = EmptyField();
  const size_t hidden = static_cast<size_t>(f.occupancy.Index(3, 3, 3));
  f.occupancy.occupied[hidden] = false;
  f.occupancy.tau[hidden] = -1.0F;
  const std::vector<bool> before = f.occupancy.occupied;
  StartFromPoints(survey::Survey{}, f);
  EXPECT_EQ(f.occupancy.occupied, before);
}

TEST(StartingOccupancy, EverywhereKeepsAllSeenCells) {
  render::TrainedField target;
  const double extent[3] = {1.0, 1.0, 0.5};
  target.occupancy = field::OccupancyGrid::Make(extent, 0.25, 1000);
  target.occupancy.tau[3] = -1.0F;
  target.occupancy.occupied[3] = false;
  StartEverywhere(target);
  for (size_t i = 0; i < target.occupancy.tau.size(); ++i) {
    EXPECT_EQ(target.occupancy.tau[i], i == 3 ? -1.0F : kStartTau) << i;
    EXPECT_EQ(target.occupancy.occupied[i], i != 3) << i;
  }
}

TEST(StartingOccupancy, NeverSeenCellsStayNeverSeen) {
  render::TrainedField f = EmptyField();
  const Eigen::Vector3f unit = f.map.UnitFromEnu({8.0, 30.0, 3.0});
  const auto hidden = static_cast<size_t>(f.occupancy.IndexAt(unit.x(), unit.y(), unit.z()));
  f.occupancy.occupied[hidden] = false;
  f.occupancy.tau[hidden] = -1.0F;
  StartFromPoints(TownOfOneTower(), f);
  EXPECT_FALSE(f.occupancy.occupied[hidden]);
  EXPECT_FLOAT_EQ(f.occupancy.tau[hidden], -1.0F);
}

}  // namespace
}  // namespace skyquilt::worker
