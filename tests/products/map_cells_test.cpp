#include "products/map_cells.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "products/map_rays.h"
#include "tests/products/analytic_scene.h"

namespace skyquilt::products {
namespace {

struct Whole {
  std::vector<uint8_t> rgba;
  std::vector<float> height_m;
  RenderedCells counts;
};

class MapCells : public testing::Test {
 protected:
  MapCells() : info_(scene_.Info({46.0, 7.5, 500.0}, true)) {
    ProductOptions options;
    options.resolution_m = 1.0;
    grid_ = PlanMapGrid(info_, options);
  }

  Whole Render(const RayCaster& caster, bool every_second, size_t rays_per_call = RaysPerCall(1)) const {
    Whole whole;
    whole.rgba.resize(4 * grid_.size());
    whole.height_m.resize(grid_.size());
    whole.counts = RenderMapCells(info_, grid_, {caster, rays_per_call, 0.5, every_second}, std::nullopt, "cells",
                                  [&](int first_row, int /*n_rows*/, PaintedCells& band) {
                                    const auto begin = static_cast<std::ptrdiff_t>(grid_.Index(0, first_row));
                                    std::copy(band.rgba.begin(), band.rgba.end(), whole.rgba.begin() + 4 * begin);
                                    std::copy(band.place.begin(), band.place.end(), whole.height_m.begin() + begin);
                                  });
    return whole;
  }

  AnalyticScene scene_;
  scene::SceneInfo info_;
  gis::MapGrid grid_;
};

TEST_F(MapCells, BetweenRaysAreAsIfRenderedWhereTheSurfaceIsPlainAndAtEdges) {
  scene_.open_west = -40.0;
  const Whole all = Render(scene_.Caster(), false);
  const Whole few = Render(scene_.Caster(), true);
  EXPECT_EQ(all.counts.rays, all.counts.inside);
  EXPECT_EQ(few.counts.inside, all.counts.inside);
  EXPECT_EQ(few.counts.filled, all.counts.filled);
  EXPECT_LT(all.counts.filled, all.counts.inside);
  // A quarter, the edges of the house, and the ground that is not there.
  EXPECT_LT(few.counts.rays, 48 * all.counts.rays / 100);
  int different_colours = 0;
  for (size_t cell = 0; cell < grid_.size(); ++cell) {
    ASSERT_NEAR(all.height_m[cell], few.height_m[cell], 1e-3) << cell;
    ASSERT_EQ(all.rgba[4 * cell + 3], few.rgba[4 * cell + 3]) << cell;
    for (size_t c = 0; c < 3; ++c) different_colours += all.rgba[4 * cell + c] != few.rgba[4 * cell + c] ? 1 : 0;
  }
  // Red and green ground meet along one line.
  EXPECT_LT(different_colours, 8 * grid_.height);
}

TEST_F(MapCells, DoNotDependOnTheRaysOfACall) {
  const Whole one = Render(scene_.Caster(), true);
  const Whole other = Render(scene_.Caster(), true, 997);
  EXPECT_EQ(one.rgba, other.rgba);
  EXPECT_EQ(one.height_m, other.height_m);
  EXPECT_EQ(one.counts.rays, other.counts.rays);
}

RC_GTEST_FIXTURE_PROP(MapCells, LieBetweenTheirNeighboursOnAnySlope, ()) {
  const double slope_x = 0.01 * *rc::gen::inRange(-150, 150);
  const double slope_y = 0.01 * *rc::gen::inRange(-150, 150);
  info_.min_enu.z() = -300.0;
  info_.max_enu.z() = 300.0;
  for (scene::SceneBlock& block : info_.blocks) {
    block.min_enu.z() = -300.0;
    block.max_enu.z() = 300.0;
  }
  const RayCaster plane = [&](std::span<const render::Ray> rays, std::span<render::RayColor> out) {
    for (size_t i = 0; i < rays.size(); ++i) {
      const Eigen::Vector3d &o = rays[i].origin_enu, &d = rays[i].direction_enu;
      const double t = (slope_x * o.x() + slope_y * o.y() - o.z()) / (d.z() - slope_x * d.x() - slope_y * d.y());
      out[i].opacity = 1.0F;
      out[i].depth = out[i].depth_median = static_cast<float>(t);
    }
  };
  const Whole all = Render(plane, false);
  const Whole few = Render(plane, true);
  // Between two rays of a row or column the ground rises by two cells times the slope.
  if (std::max(std::abs(slope_x), std::abs(slope_y)) > 1.1) RC_ASSERT(2 * few.counts.rays > all.counts.rays);
  if (std::abs(slope_x) + std::abs(slope_y) < 0.9) RC_ASSERT(few.counts.rays < 3 * all.counts.rays / 10);
  for (size_t cell = 0; cell < grid_.size(); ++cell) RC_ASSERT(std::abs(all.height_m[cell] - few.height_m[cell]) < 2e-3F);
}

}  // namespace
}  // namespace skyquilt::products
