#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/file.h"
#include "surface/files/surface_files.h"
#include "tests/surface/files/sample_surface.h"

namespace skyquilt::surface {
namespace {

using LasTest = InToronto;

constexpr FileSelection kOnlyCloud = {.glb = false, .obj = false, .ply = false, .cloud = true, .tiles = false};

// A reader written from the specification (LAS 1.4 R15).
struct Las {
  std::string bytes;
  explicit Las(const std::filesystem::path& file) : bytes(base::ReadFile(file)) {}
  template <typename T>
  T At(size_t offset) const {
    return ReadAs<T>(bytes, offset);
  }
  uint64_t count() const { return At<uint64_t>(247); }
  size_t PointOffset(size_t i) const { return At<uint32_t>(96) + i * At<uint16_t>(105); }
  Eigen::Vector3d Point(size_t i) const {
    Eigen::Vector3d x;
    for (size_t axis = 0; axis < 3; ++axis) {
      x[static_cast<Eigen::Index>(axis)] = At<int32_t>(PointOffset(i) + 4 * axis) * At<double>(131 + 8 * axis) + At<double>(155 + 8 * axis);
    }
    return x;
  }
  std::string Wkt() const { return bytes.substr(375 + 54, At<uint16_t>(375 + 20)); }
};

TEST_F(LasTest, HeaderIsThatOfVersion14) {
  const std::vector<CloudPoint> points = SamplePoints(100);
  SurfaceFiles files(frame_, kOnlyCloud, kSampleTile_m, folder_.path());
  files.AddPoints(points);
  files.Close();
  const Las las(folder_ / "cloud.las");
  EXPECT_EQ(las.bytes.substr(0, 4), "LASF");
  EXPECT_EQ(las.At<uint16_t>(6), 16) << "WKT, GPS week time";
  EXPECT_EQ(las.At<uint8_t>(24), 1);
  EXPECT_EQ(las.At<uint8_t>(25), 4);
  EXPECT_EQ(std::string(las.bytes.c_str() + 26), "Skyquilt");
  EXPECT_EQ(std::string(las.bytes.c_str() + 58), "Skyquilt");
  EXPECT_EQ(las.At<uint16_t>(94), 375);
  EXPECT_EQ(las.At<uint32_t>(100), 1U) << "variable length records";
  EXPECT_EQ(las.At<uint8_t>(104), 7);
  EXPECT_EQ(las.At<uint16_t>(105), 36);
  for (size_t i = 0; i < 6; ++i) EXPECT_EQ(las.At<uint32_t>(107 + 4 * i), 0U) << "counts of older versions";
  EXPECT_EQ(las.count(), 100U);
  EXPECT_EQ(las.At<uint64_t>(255), 100U) << "first returns";
  EXPECT_EQ(las.At<uint64_t>(263), 0U);
  EXPECT_EQ(las.bytes.size(), las.PointOffset(100));
  EXPECT_EQ(std::string(las.bytes.c_str() + 377), "LASF_Projection");
  EXPECT_EQ(las.At<uint16_t>(375 + 18), 2112);
  EXPECT_EQ(las.At<uint32_t>(96), 375U + 54U + las.At<uint16_t>(375 + 20));
  EXPECT_EQ(las.Wkt().back(), '\0');
  EXPECT_NE(las.Wkt().find("PROJCS[\"WGS 84 / UTM zone 17N\""), std::string::npos);
  EXPECT_NE(las.Wkt().find("AUTHORITY[\"EPSG\",\"32617\"]"), std::string::npos);
}

TEST_F(LasTest, PointsComeBackToAMillimetre) {
  for (const geo::Geodetic& origin : DifficultOrigins()) {
    const TemporaryFolder folder;
    const MapFrame frame(SampleInfo(origin));
    const std::vector<CloudPoint> points = SamplePoints(50);
    SurfaceFiles files(frame, kOnlyCloud, kSampleTile_m, folder.path());
    files.AddPoints(points);
    files.Close();
    const Las las(folder / "cloud.las");
    Eigen::Vector3d min = Eigen::Vector3d::Constant(HUGE_VAL), max = -min;
    for (size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d position = las.Point(i);
      min = min.cwiseMin(position);
      max = max.cwiseMax(position);
      EXPECT_LT((position - frame.MapFromEnu(points[i].position)).cwiseAbs().maxCoeff(), 0.00051);
      const size_t at = las.PointOffset(i);
      EXPECT_EQ(las.At<uint8_t>(at + 14), 0x11);
      EXPECT_EQ(las.At<uint8_t>(at + 16), points[i].las_class);
      EXPECT_EQ(las.At<uint8_t>(at + 17), points[i].views);
      EXPECT_EQ(las.At<uint16_t>(at + 30), points[i].rgb[0] * 257);
      EXPECT_EQ(las.At<uint16_t>(at + 32), 65535);
      EXPECT_EQ(las.At<uint16_t>(at + 34), 0);
    }
    for (size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(las.At<double>(179 + 16 * axis), max[static_cast<Eigen::Index>(axis)]);
      EXPECT_EQ(las.At<double>(187 + 16 * axis), min[static_cast<Eigen::Index>(axis)]);
    }
  }
}

TEST_F(LasTest, SplitsAboveTheLimitIntoCompleteFiles) {
  const std::vector<CloudPoint> points = SamplePoints(25);
  SurfaceFiles files(frame_, kOnlyCloud, kSampleTile_m, folder_.path(), 10);
  files.AddPoints(std::span(points).first(7));
  files.AddPoints(std::span(points).subspan(7));
  const std::vector<WrittenFile> table = files.Close();
  EXPECT_EQ(NamesIn(folder_.path()),
            (std::vector<std::string>{"cloud.ply", "cloud_1.las", "cloud_2.las", "cloud_3.las", "georeference.json", "offset.txt"}));
  size_t next = 0;
  for (int part = 1; part <= 3; ++part) {
    const Las las(folder_ / ("cloud_" + std::to_string(part) + ".las"));
    EXPECT_EQ(las.count(), part == 3 ? 5U : 10U);
    EXPECT_EQ(las.bytes.size(), las.PointOffset(las.count()));
    double min_z = HUGE_VAL;
    for (size_t i = 0; i < las.count(); ++i, ++next) {
      EXPECT_LT((las.Point(i) - frame_.MapFromEnu(points[next].position)).cwiseAbs().maxCoeff(), 0.00051);
      min_z = std::min(min_z, las.Point(i).z());
    }
    EXPECT_EQ(las.At<double>(219), min_z) << "bounds of this part alone";
  }
  EXPECT_EQ(next, points.size());
  EXPECT_EQ(table[0].file, "cloud_1.las");
  EXPECT_EQ(table[0].detail, "25 points in 3 files");
}

TEST_F(LasTest, ExactlyTheLimitIsOneFile) {
  SurfaceFiles files(frame_, kOnlyCloud, kSampleTile_m, folder_.path(), 10);
  files.AddPoints(SamplePoints(10));
  files.Close();
  EXPECT_EQ(Las(folder_ / "cloud.las").count(), 10U);
}

TEST_F(LasTest, PointsThatAreNotFiniteAreLeftOut) {
  std::vector<CloudPoint> points = SamplePoints(3);
  points[1].position.y() = std::numeric_limits<double>::quiet_NaN();
  points[2].normal.setZero();
  SurfaceFiles files(frame_, kOnlyCloud, kSampleTile_m, folder_.path());
  files.AddPoints(points);
  files.Close();
  EXPECT_EQ(Las(folder_ / "cloud.las").count(), 2U);
}

TEST_F(LasTest, LocalCloudsSaySo) {
  const MapFrame frame(SampleInfo({0.0, 0.0, 0.0}, false));
  SurfaceFiles files(frame, kOnlyCloud, kSampleTile_m, folder_.path());
  files.AddPoints(SamplePoints(3));
  files.Close();
  EXPECT_NE(Las(folder_ / "cloud.las").Wkt().find("LOCAL_CS"), std::string::npos);
}

TEST_F(LasTest, NamesWhatHeightsAreAbove) {
  for (const geo::Vertical vertical : {geo::Vertical::kAsTagged, geo::Vertical::kEgm96}) {
    const TemporaryFolder folder;
    const MapFrame frame(SampleInfo({43.64, -79.39, 100.0}), vertical);
    SurfaceFiles files(frame, kOnlyCloud, kSampleTile_m, folder.path());
    files.AddPoints(SamplePoints(3));
    files.Close();
    const std::string wkt = Las(folder / "cloud.las").Wkt();
    EXPECT_NE(wkt.find("32617"), std::string::npos) << wkt;
    EXPECT_NE(wkt.find(vertical == geo::Vertical::kEgm96 ? "EGM96 height" : "VERT_DATUM[\"Ellipsoid\",2002]"), std::string::npos) << wkt;
  }
}

}  // namespace
}  // namespace skyquilt::surface
