#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "buildings/points/surface_points.h"
#include "core/base/file.h"
#include "surface/tile_store.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::buildings {
namespace {

class LoadPoints : public testing::Test {
 protected:
  LoadPoints() { std::filesystem::create_directories(folder_ / "textures"); }

  // n points of the tile, numbered by their red, the tile by their green.
  void Save(const surface::TileId& id, size_t n, uint8_t tile, const std::vector<size_t>& broken = {}) {
    surface::BakedTile baked;
    baked.tile.id = id;
    for (size_t i = 0; i < n; ++i) {
      surface::CloudPoint& point = baked.points.emplace_back();
      point.position = Eigen::Vector3d(50.0 * id.column + 0.25 * static_cast<double>(i), 50.0 * id.row, 10.0);
      point.normal = Eigen::Vector3f(0, 0, 2);
      point.rgb = {static_cast<uint8_t>(i), tile, 7};
      point.views = 5;
      point.filled = i == 0 ? 1 : 0;
    }
    for (const size_t i : broken) baked.points[i].position.x() = std::numeric_limits<double>::quiet_NaN();
    surface::SaveBakedTile(baked, folder_ / "textures" / (id.Name() + ".bin"));
  }
  std::string ErrorOfLoad() {
    return InputErrorOf([&] { LoadSurfacePoints(folder_.path(), 0.25); });
  }

  TemporaryFolder folder_;
};

// By number: by name, 0_-1_0 would come before 0_-2_0, and 0_10_0 before 0_9_0.
TEST_F(LoadPoints, AreInTheOrderOfTheCloud) {
  Save({0, 10, 0}, 2, 5);
  Save({0, 9, 0}, 2, 4);
  Save({0, 9, -1}, 2, 3);
  Save({0, -1, 3}, 2, 2);
  Save({0, -2, 7}, 2, 1);
  Save({1, -5, 0}, 2, 9);  // of a coarser level
  base::WriteFileAtomically(folder_ / "textures" / "voxel.txt", "0\n");
  const PointCloud cloud = LoadSurfacePoints(folder_.path(), 0.25);
  ASSERT_EQ(cloud.points.size(), 10U);
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    EXPECT_EQ(cloud.points[i].rgb[1], i / 2 + 1);
    EXPECT_EQ(cloud.points[i].rgb[0], i % 2);
  }
  EXPECT_EQ(cloud.spacing_m, 0.25);
}

TEST_F(LoadPoints, KeepTheirPlacesFarFromTheOrigin) {
  Save({0, 40000, -30000}, 3, 1);
  Save({0, 40001, -30000}, 3, 2);
  const PointCloud cloud = LoadSurfacePoints(folder_.path(), 0.25);
  ASSERT_EQ(cloud.points.size(), 6U);
  EXPECT_LT((cloud.At(1) - Eigen::Vector3d(2000000.25, -1500000, 10)).norm(), 1e-4);
  EXPECT_LT((cloud.At(5) - Eigen::Vector3d(2000050.5, -1500000, 10)).norm(), 1e-4);
  EXPECT_FLOAT_EQ(cloud.points[1].normal.norm(), 1.0F);
  EXPECT_EQ(cloud.points[0].filled, 1);
  EXPECT_EQ(cloud.points[1].filled, 0);
  EXPECT_EQ(cloud.points[1].views, 5);
}

TEST_F(LoadPoints, LeaveOutWhatTheCloudLeavesOut) {
  Save({0, 0, 0}, 5, 1, {0, 3});
  const PointCloud cloud = LoadSurfacePoints(folder_.path(), 0.25);
  ASSERT_EQ(cloud.points.size(), 3U);
  EXPECT_EQ(cloud.points[0].rgb[0], 1);
  EXPECT_EQ(cloud.points[2].rgb[0], 4);
  EXPECT_TRUE(cloud.middle.allFinite());
}

TEST_F(LoadPoints, MissingPointsAreExplained) {
  EXPECT_NE(ErrorOfLoad().find("surface.cloud"), std::string::npos);
  Save({0, 0, 0}, 0, 1);  // surface.cloud was off
  EXPECT_NE(ErrorOfLoad().find("surface.cloud"), std::string::npos);
  std::filesystem::remove_all(folder_ / "textures");
  EXPECT_NE(ErrorOfLoad().find("skyquilt surface"), std::string::npos);
}

TEST_F(LoadPoints, DamagedTilesAreErrors) {
  Save({0, 0, 0}, 5, 1);
  Save({0, 1, 0}, 5, 1);
  const std::filesystem::path file = folder_ / "textures" / "0_1_0.bin";
  std::string bytes = base::ReadFile(file);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  base::WriteFileAtomically(file, bytes);
  const std::string error = ErrorOfLoad();
  EXPECT_NE(error.find("0_1_0.bin"), std::string::npos);
  EXPECT_NE(error.find("skyquilt surface"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::buildings
