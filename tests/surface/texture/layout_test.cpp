#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>

#include "surface/texture/atlas_layout.h"
#include "surface/texture/pack.h"
#include "surface/texture/texels.h"
#include "texture_meshes.h"

namespace skyquilt::surface {
namespace {

using testing::HeightField;
using testing::RandomTown;

struct Rect {
  Eigen::Vector2i low, high;
};

bool Overlap(const Rect& a, const Rect& b) {
  return a.low.x() < b.high.x() && b.low.x() < a.high.x() && a.low.y() < b.high.y() && b.low.y() < a.high.y();
}

RC_GTEST_PROP(Pack, RectanglesStayInsideAndApart, ()) {
  const auto seed = *rc::gen::arbitrary<uint64_t>();
  const int n = *rc::gen::inRange(1, 60);
  base::Random random(seed);
  std::vector<Eigen::Vector2i> sizes;
  for (int i = 0; i < n; ++i) sizes.push_back(Eigen::Vector2i{1 + static_cast<int>(random.Below(40)), 1 + static_cast<int>(random.Below(70))});
  const auto packing = PackRows(sizes, 1024);
  RC_ASSERT(packing.has_value());
  RC_ASSERT(packing->width % kAtlasMultiple == 0 && packing->height % kAtlasMultiple == 0);
  double area = 0.0;
  for (int i = 0; i < n; ++i) {
    const auto a = static_cast<size_t>(i);
    area += sizes[a].prod();
    const Rect rect{packing->corner[a], packing->corner[a] + sizes[a]};
    RC_ASSERT(rect.low.minCoeff() >= 0 && rect.high.x() <= packing->width && rect.high.y() <= packing->height);
    for (size_t b = 0; b < a; ++b) RC_ASSERT(!Overlap(rect, {packing->corner[b], packing->corner[b] + sizes[b]}));
  }
  if (n >= 40) RC_ASSERT(area > 0.6 * packing->width * packing->height);
}

TEST(Pack, NothingWhenThereIsNoRoom) {
  const std::vector<Eigen::Vector2i> wide = {{65, 1}};
  const std::vector<Eigen::Vector2i> high = {{1, 65}};
  const std::vector<Eigen::Vector2i> many(17, Eigen::Vector2i(16, 16));
  EXPECT_FALSE(PackRows(wide, 64));
  EXPECT_FALSE(PackRows(high, 64));
  EXPECT_FALSE(PackRows(many, 64));
  EXPECT_TRUE(PackRows(std::span(many).first(16), 64));
  EXPECT_FALSE(PackRows(wide, 79));  // widths are multiples of 16
  EXPECT_EQ(PackRows({}, 64)->width, 0);
}

RC_GTEST_PROP(Layout, TrianglesLieInsideTheirChartAndChartsKeepTheirGutters, ()) {
  const auto seed = *rc::gen::arbitrary<uint64_t>();
  const double roughness = *rc::gen::element(0.0, 0.3, 1.0);
  MeshTile mesh;
  mesh.mesh = RandomTown(seed, roughness);
  const TileGeometry geometry = GeometryOf(mesh.mesh);
  const AtlasLayout layout = LayOutAtlas(geometry, 0.1, 2048);
  RC_ASSERT(layout.lattice.texel_m == 0.1);
  std::vector<Rect> rects;
  for (size_t c = 0; c < layout.charts.size(); ++c) {
    const Rect rect{layout.corner[c].array() - kGutterTexels, layout.corner[c].array() + layout.charts[c].size.array() + kGutterTexels};
    RC_ASSERT(rect.low.minCoeff() >= 0 && rect.high.x() <= layout.width && rect.high.y() <= layout.height);
    for (const Rect& other : rects) RC_ASSERT(!Overlap(rect, other));
    rects.push_back(rect);
  }
  const TexturedTile tile = LaidOutTile(mesh, geometry, layout);
  RC_ASSERT(tile.triangle.size() == geometry.triangle.size());
  RC_ASSERT(tile.normal.size() == tile.position.size() && tile.uv.size() == tile.position.size());
  RC_ASSERT(tile.views.size() == tile.position.size() && tile.filled.size() == tile.position.size());
  size_t t = 0;
  for (size_t c = 0; c < layout.charts.size(); ++c) {
    for (size_t k = 0; k < layout.charts[c].triangle.size(); ++k, ++t) {
      for (size_t i = 0; i < 3; ++i) {
        const uint32_t vertex = tile.triangle[t][i];
        RC_ASSERT(tile.position[vertex] == geometry.Corner(layout.charts[c].triangle[k], i));
        const Eigen::Vector2f pixel =
            tile.uv[vertex].cwiseProduct(Eigen::Vector2f(static_cast<float>(layout.width), static_cast<float>(layout.height)));
        const Eigen::Vector2f in_chart = pixel - layout.corner[c].cast<float>();
        RC_ASSERT(in_chart.minCoeff() >= -1e-3F && (layout.charts[c].size.cast<float>() - in_chart).minCoeff() >= -1e-3F);
      }
    }
  }
}

RC_GTEST_PROP(Texels, LeadFromPixelToMeshAndBack, ()) {
  const auto seed = *rc::gen::arbitrary<uint64_t>();
  const double texel_m = *rc::gen::element(0.05, 0.1, 0.9);
  const Mesh mesh = RandomTown(seed, 0.4);
  const TileGeometry geometry = GeometryOf(mesh);
  const AtlasLayout layout = LayOutAtlas(geometry, texel_m, 2048);
  base::ThreadPool threads(2);
  const AtlasTexels texels = FindTexels(geometry, layout, threads);
  double projected = 0.0;
  size_t centres = 0;
  for (size_t c = 0; c < layout.charts.size(); ++c) {
    const Chart& chart = layout.charts[c];
    RC_ASSERT(texels.first[c + 1] > texels.first[c]);  // however small the chart
    for (const uint32_t t : chart.triangle) {
      projected += geometry.area[t] * geometry.face_normal[t].dot(layout.lattice.directions[static_cast<size_t>(chart.direction)].out);
      // Every place on the mesh has a texel around it, and so do its corners.
      for (size_t i = 0; i < 3; ++i) {
        const Eigen::Vector2d p = layout.PixelOf(c, geometry.Corner(t, i));
        const bool found = std::any_of(texels.texel.begin() + static_cast<std::ptrdiff_t>(texels.first[c]),
                                       texels.texel.begin() + static_cast<std::ptrdiff_t>(texels.first[c + 1]), [&](const Texel& texel) {
                                         return std::abs(texel.x + 0.5 - p.x()) <= 0.501 && std::abs(texel.y + 0.5 - p.y()) <= 0.501;
                                       });
        RC_ASSERT(found);
      }
    }
    for (size_t i = texels.first[c]; i < texels.first[c + 1]; ++i) {
      const Texel& texel = texels.texel[i];
      RC_ASSERT(std::find(chart.triangle.begin(), chart.triangle.end(), texel.triangle) != chart.triangle.end());
      const Eigen::Vector2d back = layout.PixelOf(c, texels.PositionOf(geometry, i)) - Eigen::Vector2d(texel.x + 0.5, texel.y + 0.5);
      RC_ASSERT(back.norm() <= (texel.border ? 0.7082 : 1e-3));
      RC_ASSERT(std::abs(texels.NormalOf(geometry, i).norm() - 1.0) < 1e-9);
      centres += texel.border ? 0 : 1;
    }
  }
  if (texel_m < 0.2) RC_ASSERT(std::abs(static_cast<double>(centres) * texel_m * texel_m - projected) < 0.05 * projected);
}

TEST(Layout, TexelsGrowUntilTheAtlasFits) {
  MeshTile mesh;
  mesh.mesh = HeightField(10, 1.0, [](double x, double y) { return 0.3 * std::sin(x) * std::cos(y); });
  const TileGeometry geometry = GeometryOf(mesh.mesh);
  const AtlasLayout fine = LayOutAtlas(geometry, 0.05, 4096);
  EXPECT_EQ(fine.lattice.texel_m, 0.05);
  EXPECT_GE(fine.width, 200);
  const AtlasLayout coarse = LayOutAtlas(geometry, 0.05, 100);  // 96 when rounded to a multiple of 16
  EXPECT_LE(std::max(coarse.width, coarse.height), 96);
  EXPECT_GT(coarse.lattice.texel_m, 0.1);
  EXPECT_LT(coarse.lattice.texel_m, 0.2);
  const AtlasLayout smallest = LayOutAtlas(geometry, 1e-4, 1);
  EXPECT_EQ(smallest.width, 16);
  EXPECT_EQ(smallest.height, 16);
}

TEST(Layout, TooManyChartsMakeTheAtlasLargerInsteadOfFailing) {
  Mesh mesh;
  for (int i = 0; i < 30; ++i) {
    const double x = 10.0 * i;
    testing::Append(&mesh, testing::Box({x, 0, 0}, {x + 1, 1, 1}));
  }
  const TileGeometry geometry = GeometryOf(mesh);
  const AtlasLayout layout = LayOutAtlas(geometry, 0.1, 32);
  EXPECT_EQ(layout.charts.size(), 180U);
  EXPECT_GT(layout.width, 32);
  EXPECT_LT(layout.width, 200);
}

TEST(Layout, NothingIsLaidOutAsNothing) {
  const Mesh mesh;
  const AtlasLayout layout = LayOutAtlas(GeometryOf(mesh), 0.1, 4096);
  EXPECT_EQ(layout.width, 0);
  EXPECT_TRUE(layout.charts.empty());
}

}  // namespace
}  // namespace skyquilt::surface
