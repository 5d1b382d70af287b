#include "surface/texture/bake_tile.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "core/base/errors.h"
#include "core/image/image.h"
#include "surface/texture/paint_atlas.h"
#include "surface/texture/raster.h"
#include "tests/support/error_of.h"
#include "texture_meshes.h"

namespace skyquilt::surface {
namespace {

using testing::Box;
using testing::BoxSurface;
using testing::FieldOf;
using testing::FilledView;
using testing::HeightField;
using testing::PlaneAtZero;
using testing::PoseAt;
using testing::ViewOf;

image::Image8 Decode(const TexturedTile& tile) {
  const auto file = std::filesystem::temp_directory_path() / ("skyquilt_bake_" + std::to_string(::getpid()) + ".jpg");
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(tile.atlas_jpeg.data()), static_cast<std::streamsize>(tile.atlas_jpeg.size()));
  image::Image8 picture = image::LoadRgb8(file);
  std::filesystem::remove(file);
  return picture;
}

// Calls f(position, rgb) for every texel whose centre is inside a triangle of the tile, found from its texture coordinates alone.
template <typename F>
int ForEachShownTexel(const TexturedTile& tile, const F& f) {
  const image::Image8 picture = Decode(tile);
  EXPECT_EQ(picture.width, tile.atlas_width);
  EXPECT_EQ(picture.height, tile.atlas_height);
  int n = 0;
  for (const Triangle& t : tile.triangle) {
    TexelTriangle corners;
    for (size_t i = 0; i < 3; ++i) corners[i] = tile.uv[t[i]].cast<double>().cwiseProduct(Eigen::Vector2d(tile.atlas_width, tile.atlas_height));
    ForEachCentreInside(corners, [&](int x, int y, double b1, double b2) {
      const Eigen::Vector3d& first = tile.position[t[0]];
      const uint8_t* rgb = picture.At(x, y);
      f(Eigen::Vector3d(first + b1 * (tile.position[t[1]] - first) + b2 * (tile.position[t[2]] - first)),
        Eigen::Vector3f(rgb[0], rgb[1], rgb[2]) / 255.0F);
      ++n;
    });
  }
  return n;
}

// Differs in all three directions of space, over about ten texels of 0.1 m.
Eigen::Vector3f Waves(const Eigen::Vector3d& x, const Eigen::Vector3d&) {
  const auto wave = [](double phase) { return static_cast<float>(0.5 + 0.35 * std::sin(phase)); };
  const float value = (wave(4.0 * x.x()) + wave(3.0 * x.y() + 1.0) + wave(5.0 * x.z() + 2.0)) / 3.0F;
  return {value, 0.9F * value, 0.1F + 0.7F * value};  // nearly grey: JPEGs store tints at half the resolution
}

// Where a ray came from: red from above, green from the side of positive x, blue from that of positive y.
Eigen::Vector3f DirectionColor(const Eigen::Vector3d&, const Eigen::Vector3d& direction) {
  return (0.5 - 0.4 * Eigen::Vector3d(direction.z(), direction.x(), direction.y()).array()).matrix().cast<float>();
}

MeshTile TileOf(Mesh mesh) {
  MeshTile tile;
  tile.id = {1, -2, 3};
  tile.error_m = 0.0;
  tile.mesh = std::move(mesh);
  return tile;
}

BakedTile Bake(const MeshTile& mesh, const std::vector<FilledView>& filled, const RayCaster& caster, BakeOptions options, int n_threads = 2) {
  std::vector<DepthView> views;
  for (const FilledView& view : filled) views.push_back(view.Get());
  base::ThreadPool threads(n_threads);
  if (!(options.texel_m > 0.0)) options.texel_m = 0.1;
  options.jpeg_quality = 97;
  return BakeTile(mesh, views, {caster, 0.1, nullptr, nullptr}, options, threads);
}

Mesh Plane() {
  return HeightField(8, 1.0, [](double, double) { return 0.0; });
}

TEST(BakeTile, ColoursOfABoxAreThoseOfTheFieldOnAllSides) {
  const Eigen::Vector3d low(1, 2, 3);
  const Eigen::Vector3d high(5, 5.5, 6);
  const testing::Surface surface = BoxSurface(low, high);
  const std::vector<FilledView> views = {ViewOf(PoseAt({3, 4, 20}, {0, 0, -1}, 128, 200.0, 0), surface),
                                         ViewOf(PoseAt({15, 14, 10}, {-12, -10, -6}, 128, 150.0, 1), surface)};
  const BakedTile baked = Bake(TileOf(Box(low, high)), views, FieldOf(surface, Waves), {});
  double sum = 0.0;
  double most = 0.0;
  const int n = ForEachShownTexel(baked.tile, [&](const Eigen::Vector3d& x, const Eigen::Vector3f& rgb) {
    const double error = static_cast<double>((rgb - Waves(x, {})).cwiseAbs().maxCoeff());
    sum += error;
    most = std::max(most, error);
  });
  EXPECT_NEAR(n * 0.01, 2 * (4 * 3.5 + 4 * 3 + 3.5 * 3), 1.5);  // the box's surface
  EXPECT_LT(sum / n, 0.008);
  EXPECT_LT(most, 0.06);
  EXPECT_EQ(baked.tile.id.Name(), "1_-2_3");
  EXPECT_TRUE(baked.points.empty());
}

TEST(BakeTile, LooksFromThePhotoThatSawThePlace) {
  // The photo from the side is nearer, but a wall stands before it.
  const testing::Surface wall = BoxSurface({6, -50, -1}, {6.5, 50, 50});
  const std::vector<FilledView> views = {ViewOf(PoseAt({9, 4, 9}, {-5, 0, -9}, 128, 60.0, 0), wall),
                                         ViewOf(PoseAt({4, 20, 20}, {0, -16, -20}, 128, 60.0, 1), PlaneAtZero)};
  const Mesh small = HeightField(4, 0.5, [](double, double) { return 0.0; });
  const BakedTile baked = Bake(TileOf(small), views, FieldOf(PlaneAtZero, DirectionColor), {});
  const int n = ForEachShownTexel(baked.tile, [&](const Eigen::Vector3d& x, const Eigen::Vector3f& rgb) {
    const Eigen::Vector3f expected = DirectionColor({}, (x - Eigen::Vector3d(4, 20, 20)).normalized());
    EXPECT_LT((rgb - expected).cwiseAbs().maxCoeff(), 0.02F) << x.transpose();
  });
  EXPECT_EQ(n, 400);
}

TEST(BakeTile, LooksAgainstTheNormalWhereNoViewSaw) {
  const BakedTile baked = Bake(TileOf(Plane()), {}, FieldOf(PlaneAtZero, DirectionColor), {});
  const Eigen::Vector3f expected = DirectionColor({}, -Eigen::Vector3d::UnitZ());
  ForEachShownTexel(baked.tile,
                    [&](const Eigen::Vector3d&, const Eigen::Vector3f& rgb) { EXPECT_LT((rgb - expected).cwiseAbs().maxCoeff(), 0.02F); });
}

TEST(BakeTile, TheFieldMayBeAsFarFromTheMeshAsTheTilesError) {
  MeshTile tile = TileOf(HeightField(8, 1.0, [](double, double) { return -0.9; }));  // 9 voxels below the field's surface
  const RayCaster caster = FieldOf(PlaneAtZero, [](const Eigen::Vector3d&, const Eigen::Vector3d&) { return Eigen::Vector3f(0.9F, 0.1F, 0.1F); });
  const auto red = [&] {
    float least = 1.0F;
    ForEachShownTexel(Bake(tile, {}, caster, {}).tile, [&](const Eigen::Vector3d&, const Eigen::Vector3f& rgb) { least = std::min(least, rgb.x()); });
    return least;
  };
  EXPECT_NEAR(static_cast<double>(red()), 128.0 / 255.0, 0.02);  // nothing found: grey
  tile.error_m = 0.8;
  EXPECT_NEAR(static_cast<double>(red()), 0.9, 0.02);
}

TEST(BakeTile, PlacesWithoutColourTakeThatOfTheirSurroundings) {
  const RayCaster opaque = FieldOf(PlaneAtZero, [](const Eigen::Vector3d&, const Eigen::Vector3d&) { return Eigen::Vector3f(0.2F, 0.6F, 0.8F); });
  const RayCaster holes = [opaque](std::span<const render::Ray> rays, std::span<render::RayColor> out) {
    opaque(rays, out);
    for (size_t i = 0; i < rays.size(); ++i) {
      const Eigen::Vector3d x = rays[i].origin_enu;
      if (std::hypot(x.x() - 4.0, x.y() - 4.0) < 2.0) out[i] = {};                    // nothing there
      if (x.x() < 1.0) out[i].rgb_srgb[0] = out[i].rgb_srgb[1] = std::nanf("");       // a damaged field
      if (x.y() > 7.0) out[i] = {.rgb_srgb = {0.04F, 0.0F, 0.0F}, .opacity = 0.04F};  // as good as nothing
    }
  };
  const int n = ForEachShownTexel(Bake(TileOf(Plane()), {}, holes, {}).tile, [](const Eigen::Vector3d& x, const Eigen::Vector3f& rgb) {
    EXPECT_LT((rgb - Eigen::Vector3f(0.2F, 0.6F, 0.8F)).cwiseAbs().maxCoeff(), 0.02F) << x.transpose();
  });
  EXPECT_EQ(n, 6400);
}

TEST(PaintAtlas, FillsGuttersFromTheirOwnChartAndTheRestWithTheMean) {
  const Mesh mesh = Box({0, 0, 0}, {1.5, 0.8, 0.4});
  const TileGeometry geometry = GeometryOf(mesh);
  const AtlasLayout layout = LayOutAtlas(geometry, 0.1, 512);
  base::ThreadPool threads(2);
  const AtlasTexels texels = FindTexels(geometry, layout, threads);
  TexelColors colors;
  colors.rgb_srgb.resize(texels.texel.size());
  colors.known.assign(texels.texel.size(), 1);
  ASSERT_EQ(layout.charts.size(), 6U);
  for (size_t c = 0; c < 6; ++c) {
    for (size_t i = texels.first[c]; i < texels.first[c + 1]; ++i) {
      colors.rgb_srgb[i] = {static_cast<float>(c) * 0.1F, 0.5F, 0.0F};
      if (c == 5) colors.known[i] = 0;
    }
  }
  const image::Image8 atlas = PaintAtlas(layout, texels, colors, threads);
  std::vector<bool> in_chart(static_cast<size_t>(layout.width) * static_cast<size_t>(layout.height), false);
  for (size_t c = 0; c < 6; ++c) {
    for (int y = layout.corner[c].y() - kGutterTexels; y < layout.corner[c].y() + layout.charts[c].size.y() + kGutterTexels; ++y) {
      for (int x = layout.corner[c].x() - kGutterTexels; x < layout.corner[c].x() + layout.charts[c].size.x() + kGutterTexels; ++x) {
        in_chart[static_cast<size_t>(y) * static_cast<size_t>(layout.width) + static_cast<size_t>(x)] = true;
        ASSERT_EQ(atlas.At(x, y)[0], c == 5 ? 128 : std::lround(static_cast<double>(c) * 25.5)) << c;
        ASSERT_EQ(atlas.At(x, y)[1], 128) << c;
      }
    }
  }
  const auto outside = static_cast<size_t>(std::find(in_chart.begin(), in_chart.end(), false) - in_chart.begin());
  ASSERT_LT(outside, in_chart.size());
  EXPECT_GT(atlas.data[outside * 3], 0);
  EXPECT_LT(atlas.data[outside * 3], 102);
  EXPECT_EQ(atlas.data[outside * 3 + 1], 128);
}

TEST(BakeTile, PointsHaveTheSpacingAndLieOnTheMesh) {
  for (const double slope : {0.0, 0.6}) {
    Mesh mesh = HeightField(8, 1.0, [slope](double x, double) { return slope * x; });
    for (size_t v = 0; v < mesh.position.size(); ++v) {
      mesh.views[v] = mesh.position[v].x() < 4.5 ? 3 : 9;
      mesh.filled[v] = mesh.position[v].y() > 6.5 ? 1 : 0;
    }
    const RayCaster caster = [](std::span<const render::Ray> rays, std::span<render::RayColor> out) {
      for (size_t i = 0; i < rays.size(); ++i) out[i] = {.rgb_srgb = {1.0F, 0.2F, 0.4F}, .opacity = 1.0F};
    };
    for (const double spacing : {0.15, 0.2, 0.37, 1.0}) {
      BakeOptions options;
      options.point_spacing_m = spacing;
      const BakedTile baked = Bake(TileOf(mesh), {}, caster, options);
      const double expected = 64.0 * std::hypot(1.0, slope) / (spacing * spacing);
      EXPECT_NEAR(static_cast<double>(baked.points.size()), expected, 0.2 * expected) << spacing << " " << slope;
      for (const CloudPoint& point : baked.points) {
        ASSERT_NEAR(point.position.z(), slope * point.position.x(), 1e-6);
        ASSERT_LT((point.normal - Eigen::Vector3d(-slope, 0, 1).normalized().cast<float>()).norm(), 1e-5F);
        ASSERT_EQ(point.rgb, (std::array<uint8_t, 3>{255, 51, 102}));
        if (std::abs(point.position.x() - 4.5) > 0.5) {
          ASSERT_EQ(point.views, point.position.x() < 4.5 ? 3 : 9) << point.position.transpose();
        }
        ASSERT_EQ(point.filled, point.position.y() > 6.0 ? 1 : 0) << point.position.transpose();
      }
    }
  }
}

TEST(BakeTile, SmallPiecesHaveAPointToo) {
  const Mesh mesh = Box({0, 0, 0}, {0.9, 0.9, 0.9});
  BakeOptions options;
  options.point_spacing_m = 1.2;  // half of its square is 0.72, a side of the box 0.81
  EXPECT_EQ(Bake(TileOf(mesh), {}, FieldOf(PlaneAtZero, Waves), options).points.size(), 6U);
  options.point_spacing_m = 4.0;
  EXPECT_LE(Bake(TileOf(mesh), {}, FieldOf(PlaneAtZero, Waves), options).points.size(), 3U);
}

TEST(BakeTile, IsTheSameForAnyNumberOfThreads) {
  const testing::Surface surface = BoxSurface({1, 1.5, -0.5}, {3, 4, 2});
  const std::vector<FilledView> views = {ViewOf(PoseAt({3, 4, 20}, {0, 0, -1}, 128, 200.0, 0), surface),
                                         ViewOf(PoseAt({15, 14, 10}, {-12, -10, -6}, 128, 150.0, -1), surface)};
  const MeshTile mesh = TileOf(testing::RandomTown(3, 0.5));
  BakeOptions options;
  options.texel_m = 0.05;
  options.point_spacing_m = 0.1;
  const BakedTile one = Bake(mesh, views, FieldOf(surface, Waves), options, 1);
  const BakedTile four = Bake(mesh, views, FieldOf(surface, Waves), options, 4);
  EXPECT_EQ(one.tile.atlas_jpeg, four.tile.atlas_jpeg);
  EXPECT_EQ(one.tile.uv, four.tile.uv);
  EXPECT_EQ(one.tile.triangle, four.tile.triangle);
  ASSERT_EQ(one.points.size(), four.points.size());
  for (size_t i = 0; i < one.points.size(); ++i) {
    ASSERT_EQ(one.points[i].position, four.points[i].position);
    ASSERT_EQ(one.points[i].rgb, four.points[i].rgb);
  }
}

TEST(BakeTile, NothingComesFromNothing) {
  const RayCaster caster = FieldOf(PlaneAtZero, Waves);
  const BakedTile empty = Bake(TileOf({}), {}, caster, {});
  EXPECT_TRUE(empty.tile.atlas_jpeg.empty());
  EXPECT_EQ(empty.tile.atlas_width, 0);
  EXPECT_EQ(empty.tile.id.Name(), "1_-2_3");
  Mesh degenerate;
  for (int i = 0; i < 3; ++i) testing::AddVertex(&degenerate, {1.0 * i, 0, 0});
  degenerate.triangle = {{0, 1, 2}};
  EXPECT_TRUE(Bake(TileOf(degenerate), {}, caster, {}).tile.triangle.empty());
}

TEST(BakeTile, OneTriangleSmallerThanATexelHasATexture) {
  Mesh mesh;
  for (const Eigen::Vector3d& x : {Eigen::Vector3d(7, 3, 0), Eigen::Vector3d(7.01, 3, 0), Eigen::Vector3d(7, 3.01, 0)}) testing::AddVertex(&mesh, x);
  mesh.triangle = {{0, 1, 2}};
  const BakedTile baked = Bake(TileOf(mesh), {}, FieldOf(PlaneAtZero, Waves), {});
  ASSERT_EQ(baked.tile.triangle.size(), 1U);
  const image::Image8 picture = Decode(baked.tile);
  const Eigen::Vector2f pixel = baked.tile.uv[0].cwiseProduct(Eigen::Vector2f(static_cast<float>(picture.width), static_cast<float>(picture.height)));
  const uint8_t* rgb = picture.At(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
  EXPECT_NEAR(rgb[0], static_cast<double>(Waves({7, 3, 0}, {}).x()) * 255.0, 8.0);
}

TEST(BakeTile, StopsWhenCancelled) {
  ExpectStopsWhenAsked([&] { Bake(TileOf(Plane()), {}, FieldOf(PlaneAtZero, Waves), {}); });
}

}  // namespace
}  // namespace skyquilt::surface
