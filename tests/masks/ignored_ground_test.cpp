#include "masks/ignored_ground.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/base/file.h"
#include "core/geo/enu_frame.h"
#include "tests/masks/mask_survey.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::masks {
namespace {

using Ring = std::vector<Eigen::Vector2d>;

std::string GeoJson(const std::vector<std::vector<Ring>>& polygons) {
  std::string features;
  for (const std::vector<Ring>& polygon : polygons) {
    std::string rings;
    for (const Ring& ring : polygon) {
      std::string points;
      for (size_t i = 0; i <= ring.size(); ++i) {
        const Eigen::Vector2d& point = ring[i % ring.size()];
        points += (i == 0 ? "" : ",") + fmt::format("[{:.9f},{:.9f}]", point.x(), point.y());
      }
      rings += (rings.empty() ? "[" : ",[") + points + "]";
    }
    features += (features.empty() ? "" : ",") + std::string(R"({"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[)") +
                rings + "]}}";
  }
  return R"({"type":"FeatureCollection","features":[)" + features + "]}";
}

Ring Square(double x, double y, double half) {
  return {{x - half, y - half}, {x + half, y - half}, {x + half, y + half}, {x - half, y + half}};
}

class IgnoredGroundTest : public testing::Test {
 protected:
  std::filesystem::path Write(const std::string& text) const {
    base::WriteFileAtomically(folder_ / "lake.geojson", text);
    return folder_ / "lake.geojson";
  }
  // Rings of ENU positions in longitude and latitude.
  static std::vector<Ring> LonLat(const survey::Survey& survey, const std::vector<Ring>& rings) {
    const geo::EnuFrame frame(survey.origin);
    std::vector<Ring> degrees;
    for (const Ring& ring : rings) {
      Ring& out = degrees.emplace_back();
      for (const Eigen::Vector2d& point : ring) {
        const geo::Geodetic place = frame.GeodeticFromEnu({point.x(), point.y(), kGround_m});
        out.emplace_back(place.longitude_deg, place.latitude_deg);
      }
    }
    return degrees;
  }
  TemporaryFolder folder_;
};

// A pixel of these photos is 0.5 m on the ground.
void ExpectMask(const IgnoredGround& ground, const survey::Survey& survey, size_t photo, const std::function<bool(double, double)>& ignored) {
  const image::Image8 mask = ground.Mask(survey.cameras[0], survey.photos[photo].cam_from_enu);
  const Eigen::Vector3d eye = survey.photos[photo].cam_from_enu.OriginInSource();
  int64_t n_ignored = 0;
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      const double east = eye.x() + (x + 0.5 - 60.0) * 0.5, north = eye.y() - (y + 0.5 - 45.0) * 0.5;
      EXPECT_EQ(*mask.At(x, y) == 0, ignored(east, north)) << x << " " << y;
      n_ignored += *mask.At(x, y) == 0 ? 1 : 0;
    }
  }
  EXPECT_GT(n_ignored, 0);
}

TEST_F(IgnoredGroundTest, PixelsWhoseGroundIsInsideAreIgnored) {
  for (const bool georeferenced : {false, true}) {
    const survey::Survey survey = MakeMaskSurvey(folder_ / "", 3, georeferenced);
    const std::vector<Ring> rings = {Square(10.1, 2.1, 12.0), Square(8.1, 3.1, 5.0)};  // an island in the lake
    const IgnoredGround ground(survey, Write(GeoJson({georeferenced ? LonLat(survey, rings) : rings})));
    const auto in = [](double x, double y, double mx, double my, double half) { return std::abs(x - mx) < half && std::abs(y - my) < half; };
    for (const size_t photo : {0U, 1U}) {
      ExpectMask(ground, survey, photo, [&](double x, double y) { return in(x, y, 10.1, 2.1, 12.0) && !in(x, y, 8.1, 3.1, 5.0); });
    }
  }
}

// The lake is 5 m lower than the ground around, without points on it: the gap is filled from the shore.
TEST_F(IgnoredGroundTest, GroundWithoutPointsHasTheHeightsAround) {
  survey::Survey survey = MakeMaskSurvey(folder_ / "", 3, false);
  std::erase_if(survey.points,
                [](const survey::SparsePoint& point) { return (point.x_in_enu.head<2>() - Eigen::Vector2d(20.0, 0.0)).norm() < 11.0; });
  const IgnoredGround ground(survey, Write(GeoJson({{Square(20.1, 0.1, 10.0)}})));
  ExpectMask(ground, survey, 1, [](double x, double y) { return std::abs(x - 20.1) < 10.0 && std::abs(y - 0.1) < 10.0; });
}

// Where polygons overlap the ground is ignored; far ones, and far corners of near ones, do no harm.
TEST_F(IgnoredGroundTest, PolygonsMayOverlapAndReachFar) {
  const survey::Survey survey = MakeMaskSurvey(folder_ / "", 3, true);
  std::vector<std::vector<Ring>> polygons = {LonLat(survey, {Square(0.1, 0.1, 6.0)}), LonLat(survey, {Square(4.1, 0.1, 6.0)})};
  const geo::EnuFrame frame(survey.origin);
  const geo::Geodetic shore = frame.GeodeticFromEnu({0.0, 15.1, kGround_m});
  polygons.push_back({{{-60.0, shore.latitude_deg}, {80.0, shore.latitude_deg}, {80.0, 80.0}, {-60.0, 80.0}}});
  polygons.push_back({{{-170.0, -48.0}, {-171.0, -48.0}, {-171.0, -47.0}}});
  const IgnoredGround ground(survey, Write(GeoJson(polygons)));
  for (const Ring& ring : ground.rings()) {
    for (const Eigen::Vector2d& point : ring) EXPECT_LT(point.norm(), 5000.0);
  }
  const image::Image8 mask = ground.Mask(survey.cameras[0], survey.photos[0].cam_from_enu);
  EXPECT_EQ(*mask.At(64, 45), 0);  // x = 2.25: in both squares
  EXPECT_EQ(*mask.At(78, 45), 0);  // 9.25: in the second
  EXPECT_NE(*mask.At(82, 45), 0);  // 11.25: in none
  EXPECT_NE(*mask.At(60, 20), 0);  // y = 12.25
}

TEST_F(IgnoredGroundTest, LevelAndRisingRaysMeetNoGround) {
  survey::Survey survey = MakeMaskSurvey(folder_ / "", 3, false);
  const IgnoredGround ground(survey, Write(GeoJson({{Square(0.0, 0.0, 4000.0)}})));
  const image::Image8 mask = ground.Mask(survey.cameras[0], LevelPhoto({0.0, 0.0, kGround_m + 60.0}, "level").cam_from_enu);
  for (int x = 0; x < mask.width; ++x) {
    EXPECT_NE(*mask.At(x, 0), 0);
    EXPECT_NE(*mask.At(x, 45), 0);
    EXPECT_EQ(*mask.At(x, 89), 0);
  }
}

TEST_F(IgnoredGroundTest, KeysTellPolygonsAndHeightsApart) {
  survey::Survey survey = MakeMaskSurvey(folder_ / "", 3, false);
  const std::string key = IgnoredGround(survey, Write(GeoJson({{Square(0.0, 0.0, 8.0)}}))).Key();
  EXPECT_EQ(IgnoredGround(survey, folder_ / "lake.geojson").Key(), key);
  EXPECT_NE(IgnoredGround(survey, Write(GeoJson({{Square(0.0, 0.0, 9.0)}}))).Key(), key);
  Write(GeoJson({{Square(0.0, 0.0, 8.0)}}));
  for (survey::SparsePoint& point : survey.points) point.x_in_enu.z() += 1.0;
  EXPECT_NE(IgnoredGround(survey, folder_ / "lake.geojson").Key(), key);
}

TEST_F(IgnoredGroundTest, FilesThatCannotBeUsedAreRefusedWithARemedy) {
  survey::Survey survey = MakeMaskSurvey(folder_ / "", 3, false);
  const std::string good = GeoJson({{Square(0.0, 0.0, 8.0)}});
  for (const std::string& text : {std::string(), good.substr(0, 90), GeoJson({}), GeoJson({{Square(900.0, 0.0, 8.0)}}),
                                  std::string(R"({"type":"Point","coordinates":[0,0]})")}) {
    const std::string error = InputErrorOf([&] { IgnoredGround(survey, Write(text)); });
    EXPECT_NE(error.find("lake.geojson"), std::string::npos) << text << error;
    EXPECT_TRUE(error.find("Give a") != std::string::npos || error.find("Draw") != std::string::npos) << text << error;
  }
  EXPECT_NE(InputErrorOf([&] { IgnoredGround(survey, folder_ / "absent.geojson"); }).find("does not exist"), std::string::npos);
  survey.points.clear();
  EXPECT_NE(InputErrorOf([&] { IgnoredGround(survey, Write(good)); }).find("no sparse points"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::masks
