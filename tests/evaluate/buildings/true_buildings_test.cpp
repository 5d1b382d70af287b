#include "evaluate/buildings/true_buildings.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/geo/enu_frame.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate::buildings {
namespace {

constexpr const char* kOutline = R"({"outlines": [{"id": 7, "shape": "courtyard", "kind": "apartment", "roof": "hip", "parts": [0, 1],
  "walls": [[0, 0], [20, 0], [20, 12], [0, 12]], "holes": [[[5, 4], [15, 4], [15, 8], [5, 8]]], "centre": [10, 6], "length_m": 20, "width_m": 12,
  "yaw_deg": 0, "ground_z_m": 3, "eave_height_m": 6, "ridge_height_m": 9.5, "area_m2": 200, "inside_area": false}], "buildings": [
  {"id": 0, "roof": "hip", "length_m": 10, "width_m": 10, "eave_height_m": 6, "ridge_height_m": 9, "ground_z_m": 3, "yaw_deg": 0, "inside_area": false},
  {"id": 1, "roof": "gable", "length_m": 10, "width_m": 9.5, "eave_height_m": 4, "ridge_height_m": 9.5, "ground_z_m": 3, "yaw_deg": 0,
   "inside_area": false}]})";

class TrueBuildingsFile : public testing::Test {
 protected:
  TrueBuildingsFile() { std::filesystem::create_directories(file_.parent_path()); }
  TrueBuildings Read(const std::string& content) {
    base::WriteFileAtomically(file_, content);
    return ReadTrueBuildings(file_, origin_);
  }
  void WriteArea(const std::string& low, const std::string& high, double latitude_deg = 47.0) {
    base::WriteFileAtomically(folder_ / "simulate.json", R"({"origin": {"latitude_deg": )" + std::to_string(latitude_deg) +
                                                             R"(, "longitude_deg": 8.0, "height_m": 400.0}, "blocks": {"min_enu": )" + low +
                                                             R"(, "max_enu": )" + high + "}}");
  }
  static std::string Row(double east_m, double length_m, double width_m, bool inside) {
    return R"({"buildings": [{"id": 4, "kind": "hall", "roof": "flat", "east_m": )" + std::to_string(east_m) +
           R"(, "north_m": 0, "ground_z_m": 1, "length_m": )" + std::to_string(length_m) + R"(, "width_m": )" + std::to_string(width_m) +
           R"(, "eave_height_m": 5, "ridge_height_m": 5, "yaw_deg": 30, "inside_area": )" + (inside ? "true" : "false") + "}]}";
  }

  TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_ / "truth/buildings.json";
  const geo::Geodetic origin_{47.0, 8.0, 400.0};
};

TEST_F(TrueBuildingsFile, OutlinesAreReadWithTheirHoles) {
  const TrueBuildings truth = Read(kOutline);
  ASSERT_EQ(truth.outlines.size(), 1U);
  const TrueBuilding& one = truth.outlines[0];
  EXPECT_EQ(one.id, 7);
  EXPECT_EQ(one.kind, "apartment");
  EXPECT_EQ(one.roof, RoofKind::kHip);
  EXPECT_NEAR(one.area_m2, 200.0, 1e-9) << "the hole counts, however its ring is turned";
  EXPECT_FALSE(Contains(one.walls, {10, 6}));
  EXPECT_DOUBLE_EQ(one.ground_z_m, 3.0);
  EXPECT_DOUBLE_EQ(one.eave_z_m, 9.0);
  EXPECT_EQ(one.other_eaves_z_m, (std::vector<double>{9.0, 7.0})) << "parts of nearly the same size";
  EXPECT_DOUBLE_EQ(one.ridge_z_m, 12.5);
  EXPECT_FALSE(one.inside);
  EXPECT_FALSE(truth.area.has_value());
}

TEST_F(TrueBuildingsFile, RowsOfEarlierSurveysBecomeRectangles) {
  const TrueBuildings truth = Read(Row(50.0, 10.0, 16.0, true));
  ASSERT_EQ(truth.outlines.size(), 1U);
  const TrueBuilding& one = truth.outlines[0];
  EXPECT_EQ(one.walls.outer.size(), 4U);
  EXPECT_NEAR(one.area_m2, 160.0, 1e-9);
  EXPECT_NEAR((Centroid(one.walls) - Eigen::Vector2d(50, 0)).norm(), 0.0, 1e-9);
  EXPECT_DOUBLE_EQ(one.length_m, 16.0) << "the longer side";
  EXPECT_DOUBLE_EQ(one.width_m, 10.0);
  EXPECT_NEAR(one.yaw_deg, 120.0, 1e-9);
  EXPECT_TRUE(one.inside);
}

TEST_F(TrueBuildingsFile, ARowMustBeWhollyInsideTheSurveyedArea) {
  WriteArea("[-60, -60]", "[60, 60]");
  EXPECT_TRUE(Read(Row(40.0, 16.0, 10.0, true)).outlines[0].inside);
  const TrueBuildings truth = Read(Row(55.0, 16.0, 10.0, true));
  EXPECT_FALSE(truth.outlines[0].inside) << "only its centre is";
  ASSERT_TRUE(truth.area.has_value());
  EXPECT_NEAR(Area(*truth.area), 120.0 * 120.0, 1e-6);
}

TEST_F(TrueBuildingsFile, AreMovedWhenTheSurveyHasAnotherOrigin) {
  WriteArea("[-60, -60]", "[60, 60]", 47.01);
  const TrueBuildings truth = Read(kOutline);
  const geo::EnuFrame simulated({47.01, 8.0, 400.0}), survey(origin_);
  const Eigen::Vector3d corner = survey.EnuFromGeodetic(simulated.GeodeticFromEnu({20, 12, 3}));
  EXPECT_GT(corner.norm(), 1000.0);
  double nearest_m = 1e9;
  for (const Eigen::Vector2d& point : truth.outlines[0].walls.outer) nearest_m = std::min(nearest_m, (point - corner.head<2>()).norm());
  EXPECT_LT(nearest_m, 1e-4);
  EXPECT_NEAR(truth.outlines[0].ground_z_m, corner.z(), 0.01);
  EXPECT_NEAR(truth.outlines[0].ridge_z_m - truth.outlines[0].ground_z_m, 9.5, 1e-6);
  const Eigen::Vector3d middle = survey.EnuFromGeodetic(simulated.GeodeticFromEnu({0, 0, 0}));
  EXPECT_TRUE(Contains(*truth.area, middle.head<2>()));
}

TEST_F(TrueBuildingsFile, DamageIsNoticed) {
  EXPECT_THROW(Read("{"), base::InputError);
  EXPECT_THROW(Read("{}"), base::InputError);
  EXPECT_THROW(Read(R"({"outlines": [{"id": 1}]})"), base::InputError);
  std::string no_walls = kOutline;
  no_walls.replace(no_walls.find("[[0, 0], [20, 0], [20, 12], [0, 12]]"), 36, "[[0, 0], [20, 0]]");
  EXPECT_THROW(Read(no_walls), base::InputError);
  EXPECT_TRUE(Read(R"({"outlines": []})").outlines.empty());
}

}  // namespace
}  // namespace skyquilt::evaluate::buildings
