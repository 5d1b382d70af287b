// Whole preparations with models of other programs.
#include "prepare/model_use.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/geo/enu_frame.h"
#include "prepare/georeference/tags/photo_positions.h"
#include "prepare/prepare.h"
#include "tests/prepare/models/made_models.h"
#include "tests/prepare/synthetic_flight.h"
#include "tests/support/error_of.h"

namespace skyquilt::prepare {
namespace {

class OtherModel : public ::testing::Test {
 protected:
  // The flight as another program reconstructs it, in ENU about the flight's origin.
  test::MadeModel Made() const {
    test::MadeModel made;
    made.lens = {.width = 64, .height = 48, .fx = 60.0, .fy = 60.0, .cx = 32.0, .cy = 24.0, .k1 = 0.0, .k2 = 0.0, .k3 = 0.0, .p1 = 0.0, .p2 = 0.0};
    for (const test::FlightPhoto& photo : flight_.photos) {
      made.photos.push_back({photo.name, Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal().toDenseMatrix(), photo.centre_in_enu});
    }
    const Eigen::Quaterniond enu_from_model = flight_.model_from_enu.rotation.conjugate();
    for (const survey::ColmapPoint& point : flight_.model.points) {
      made.points.push_back(enu_from_model * (point.x_in_world - flight_.model_from_enu.translation) / flight_.model_from_enu.scale);
    }
    return made;
  }
  survey::Survey Run(const test::Files& files, const std::string& model) {
    test::WriteFlight(flight_, folder_.path());
    test::WriteFiles(files, folder_.path());
    return Prepare({folder_ / "images", folder_ / model, folder_ / "out"}, options_, threads_);
  }

  TemporaryFolder folder_;
  test::Flight flight_ = test::MakeFlight({47.0, 8.0, 400.0});
  PrepareOptions options_;
  base::ThreadPool threads_{2};
};

TEST_F(OtherModel, IsPlacedByTheTagsOfThePhotos) {
  const survey::Survey survey = Run(test::TransformsFiles(Made()), "transforms.json");
  ASSERT_EQ(survey.photos.size(), 20U);
  EXPECT_TRUE(survey.georeferenced);
  EXPECT_LT(survey.fit.rmse_m, 0.02);
  EXPECT_NEAR(survey.MedianAgl(), test::kFlightHeight_m, 3.0);
  EXPECT_FALSE(survey.HasTracks());
  EXPECT_TRUE(survey.photos[0].is_test && survey.photos[8].is_test && survey.photos[16].is_test);
}

TEST_F(OtherModel, IsPlacedByItselfWherePhotosHaveNoTags) {
  for (test::FlightPhoto& photo : flight_.photos) {
    photo.tags.gps.reset();
    photo.tags.absolute_altitude_m.reset();
  }
  test::Files files = test::OpensfmFiles(Made());
  files["reference_lla.json"] = R"({"latitude": 47.0, "longitude": 8.0, "altitude": 400.0})";
  const survey::Survey survey = Run(files, "reconstruction.json");
  ASSERT_EQ(survey.photos.size(), 20U);
  EXPECT_TRUE(survey.georeferenced);
  EXPECT_TRUE(survey.HasTracks());
  EXPECT_FALSE(survey.photos[0].gps.has_value());  // the photos still have no tag
  const geo::EnuFrame frame(survey.origin), truth(flight_.origin);
  const geo::Geodetic position = frame.GeodeticFromEnu(survey.photos[3].cam_from_enu.OriginInSource());
  EXPECT_LT((truth.EnuFromGeodetic(position) - flight_.photos[3].centre_in_enu).norm(), 0.1);
}

TEST_F(OtherModel, ItsSplitIsKeptUnlessAnotherIsAskedFor) {
  test::Files files = test::TransformsFiles(Made());
  nlohmann::json file = base::ParseJson(files["transforms.json"]);
  file["test_filenames"] = {"images/photo_05.jpg", "images/photo_06.jpg"};
  files["transforms.json"] = base::JsonText(file);
  survey::Survey survey = Run(files, "transforms.json");
  for (const survey::Photo& photo : survey.photos)
    EXPECT_EQ(photo.is_test, photo.name == "photo_05.jpg" || photo.name == "photo_06.jpg") << photo.name;
  options_.holdout = "none";
  survey = Run(files, "transforms.json");
  for (const survey::Photo& photo : survey.photos) EXPECT_FALSE(photo.is_test) << photo.name;
}

TEST_F(OtherModel, WithoutPointsOrOfOtherPhotosHasItsOwnMessage) {
  options_.colmap = "no-such-colmap";
  const std::string no_points = InputErrorOf([&] { Run(test::MetashapeFiles(Made()), "cameras.xml"); });
  EXPECT_NE(no_points.find("has poses but no sparse points"), std::string::npos) << no_points;
  EXPECT_NE(no_points.find("Install COLMAP"), std::string::npos) << no_points;
  test::MadeModel other_size = Made();
  other_size.lens.width = 128;
  const std::string size = InputErrorOf([&] { Run(test::TransformsFiles(other_size), "transforms.json"); });
  EXPECT_NE(size.find("have another size"), std::string::npos) << size;
}

TEST_F(OtherModel, GeoFileReplacesTheTags) {
  const geo::EnuFrame frame(flight_.origin);
  std::string table = "EPSG:4326\n";
  for (test::FlightPhoto& photo : flight_.photos) {
    const geo::Geodetic p = frame.GeodeticFromEnu(photo.centre_in_enu);
    std::ostringstream line;
    line.precision(12);
    line << photo.name << " " << p.longitude_deg << " " << p.latitude_deg << " " << p.height_m << " 0 0 0 0.03 0.05\n";
    table += line.str();
    photo.tags.gps->latitude_deg += 0.01;  // a kilometre off
  }
  const survey::Survey survey = Run({{"geo.txt", table}}, "sparse/0");
  EXPECT_TRUE(survey.georeferenced);
  EXPECT_NEAR(survey.origin.latitude_deg, 47.0, 1e-3);
}

TEST_F(OtherModel, ThePositionFileOfTheOptionCountsInPlaceOfTheTags) {
  const geo::EnuFrame frame(flight_.origin);
  std::ostringstream table;
  table.precision(12);
  table << "EPSG:4326\n";
  for (const test::FlightPhoto& photo : flight_.photos) {
    const geo::Geodetic p = frame.GeodeticFromEnu(photo.centre_in_enu);
    table << photo.name << " " << p.longitude_deg << " " << p.latitude_deg + 0.01 << " " << p.height_m << " 0 0 0 0.03 0.05\n";
  }
  options_.geo_file = (folder_ / "positions.txt").string();
  base::WriteFileAtomically(options_.geo_file, table.str());
  EXPECT_EQ(georeference::PositionFiles(folder_.path(), options_.geo_file), (std::vector<std::filesystem::path>{options_.geo_file}));
  const survey::Survey survey = Run({}, "sparse/0");
  EXPECT_NEAR(survey.origin.latitude_deg, 47.01, 1e-3);
}

TEST_F(OtherModel, ASplitOfPhotosWithoutPosesLeavesTheUsualOne) {
  test::Files files = test::TransformsFiles(Made());
  nlohmann::json file = base::ParseJson(files["transforms.json"]);
  file["test_filenames"] = {"images/elsewhere.jpg"};
  files["transforms.json"] = base::JsonText(file);
  const survey::Survey survey = Run(files, "transforms.json");
  const auto n_test = std::count_if(survey.photos.begin(), survey.photos.end(), [](const survey::Photo& photo) { return photo.is_test; });
  EXPECT_EQ(n_test, 3);  // every eighth of 20
}

}  // namespace
}  // namespace skyquilt::prepare
