#include "coordinator/stages/surface_edge.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/gis/map_projection.h"
#include "core/scene/background.h"

namespace skyquilt::coordinator {
namespace {

// Photos that see the ground within so many metres of the middle, from the outer ring inwards.
struct Ring {
  double radius_m;
  uint8_t photos;
};

class SurfaceEdgeTest : public ::testing::TestWithParam<bool> {
 protected:
  SurfaceEdgeTest() {
    info_.georeferenced = GetParam();
    info_.origin = {47.5, 8.6, 400.0};
    grid_.georeferenced = info_.georeferenced;
    grid_.zone = geo::UtmZoneOf(info_.origin);
    const Eigen::Vector2d middle = Map(0.0, 0.0);
    grid_.left = middle.x() - 90.0;
    grid_.top = middle.y() + 90.0;
    grid_.resolution_m = 0.5;
    grid_.width = grid_.height = 360;
  }
  static scene::Background Seen(const std::vector<Ring>& rings) {
    const geo::PlaneGrid cells({-100.0, -100.0}, 4.0, 50, 50);
    scene::Background background;
    background.surface = scene::HeightMap(cells, std::vector<double>(cells.size(), 20.0));
    background.rgb_srgb.resize(3 * cells.size());
    for (size_t cell = 0; cell < cells.size(); ++cell) {
      background.photos.push_back(0);
      for (const Ring& ring : rings) {
        if (cells.CentreOf(cell).norm() < ring.radius_m) background.photos.back() = ring.photos;
      }
    }
    return background;
  }
  Eigen::Vector2d Map(double x, double y) const { return gis::MapProjection(info_.origin, grid_).EastingNorthing({x, y, 20.0}); }
  bool Covers(const gis::Boundary& edge, double x, double y) const { return edge.Contains(Map(x, y)); }

  scene::SceneInfo info_;
  gis::MapGrid grid_;
};

TEST_P(SurfaceEdgeTest, IsWhereThreePhotosSeeTheGround) {
  const auto edge = SurfaceEdge(Seen({{95.0, 1}, {80.0, 2}, {75.0, 3}, {30.0, 9}}), info_, grid_, 3);
  ASSERT_TRUE(edge);
  for (const auto& [x, y] : {std::pair(0.0, 0.0), {72.0, 0.0}, {0.0, -72.0}, {50.0, 50.0}}) EXPECT_TRUE(Covers(*edge, x, y)) << x << " " << y;
  for (const auto& [x, y] : {std::pair(79.0, 0.0), {0.0, 79.0}, {-56.0, 56.0}}) EXPECT_FALSE(Covers(*edge, x, y)) << x << " " << y;
}

TEST_P(SurfaceEdgeTest, IsWhereTwoDoWhenPhotosOverlapLittle) {
  const scene::Background seen = Seen({{80.0, 2}, {60.0, 3}, {50.0, 4}});
  const auto edge = SurfaceEdge(seen, info_, grid_, 3);
  ASSERT_TRUE(edge);
  EXPECT_TRUE(Covers(*edge, 77.0, 0.0));
  EXPECT_FALSE(Covers(*edge, 84.0, 0.0));
  EXPECT_EQ(SurfaceEdge(seen, info_, grid_, 100)->rings(), edge->rings());
}

TEST_P(SurfaceEdgeTest, CutsNothingOffTheGrid) {
  const auto edge = SurfaceEdge(Seen({{200.0, 5}}), info_, grid_, 3);
  ASSERT_TRUE(edge);
  for (const double x : {-89.9, 89.9}) EXPECT_TRUE(Covers(*edge, x, 0.0) && Covers(*edge, 0.0, x)) << x;
}

TEST_P(SurfaceEdgeTest, IsUnknownWithoutNumbersOfPhotosAndWithoutPairs) {
  EXPECT_FALSE(SurfaceEdge(Seen({{80.0, 1}}), info_, grid_, 3));
  scene::Background level = Seen({{80.0, 3}});
  level.photos.clear();
  EXPECT_FALSE(SurfaceEdge(level, info_, grid_, 3));
}

INSTANTIATE_TEST_SUITE_P(Places, SurfaceEdgeTest, ::testing::Bool(),
                         [](const ::testing::TestParamInfo<bool>& test) { return test.param ? "OnEarth" : "Local"; });

}  // namespace
}  // namespace skyquilt::coordinator
