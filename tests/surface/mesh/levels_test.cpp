#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/base/progress.h"
#include "made_meshes.h"
#include "surface/mesh/mesh_tools.h"
#include "surface/mesh/simplify.h"
#include "tests/support/error_of.h"

namespace skyquilt::surface {
namespace {

double Hills(int x, int y) {
  return 2.0 * std::sin(0.1 * x) * std::cos(0.07 * y) + Noise(x, y, 0.1);
}

std::map<int, std::vector<Mesh>> ByLevel(const std::vector<MeshTile>& tiles) {
  std::map<int, std::vector<Mesh>> levels;
  for (const MeshTile& tile : tiles) levels[tile.id.level].push_back(tile.mesh);
  return levels;
}

TEST(SplitIntoTiles, EachTriangleIsInTheTileOfItsMiddle) {
  const Mesh mesh = GridMesh(-25, -12, 18, 9, Hills);
  const std::vector<MeshTile> tiles = SplitIntoTiles(mesh, 10.0);
  EXPECT_EQ(tiles.size(), 5U * 3U);
  EXPECT_EQ(tiles.front().id, (TileId{0, -3, -2}));
  size_t triangles = 0;
  for (size_t i = 0; i < tiles.size(); ++i) {
    if (i > 0) {
      EXPECT_LT(tiles[i - 1].id, tiles[i].id);
    }
    const Mesh& own = tiles[i].mesh;
    triangles += own.triangle.size();
    EXPECT_EQ(own.key.size(), own.position.size());
    for (const Triangle& t : own.triangle) {
      const Eigen::Vector3d middle = (own.position[t[0]] + own.position[t[1]] + own.position[t[2]]) / 3.0;
      EXPECT_EQ(std::floor(middle.x() / 10.0), tiles[i].id.column);
      EXPECT_EQ(std::floor(middle.y() / 10.0), tiles[i].id.row);
    }
  }
  EXPECT_EQ(triangles, mesh.triangle.size());
  EXPECT_TRUE(SplitIntoTiles(Mesh(), 10.0).empty());
  EXPECT_THROW(SplitIntoTiles(mesh, 0.0), std::logic_error);
}

TEST(SplitIntoTiles, LeavesOutWhatIsNowhere) {
  Mesh mesh = GridMesh(0, 0, 4, 4, Flat);
  mesh.position[12].x() = std::nan("");
  size_t triangles = 0;
  for (const MeshTile& tile : SplitIntoTiles(mesh, 2.0)) triangles += tile.mesh.triangle.size();
  EXPECT_EQ(triangles, 26U);  // six were at that vertex
}

TEST(BuildLevels, TilesOfEachLevelMeetWithoutCracks) {
  base::Progress::SetQuiet(true);
  base::ThreadPool threads(2);
  const Mesh mesh = GridMesh(0, 0, 300, 300, Hills);
  std::vector<MeshTile> finest = SplitIntoTiles(mesh, 100.0);
  ASSERT_EQ(finest.size(), 9U);
  for (MeshTile& tile : finest) tile.error_m = 0.1;
  const std::vector<MeshTile> all = BuildLevels(finest, 0.2, threads);
  std::map<int, std::vector<Mesh>> levels = ByLevel(all);
  ASSERT_EQ(levels.size(), 3U);
  EXPECT_EQ(levels[0].size(), 9U);
  EXPECT_EQ(levels[1].size(), 4U);
  EXPECT_EQ(levels[2].size(), 1U);
  EXPECT_EQ(all.back().id, (TileId{2, 0, 0}));
  size_t triangles = mesh.triangle.size() + 1;
  for (auto& [level, meshes] : levels) {
    const Mesh joined = MergeMeshes(meshes);
    EXPECT_EQ(CountEdges(joined).boundary, 1200) << "level " << level;
    EXPECT_EQ(CountEdges(joined).non_manifold, 0) << "level " << level;
    EXPECT_LT(joined.triangle.size(), triangles);
    triangles = joined.triangle.size();
  }
  EXPECT_LT(triangles, mesh.triangle.size() / 10);
  for (const MeshTile& tile : all) {
    // 0.1 of the finest, at most 0.4 of level 1 and 0.8 of level 2.
    EXPECT_LE(tile.error_m, tile.id.level == 0 ? 0.1 : tile.id.level == 1 ? 0.5 : 1.3);
    if (tile.id.level > 0) {
      EXPECT_GT(tile.error_m, 0.1);
    }
  }
}

TEST(BuildLevels, DoesNotDependOnThreadsOrOrder) {
  base::Progress::SetQuiet(true);
  base::ThreadPool one(1), three(3);
  std::vector<MeshTile> finest = SplitIntoTiles(GridMesh(-40, -40, 40, 40, Hills), 16.0);
  const std::vector<MeshTile> a = BuildLevels(finest, 0.2, one);
  std::reverse(finest.begin(), finest.end());
  const std::vector<MeshTile> b = BuildLevels(finest, 0.2, three);
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].id, b[i].id);
    EXPECT_EQ(a[i].error_m, b[i].error_m);
    EXPECT_EQ(a[i].mesh.position, b[i].mesh.position);
    EXPECT_EQ(a[i].mesh.triangle, b[i].mesh.triangle);
  }
}

TEST(BuildLevels, AroundTheOriginItEndsWithFourTiles) {
  base::Progress::SetQuiet(true);
  base::ThreadPool threads(1);
  const std::vector<MeshTile> all = BuildLevels(SplitIntoTiles(GridMesh(-40, -40, 40, 40, Flat), 10.0), 0.1, threads);
  std::map<int, std::vector<Mesh>> levels = ByLevel(all);
  ASSERT_EQ(levels.size(), 3U);  // 64, 16 and 4 tiles
  EXPECT_EQ(levels[2].size(), 4U);
  EXPECT_EQ(CountEdges(MergeMeshes(levels[2])).boundary, 320);
  std::set<std::pair<int, int>> top;
  for (const MeshTile& tile : all) {
    if (tile.id.level == 2) top.insert({tile.id.column, tile.id.row});
  }
  EXPECT_EQ(top, (std::set<std::pair<int, int>>{{-1, -1}, {-1, 0}, {0, -1}, {0, 0}}));
}

TEST(BuildLevels, DistantTilesMeetAtLast) {
  base::Progress::SetQuiet(true);
  base::ThreadPool threads(1);
  // Columns 0 and 7 with nothing between: two levels have two tiles each before they are joined.
  const Mesh mesh = GridMesh(0, 0, 80, 8, Flat, [](int x, int) { return x < 8 || x >= 72; });
  const std::vector<MeshTile> all = BuildLevels(SplitIntoTiles(mesh, 10.0), 0.1, threads);
  ASSERT_EQ(all.size(), 2U + 2U + 2U + 1U);
  EXPECT_EQ(all.back().id, (TileId{3, 0, 0}));
  EXPECT_DOUBLE_EQ(Area(all.back().mesh), 128.0);
}

TEST(BuildLevels, NothingAndASingleTileStayAsTheyAre) {
  base::Progress::SetQuiet(true);
  base::ThreadPool threads(1);
  EXPECT_TRUE(BuildLevels({}, 0.1, threads).empty());
  EXPECT_TRUE(BuildLevels({MeshTile{{0, 3, 4}, {}, 0.0}}, 0.1, threads).empty());
  const std::vector<MeshTile> one = BuildLevels(SplitIntoTiles(GridMesh(52, 52, 58, 58, Flat), 10.0), 0.1, threads);
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(one[0].id, (TileId{0, 5, 5}));
}

TEST(BuildLevels, CanBeInterrupted) {
  base::Progress::SetQuiet(true);
  base::ThreadPool threads(2);
  const std::vector<MeshTile> finest = SplitIntoTiles(GridMesh(0, 0, 40, 40, Flat), 10.0);
  ExpectStopsWhenAsked([&] { BuildLevels(finest, 0.1, threads); });
}

}  // namespace
}  // namespace skyquilt::surface
