#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "core/base/random.h"
#include "core/encoding/hash_grid.h"
#include "core/encoding/space_map.h"
#include "core/encoding/spherical_harmonics.h"

namespace skyquilt::encoding {
namespace {

// Closed forms (Sloan 2013, appendix A2) along the axes.
TEST(SphericalHarmonics, MatchClosedForms) {
  double sh[16];
  SphericalHarmonics(0.0, 0.0, 1.0, 4, sh);
  EXPECT_NEAR(sh[0], 0.5 / std::sqrt(M_PI), 1e-15);
  EXPECT_NEAR(sh[2], std::sqrt(3.0 / (4.0 * M_PI)), 1e-15);
  EXPECT_NEAR(sh[6], std::sqrt(5.0 / (16.0 * M_PI)) * 2.0, 1e-14);
  EXPECT_NEAR(sh[12], std::sqrt(7.0 / (16.0 * M_PI)) * 2.0, 1e-14);
}

TEST(SphericalHarmonics, AreOrthonormalOnTheSphere) {
  // Product quadrature with 64 x 64 nodes, accurate enough for band 3.
  double gram[16][16] = {};
  const int n = 64;
  for (int i = 0; i < n; ++i) {
    const double z = -1.0 + (i + 0.5) * 2.0 / n;
    for (int j = 0; j < n; ++j) {
      const double phi = (j + 0.5) * 2.0 * M_PI / n;
      const double r = std::sqrt(1.0 - z * z);
      double sh[16];
      SphericalHarmonics(r * std::cos(phi), r * std::sin(phi), z, 4, sh);
      for (int a = 0; a < 16; ++a) {
        for (int b = 0; b < 16; ++b) gram[a][b] += sh[a] * sh[b] * (2.0 / n) * (2.0 * M_PI / n);
      }
    }
  }
  for (int a = 0; a < 16; ++a) {
    for (int b = 0; b < 16; ++b) EXPECT_NEAR(gram[a][b], a == b ? 1.0 : 0.0, 4e-3) << a << " " << b;
  }
}

TEST(HashGrid, LevelsGrowFromBaseToFinestAndAreDenseWhereTheyFit) {
  HashGridConfig config;
  config.levels = 8;
  config.base_resolution = 16;
  config.finest_resolution = 2048;
  config.log2_table_size = 17;
  const HashGrid grid(config);
  EXPECT_FLOAT_EQ(grid.level(0).cells_per_unit, 16.0F);
  EXPECT_NEAR(grid.level(7).cells_per_unit, 2048.0F, 0.01F);
  EXPECT_TRUE(grid.level(0).dense);
  EXPECT_FALSE(grid.level(7).dense);
  EXPECT_EQ(grid.level(7).entries, 1U << 17U);
  EXPECT_EQ(grid.level(0).entries, 17U * 17U * 17U);
  for (int l = 0; l < 8; ++l) {
    const int64_t padding = grid.Offset(l + 1) - grid.Offset(l) - static_cast<int64_t>(grid.level(l).entries) * 4;
    EXPECT_TRUE(padding >= 0 && padding < kernel::kLineFloats) << l;
    EXPECT_EQ(grid.Offset(l + 1) % kernel::kLineFloats, 0) << l;
  }
}

TEST(HashGrid, SmallestAndLargestTablesAreLegal) {
  HashGridConfig config;
  config.log2_table_size = 1;
  EXPECT_EQ(HashGrid(config).level(7).entries, 2U);
  config.log2_table_size = 24;
  config.levels = 1;
  EXPECT_GT(HashGrid(config).ParameterCount(), 0);
  config.levels = 17;
  EXPECT_THROW(HashGrid{config}, std::invalid_argument);
}

TEST(SpaceMap, BoxRoundTripsAndFitsTheUnitBox) {
  const SpaceMap map = SpaceMap::Box({-50.0, 20.0, -3.0}, {70.0, 90.0, 12.0});
  EXPECT_DOUBLE_EQ(map.extent().maxCoeff(), 1.0);
  base::Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d x{random.Uniform(-50, 70), random.Uniform(20, 90), random.Uniform(-3, 12)};
    const Eigen::Vector3f unit = map.UnitFromEnu(x);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GE(unit[axis], 0.0F);
      EXPECT_LE(unit[axis], static_cast<float>(map.extent()[axis]) + 1e-6F);
    }
    EXPECT_LT((map.EnuFromUnit(unit.cast<double>()) - x).norm(), 2e-5);  // one float rounding of 120 m
  }
}

TEST(SpaceMap, SlabKeepsTheSurveyAndContractsTheRest) {
  const SpaceMap map = SpaceMap::Contracted({-100.0, -80.0, -5.0}, {100.0, 80.0, 40.0});
  EXPECT_DOUBLE_EQ(map.LocalScale({0, 0, 0}), 1.0);
  EXPECT_NEAR(map.LocalScale({400, 0, 0}), 1.0 / 16.0, 1e-12);
  base::Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d x{random.Uniform(-900, 900), random.Uniform(-900, 900), random.Uniform(-5, 40)};
    const Eigen::Vector3f unit = map.UnitFromEnu(x);
    EXPECT_GT(unit.minCoeff(), -1e-6F);
    EXPECT_LT(unit.maxCoeff(), 1.0F + 1e-6F);
    EXPECT_LT((map.EnuFromUnit(unit.cast<double>()) - x).norm(), 1e-6 * 1e3 / map.LocalScale(x) + 1e-3);
  }
  EXPECT_LT(map.UnitFromEnu({1e9, 0, 0}).x(), 1.0F + 1e-6F);
}

TEST(SpaceMap, RefusesBoxesWithoutVolume) {
  EXPECT_THROW(SpaceMap::Box({0, 0, 0}, {1, 0, 1}), std::invalid_argument);
  EXPECT_THROW(SpaceMap::Contracted({0, 0, 0}, {1, 1, std::nan("")}), std::invalid_argument);
}

}  // namespace
}  // namespace skyquilt::encoding
