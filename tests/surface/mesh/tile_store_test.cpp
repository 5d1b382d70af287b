#include "surface/tile_store.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "made_meshes.h"
#include "tests/support/error_of.h"

namespace skyquilt::surface {
namespace {

class TileStore : public testing::Test {
 protected:
  TileStore() : folder_(std::filesystem::temp_directory_path() / ("skyquilt_tile_store_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~TileStore() override { std::filesystem::remove_all(folder_); }

  // Every truncation and every changed bit is noticed, with a message that names the file and what to do.
  void ExpectDamageIsNoticed(const std::filesystem::path& file, const std::function<void()>& load) {
    const std::string whole = base::ReadFile(file);
    const auto expect_error = [&](const std::string& content, const std::string& what) {
      // Not atomically, and as a new file: file systems may wait for the disk when a file is replaced, which takes long for thousands.
      std::filesystem::remove(file);
      std::FILE* out = std::fopen(file.c_str(), "wb");
      ASSERT_NE(out, nullptr);
      ASSERT_EQ(std::fwrite(content.data(), 1, content.size(), out), content.size());
      std::fclose(out);
      const auto error = Caught<base::InputError>([&] { load(); });
      ASSERT_TRUE(error) << what << " is not noticed";
      EXPECT_EQ(error->file(), file);
      EXPECT_NE(error->finding().find("Delete it; the same command makes it again"), std::string::npos) << error->finding();
    };
    for (size_t n = 0; n < whole.size(); ++n) expect_error(whole.substr(0, n), "a cut after " + std::to_string(n) + " bytes");
    expect_error(whole + "x", "a byte too many");
    for (size_t i = 0; i < whole.size(); ++i) {
      std::string changed = whole;
      changed[i] = static_cast<char>(changed[i] ^ (1 << (i % 8)));
      expect_error(changed, "a changed bit in byte " + std::to_string(i));
    }
  }

  std::filesystem::path folder_;
};

void ExpectSameMesh(const Mesh& a, const Mesh& b) {
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.key, b.key);
  EXPECT_EQ(a.views, b.views);
  EXPECT_EQ(a.filled, b.filled);
  EXPECT_EQ(a.triangle, b.triangle);
}

BakedTile SmallBakedTile() {
  BakedTile baked;
  TexturedTile& tile = baked.tile;
  tile.id = {2, -3, 4};
  tile.error_m = 0.25;
  tile.position = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9.5}};
  tile.normal = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
  tile.uv = {{0, 0}, {0.5F, 0}, {0, 1}};
  tile.views = {3, 4, 255};
  tile.filled = {0, 1, 0};
  tile.triangle = {{0, 1, 2}};
  tile.atlas_width = 64;
  tile.atlas_height = 32;
  tile.atlas_jpeg = {0xFF, 0xD8, 0, 1, 2};
  baked.points = {{{1, 2, 3}, {0, 0, 1}, {10, 20, 30}, 7, 0, 2}, {{4, 5, 6}, {0, 1, 0}, {40, 50, 60}, 0, 1, 1}};
  return baked;
}

TEST_F(TileStore, TilesComeBackAsTheyWere) {
  const std::vector<MeshTile> tiles = {{{0, -1, 7}, GridMesh(0, 0, 9, 5, [](int x, int y) { return Noise(x, y, 1.0); }), 0.125},
                                       {{1, -1, 3}, GridMesh(0, 0, 2, 2, Flat), 0.5},
                                       {{1, 0, 3}, Mesh(), 0.0}};
  SaveMeshTiles(tiles, folder_ / "tiles.bin");
  const std::vector<MeshTile> loaded = LoadMeshTiles(folder_ / "tiles.bin");
  ASSERT_EQ(loaded.size(), tiles.size());
  for (size_t i = 0; i < tiles.size(); ++i) {
    EXPECT_EQ(loaded[i].id, tiles[i].id);
    EXPECT_EQ(loaded[i].error_m, tiles[i].error_m);
    ExpectSameMesh(loaded[i].mesh, tiles[i].mesh);
  }
  SaveMeshTiles({}, folder_ / "none.bin");
  EXPECT_TRUE(LoadMeshTiles(folder_ / "none.bin").empty());
}

TEST_F(TileStore, MeshesComeBackAsTheyWere) {
  const Mesh mesh = GridMesh(-3, -3, 3, 3, Flat);
  SaveMesh(mesh, folder_ / "mesh.bin");
  ExpectSameMesh(LoadMesh(folder_ / "mesh.bin"), mesh);
  SaveMesh(Mesh(), folder_ / "empty.bin");
  ExpectSameMesh(LoadMesh(folder_ / "empty.bin"), Mesh());
}

TEST_F(TileStore, BakedTilesComeBackAsTheyWere) {
  const BakedTile baked = SmallBakedTile();
  SaveBakedTile(baked, folder_ / "baked.bin");
  const BakedTile loaded = LoadBakedTile(folder_ / "baked.bin");
  EXPECT_EQ(loaded.tile.id, baked.tile.id);
  EXPECT_EQ(loaded.tile.error_m, baked.tile.error_m);
  EXPECT_EQ(loaded.tile.position, baked.tile.position);
  EXPECT_EQ(loaded.tile.normal, baked.tile.normal);
  EXPECT_EQ(loaded.tile.uv, baked.tile.uv);
  EXPECT_EQ(loaded.tile.views, baked.tile.views);
  EXPECT_EQ(loaded.tile.filled, baked.tile.filled);
  EXPECT_EQ(loaded.tile.triangle, baked.tile.triangle);
  EXPECT_EQ(loaded.tile.atlas_width, 64);
  EXPECT_EQ(loaded.tile.atlas_height, 32);
  EXPECT_EQ(loaded.tile.atlas_jpeg, baked.tile.atlas_jpeg);
  ASSERT_EQ(loaded.points.size(), 2U);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(loaded.points[i].position, baked.points[i].position);
    EXPECT_EQ(loaded.points[i].normal, baked.points[i].normal);
    EXPECT_EQ(loaded.points[i].rgb, baked.points[i].rgb);
    EXPECT_EQ(loaded.points[i].views, baked.points[i].views);
    EXPECT_EQ(loaded.points[i].filled, baked.points[i].filled);
    EXPECT_EQ(loaded.points[i].las_class, baked.points[i].las_class);
  }
}

TEST_F(TileStore, DamageIsNoticedAtEveryByte) {
  const std::filesystem::path tiles = folder_ / "tiles.bin", mesh = folder_ / "mesh.bin", baked = folder_ / "baked.bin";
  SaveMeshTiles({{{0, 1, 2}, GridMesh(0, 0, 1, 1, Flat), 0.1}}, tiles);
  ExpectDamageIsNoticed(tiles, [&] { LoadMeshTiles(tiles); });
  SaveMesh(GridMesh(0, 0, 1, 1, Flat), mesh);
  ExpectDamageIsNoticed(mesh, [&] { LoadMesh(mesh); });
  SaveBakedTile(SmallBakedTile(), baked);
  ExpectDamageIsNoticed(baked, [&] { LoadBakedTile(baked); });
}

TEST_F(TileStore, ContentIsCheckedEvenWithAFittingChecksum) {
  Mesh mesh = GridMesh(0, 0, 1, 1, Flat);
  mesh.triangle[1][2] = 4;
  SaveMesh(mesh, folder_ / "mesh.bin");
  EXPECT_THROW(LoadMesh(folder_ / "mesh.bin"), base::InputError);
  SaveMeshTiles({{{-1, 0, 0}, Mesh(), 0.0}}, folder_ / "tiles.bin");
  EXPECT_THROW(LoadMeshTiles(folder_ / "tiles.bin"), base::InputError);
  BakedTile baked = SmallBakedTile();
  baked.tile.triangle[0][0] = 3;
  SaveBakedTile(baked, folder_ / "baked.bin");
  EXPECT_THROW(LoadBakedTile(folder_ / "baked.bin"), base::InputError);
  // A length that would need more memory than any machine has.
  const uint64_t huge = ~uint64_t{0} / 2;
  const std::string content(reinterpret_cast<const char*>(&huge), sizeof(huge));
  const uint64_t bytes = content.size();
  base::WriteFileAtomically(folder_ / "huge.bin",
                            "SQMESH_1" + std::string(reinterpret_cast<const char*>(&bytes), sizeof(bytes)) + base::HashHex(content) + content);
  EXPECT_THROW(LoadMesh(folder_ / "huge.bin"), base::InputError);
}

TEST_F(TileStore, OtherKindsAndMissingFilesAreErrors) {
  SaveMesh(Mesh(), folder_ / "mesh.bin");
  EXPECT_THROW(LoadMeshTiles(folder_ / "mesh.bin"), base::InputError);
  EXPECT_THROW(LoadBakedTile(folder_ / "mesh.bin"), base::InputError);
  EXPECT_THROW(LoadMesh(folder_ / "missing.bin"), base::InputError);
  Mesh uneven = GridMesh(0, 0, 1, 1, Flat);
  uneven.views.pop_back();
  EXPECT_THROW(SaveMesh(uneven, folder_ / "mesh.bin"), std::logic_error);
}

}  // namespace
}  // namespace skyquilt::surface
