#include "surface/maps/find_terrain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/base/random.h"
#include "surface/maps/low_outliers.h"

namespace skyquilt::surface {
namespace {

using Height = std::function<double(double, double)>;

// A raster whose place (x, y) is east and north of its south-western corner.
HeightRaster RasterFromCorner(int width, int height, double resolution_m, const Height& z) {
  HeightRaster raster;
  raster.grid = {
      .georeferenced = false, .zone = {}, .left = 0.0, .top = height * resolution_m, .resolution_m = resolution_m, .width = width, .height = height};
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const Eigen::Vector2d at = raster.grid.CellCentre(column, row);
      raster.height_m.push_back(static_cast<float>(z(at.x(), at.y())));
    }
  }
  return raster;
}

struct Box {
  double west, south, east, north, height;
  bool Contains(double x, double y) const { return x >= west && x < east && y >= south && y < north; }
};

struct Errors {
  double median = 0.0, most = 0.0, largest = 0.0;  // most: of 99 %
  size_t missing = 0;
};
Errors ErrorsOf(const HeightRaster& terrain, const Height& ground) {
  std::vector<double> errors;
  Errors result;
  for (int row = 0; row < terrain.grid.height; ++row) {
    for (int column = 0; column < terrain.grid.width; ++column) {
      const Eigen::Vector2d at = terrain.grid.CellCentre(column, row);
      const float height = terrain.height_m[terrain.grid.Index(column, row)];
      if (std::isnan(height)) {
        ++result.missing;
      } else {
        errors.push_back(std::abs(static_cast<double>(height) - ground(at.x(), at.y())));
      }
    }
  }
  std::sort(errors.begin(), errors.end());
  if (errors.empty()) return result;
  result.median = errors[errors.size() / 2];
  result.most = errors[static_cast<size_t>(0.99 * static_cast<double>(errors.size()))];
  result.largest = errors.back();
  return result;
}

const Height kTilted = [](double x, double y) { return 200.0 + 0.1 * x + 0.02 * y; };

// Buildings of 8 to 40 m, sheds, cars, trees, noise of 5 cm, gaps behind walls.
TEST(Terrain, OfATownOnASlope) {
  const std::vector<Box> buildings = {{20, 20, 60, 60, 12}, {80, 15, 95, 70, 8},     {110, 30, 118, 38, 5},     {125, 60, 165, 80, 15},
                                      {20, 90, 50, 120, 6}, {70, 100, 76, 104, 2.6}, {90, 110, 94.5, 112, 1.6}, {0, 130, 25, 160, 10}};
  base::Random random(7);
  std::vector<Eigen::Vector3d> trees;  // place, radius
  for (int i = 0; i < 40; ++i) trees.push_back({random.Uniform(100, 180), random.Uniform(85, 155), random.Uniform(1.5, 4.0)});
  const HeightRaster surface = RasterFromCorner(720, 640, 0.25, [&](double x, double y) {
    // Nothing was seen in the strip north of the tall buildings.
    if (y >= 60 && y < 63 && x > 20 && x < 60) return std::nan("");
    if (std::hypot(x - 150, y - 20) < 6) return std::nan("");
    double top = 0.0;
    for (const Box& box : buildings) {
      if (box.Contains(x, y)) top = std::max(top, box.height);
    }
    for (const Eigen::Vector3d& tree : trees) {
      const double r = std::hypot(x - tree.x(), y - tree.y());
      if (r < tree.z()) top = std::max(top, 4.0 + 2.0 * std::sqrt(tree.z() * tree.z() - r * r) + random.Uniform(-1.0, 1.0));
    }
    return kTilted(x, y) + top + 0.05 * random.Normal();
  });
  const Terrain terrain = FindTerrain(surface, {});
  const Errors errors = ErrorsOf(terrain.height, kTilted);
  EXPECT_EQ(errors.missing, 0U);
  EXPECT_LT(errors.median, 0.05);
  EXPECT_LT(errors.most, 0.25);
  EXPECT_LT(errors.largest, 0.6);
  size_t wrong = 0;
  for (int row = 0; row < 640; ++row) {
    for (int column = 0; column < 720; ++column) {
      const Eigen::Vector2d at = surface.grid.CellCentre(column, row);
      const size_t cell = static_cast<size_t>(row) * 720 + static_cast<size_t>(column);
      const double above = static_cast<double>(surface.height_m[cell]) - kTilted(at.x(), at.y());
      if (std::isnan(above) && terrain.is_ground[cell] != 0) ++wrong;
      if (std::abs(above) < 0.15 && terrain.is_ground[cell] == 0) ++wrong;
      if (above > 1.0 && terrain.is_ground[cell] != 0) ++wrong;
    }
  }
  EXPECT_LT(wrong, 720 * 640 / 500);
}

TEST(Terrain, HillsAndBanksSurvive) {
  // A round hill with slopes of 20 %, and a bank of 30 % along the east.
  const Height hill = [](double x, double y) {
    return 50.0 + std::max(0.0, 12.0 - 0.2 * std::hypot(x - 80.0, y - 80.0)) + std::clamp(0.3 * (x - 160.0), 0.0, 6.0);
  };
  const HeightRaster surface = RasterFromCorner(400, 320, 0.5, hill);
  const Terrain terrain = FindTerrain(surface, {});
  EXPECT_LT(ErrorsOf(terrain.height, hill).largest, 0.1);
  EXPECT_EQ(std::count(terrain.is_ground.begin(), terrain.is_ground.end(), uint8_t{1}), 400 * 320);
}

TEST(Terrain, AlleysBetweenHousesAreGround) {
  // Rows of houses 10 m deep, alleys of 3 m between them that end in a street.
  const Height ground = [](double x, double) { return 10.0 + 0.03 * x; };
  const auto house = [](double x, double y) { return y > 10.0 && std::fmod(y - 10.0, 13.0) < 10.0 && x > 8.0; };
  const HeightRaster surface = RasterFromCorner(400, 400, 0.2, [&](double x, double y) { return ground(x, y) + (house(x, y) ? 7.0 : 0.0); });
  const Terrain terrain = FindTerrain(surface, {});
  EXPECT_LT(ErrorsOf(terrain.height, ground).largest, 0.3);
  size_t alley = 0, found = 0;
  for (int row = 0; row < 400; ++row) {
    for (int column = 0; column < 400; ++column) {
      const Eigen::Vector2d at = surface.grid.CellCentre(column, row);
      if (house(at.x(), at.y())) continue;
      ++alley;
      found += terrain.is_ground[static_cast<size_t>(row) * 400 + static_cast<size_t>(column)];
    }
  }
  EXPECT_GT(static_cast<double>(found), 0.99 * static_cast<double>(alley));
}

TEST(Terrain, PitsAreRemoved) {
  const std::vector<Box> pits = {{20, 20, 23, 23, -4}, {60, 40, 61, 44, -2}, {40, 70, 40.5, 70.5, -30}};
  const HeightRaster surface = RasterFromCorner(400, 400, 0.25, [&](double x, double y) {
    double depth = 0.0;
    for (const Box& pit : pits) {
      if (pit.Contains(x, y)) depth = pit.height;
    }
    return kTilted(x, y) + depth;
  });
  const Terrain terrain = FindTerrain(surface, {});
  EXPECT_LT(ErrorsOf(terrain.height, kTilted).largest, 0.1);
  EXPECT_EQ(terrain.is_ground[static_cast<size_t>(400 - 1 - 4 * 21) * 400 + 4 * 21], 0);
}

TEST(Terrain, GroundUnderTreesIsKept) {
  // A closed forest of rough crowns, with the ground seen through holes of 1.5 m.
  base::Random random(5);
  const HeightRaster surface = RasterFromCorner(400, 400, 0.25, [&](double x, double y) {
    const bool hole = std::fmod(x, 10.0) < 1.5 && std::fmod(y, 10.0) < 1.5;
    return kTilted(x, y) + (hole ? 0.0 : 12.0 + random.Uniform(-3.0, 3.0));
  });
  const Errors errors = ErrorsOf(FindTerrain(surface, {}).height, kTilted);
  EXPECT_LT(errors.median, 0.1);
  EXPECT_LT(errors.most, 0.5);
}

TEST(Terrain, OnlyInsideTheOutline) {
  // A disc of data with a lake of 20 m in it, which is filled; the corners stay empty.
  const HeightRaster surface = RasterFromCorner(300, 300, 0.5, [](double x, double y) {
    const double r = std::hypot(x - 75.0, y - 75.0);
    return r > 60.0 || r < 10.0 ? std::nan("") : kTilted(x, y);
  });
  const Terrain terrain = FindTerrain(surface, {});
  size_t outside = 0;
  for (int row = 0; row < 300; ++row) {
    for (int column = 0; column < 300; ++column) {
      const Eigen::Vector2d at = surface.grid.CellCentre(column, row);
      const double r = std::hypot(at.x() - 75.0, at.y() - 75.0);
      const float height = terrain.height.height_m[static_cast<size_t>(row) * 300 + static_cast<size_t>(column)];
      if (r < 60.0) {
        EXPECT_NEAR(height, kTilted(at.x(), at.y()), 0.05);
      } else if (r > 75.0) {
        EXPECT_TRUE(std::isnan(height)) << at.transpose();
      }
      outside += std::isnan(height) ? 1 : 0;
    }
  }
  EXPECT_GT(outside, 300U * 300U / 5);
}

TEST(Terrain, FinestDetailOfTheGroundIsKept) {
  // A kerb of 15 cm stays a kerb, instead of a ramp over several working cells.
  const Height kerb = [](double x, double) { return x < 25.0 ? 3.0 : 3.15; };
  const HeightRaster surface = RasterFromCorner(500, 100, 0.1, kerb);
  const Terrain terrain = FindTerrain(surface, {});
  EXPECT_NEAR(terrain.height.height_m[50 * 500 + 246], 3.0F, 0.01F);
  EXPECT_NEAR(terrain.height.height_m[50 * 500 + 253], 3.15F, 0.01F);
}

TEST(Terrain, EmptySmallAndBroken) {
  EXPECT_TRUE(FindTerrain({}, {}).height.height_m.empty());
  const HeightRaster none = RasterFromCorner(30, 20, 0.5, [](double, double) { return std::nan(""); });
  const Terrain nothing = FindTerrain(none, {});
  EXPECT_TRUE(std::all_of(nothing.height.height_m.begin(), nothing.height.height_m.end(), [](float height) { return std::isnan(height); }));
  EXPECT_EQ(std::count(nothing.is_ground.begin(), nothing.is_ground.end(), uint8_t{1}), 0);
  const Terrain one = FindTerrain(RasterFromCorner(1, 1, 0.5, [](double, double) { return 7.0; }), {});
  EXPECT_EQ(one.height.height_m, std::vector<float>{7.0F});
  EXPECT_EQ(one.is_ground, std::vector<uint8_t>{1});
  // A line of cells, coarser than the working cells, with an infinite height.
  HeightRaster line = RasterFromCorner(40, 1, 2.0, kTilted);
  line.height_m[20] = std::numeric_limits<float>::infinity();
  const Terrain of_line = FindTerrain(line, {});
  EXPECT_LT(ErrorsOf(of_line.height, kTilted).largest, 0.1);
  EXPECT_EQ(of_line.is_ground[20], 0);
  EXPECT_EQ(of_line.is_ground[21], 1);
  // Working cells that do not divide the raster.
  EXPECT_LT(ErrorsOf(FindTerrain(RasterFromCorner(103, 57, 0.3, kTilted), {.cell_m = 1.3}).height, kTilted).largest, 0.15);
}

TEST(LowOutliers, AlleysAndLightUnderTreesAreNoPits) {
  base::Grid<float> grid(60, 60, 10.0F);
  // A dead end of 3 x 7 m between houses, in cells of 0.5 m.
  for (int row = 20; row < 34; ++row) {
    for (int column = 0; column < 60; ++column) grid.value[grid.Index(column, row)] = column >= 27 && column < 33 ? 10.0F : 18.0F;
  }
  for (int column = 0; column < 60; ++column) grid.value[grid.Index(column, 34)] = 18.0F;
  base::Grid<float> alley = grid;
  EXPECT_EQ(RemoveLowOutliers(&alley, 0.5, 0.3), 0);
  grid.value[grid.Index(10, 8)] = 6.0F;
  EXPECT_EQ(RemoveLowOutliers(&grid, 0.5, 0.3), 1);
  EXPECT_TRUE(std::isnan(grid.At(10, 8)));
  base::Grid<float> empty(10, 10, kNoHeight);
  EXPECT_EQ(RemoveLowOutliers(&empty, 0.5, 0.3), 0);
}

TEST(LowOutliers, NoiseIsThatOfTheCells) {
  base::Random random(9);
  base::Grid<float> grid(300, 200, 0.0F);
  for (int row = 0; row < 200; ++row) {
    for (int column = 0; column < 300; ++column) {
      grid.value[grid.Index(column, row)] = static_cast<float>(0.3 * column + 0.08 * random.Normal() + (column > 150 ? 9.0 : 0.0));
    }
  }
  EXPECT_NEAR(NoiseOf(grid), 0.08, 0.004);
  EXPECT_EQ(NoiseOf(base::Grid<float>(2, 2, 1.0F)), 0.0);
}

}  // namespace
}  // namespace skyquilt::surface
