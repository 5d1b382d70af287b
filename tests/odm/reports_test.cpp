#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "odm/report/shots.h"
#include "odm/report/stats.h"
#include "odm/write_reports.h"
#include "prepare/models/opensfm_json.h"
#include "tests/support/nadir_photo.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::odm {
namespace {

survey::Survey SurveyOf(camera::CameraModel model, std::vector<double> params) {
  survey::Survey survey;
  survey.georeferenced = true;
  survey.origin = {47.0, 11.0, 600.0};  // two degrees east of the zone's middle: map north is 1.5 degrees off
  survey.cameras = {{.model = model, .width = 4000, .height = 3000, .params = std::move(params)}};
  survey.photos = {NadirPhoto({10.0, 20.0, 80.0}, "flight/a.jpg"), LevelPhoto({-30.0, 5.0, 2.0}, "b.jpg")};
  survey.photos[1].time_s = 4.0;
  survey.unregistered = {"c.jpg"};
  return survey;
}

survey::Survey PlainSurvey() {
  return SurveyOf(camera::CameraModel::kOpencv, {3000.0, 3010.0, 2010.0, 1490.0, 0.01, -0.02, 0.001, 0.002});
}

Eigen::Vector3d VectorOf(const nlohmann::json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

// Both ways round: what is written is what the reader of OpenSfM's models understands.
TEST(CamerasJson, LensesAreThoseOfOpenSfm) {
  using camera::CameraModel;
  const std::vector<std::pair<CameraModel, std::vector<double>>> lenses = {
      {CameraModel::kOpencv, {3000.0, 3010.0, 2010.0, 1490.0, 0.01, -0.02, 0.001, 0.002}},
      {CameraModel::kPinhole, {3000.0, 3000.0, 2005.0, 1500.0}},
      {CameraModel::kSimpleRadial, {3000.0, 2000.0, 1500.0, 0.05}},
      {CameraModel::kRadial, {3000.0, 2010.0, 1500.0, 0.05, -0.01}},
      {CameraModel::kOpencvFisheye, {2000.0, 2000.0, 2001.0, 1502.0, 0.01, 0.002, 0.0, 0.0}},
      {CameraModel::kRadialFisheye, {2000.0, 2001.0, 1502.0, 0.01, 0.002}},
      {CameraModel::kFullOpencv, {3000.0, 3010.0, 2010.0, 1490.0, 0.01, -0.02, 0.001, 0.002, 0.003, 0.0, 0.0, 0.0}}};
  const TemporaryFolder folder;
  for (const auto& [model, params] : lenses) {
    const survey::Survey survey = SurveyOf(model, params);
    const nlohmann::json cameras = base::ParseJson(base::JsonText(CamerasJson(survey)));
    ASSERT_EQ(cameras.size(), 1U);
    const nlohmann::json shots = {{"a.jpg", {{"camera", CameraKey(survey, 0)}, {"rotation", {0.0, 0.0, 0.0}}, {"translation", {0.0, 0.0, 0.0}}}}};
    const nlohmann::json reconstruction = {{"cameras", cameras}, {"shots", shots}, {"points", nlohmann::json::object()}};
    base::WriteFileAtomically(folder / "reconstruction.json", base::JsonText(nlohmann::json::array({reconstruction})));
    const prepare::models::InputModel read = prepare::models::ReadOpensfm(folder / "reconstruction.json", {folder.path(), {}});
    ASSERT_EQ(read.sfm.cameras.size(), 1U);
    const camera::Camera& back = read.sfm.cameras.begin()->second;
    for (const Eigen::Vector3d& point : {Eigen::Vector3d(0.1, -0.2, 1.0), Eigen::Vector3d(-0.5, 0.4, 1.0), Eigen::Vector3d(0.0, 0.0, 1.0)}) {
      const std::optional<Eigen::Vector2d> wanted = survey.cameras[0].ImgFromCam(point), found = back.ImgFromCam(point);
      ASSERT_TRUE(wanted && found) << camera::ModelName(model);
      EXPECT_LT((*wanted - *found).norm(), 1e-6) << camera::ModelName(model);
    }
  }
}

TEST(CamerasJson, AnUnknownLensKeepsItsParameters) {
  const nlohmann::json cameras =
      base::ParseJson(base::JsonText(CamerasJson(SurveyOf(camera::CameraModel::kFov, {3000.0, 3000.0, 2000.0, 1500.0, 0.5}))));
  EXPECT_EQ(cameras.begin()->at("projection_type"), "fov");
  EXPECT_EQ(cameras.begin()->at("params").size(), 5U);
}

TEST(ShotsJson, PlacesCamerasOnTheMap) {
  const survey::Survey survey = PlainSurvey();
  const surface::MapFrame frame = FrameOf(survey, geo::Vertical::kAsTagged);
  std::vector<survey::PhotoTags> tags(2);
  tags[1].capture_time_s = 1.6e9;
  const nlohmann::json shots = base::ParseJson(base::JsonText(ShotsJson(survey, frame, tags)));
  ASSERT_EQ(shots.at("features").size(), 2U);
  const nlohmann::json& nadir = shots.at("features").at(0);
  EXPECT_EQ(nadir.at("properties").at("filename"), "a.jpg") << "without its folder";
  EXPECT_EQ(nadir.at("properties").at("camera"), CameraKey(survey, 0));
  EXPECT_NEAR(nadir.at("properties").at("focal").get<double>(), 0.75, 1e-12);
  EXPECT_EQ(nadir.at("properties").at("capture_time"), 0.0);
  EXPECT_EQ(shots.at("features").at(1).at("properties").at("capture_time"), 1.6e9);
  for (size_t i = 0; i < 2; ++i) {
    const Eigen::Vector3d centre = survey.photos[i].cam_from_enu.OriginInSource();
    const nlohmann::json& shot = shots.at("features").at(i);
    const Eigen::Vector3d place = VectorOf(shot.at("properties").at("translation"));
    EXPECT_LT((place - frame.MapFromEnu(centre)).norm(), 1e-6);
    // What the camera sees straight ahead in the frame of the survey, it sees there on the map.
    const Eigen::Vector3d turn = VectorOf(shot.at("properties").at("rotation"));
    const Eigen::Matrix3d cam_from_map = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    for (const Eigen::Vector3d& ahead : {Eigen::Vector3d(0.0, 0.0, 50.0), Eigen::Vector3d(20.0, 0.0, 30.0), Eigen::Vector3d(0.0, 15.0, 30.0)}) {
      const Eigen::Vector3d target = survey.photos[i].cam_from_enu.Inverse() * ahead;
      EXPECT_LT((place + cam_from_map.transpose() * ahead - frame.MapFromEnu(target)).norm(), 0.03) << "the map's scale is 0.9996";
    }
    EXPECT_NEAR(shot.at("geometry").at("coordinates").at(0).get<double>(), 11.0, 0.001);
    EXPECT_NEAR(shot.at("geometry").at("coordinates").at(1).get<double>(), 47.0, 0.001);
    EXPECT_NEAR(shot.at("geometry").at("coordinates").at(2).get<double>(), 600.0 + centre.z(), 0.01);
  }
}

TEST(ImagesJson, HasARowPerPhoto) {
  std::vector<survey::PhotoTags> tags(2);
  tags[0].make = "DJI";
  tags[0].gps = geo::Geodetic{47.0, 11.0, std::nan("")};
  const nlohmann::json rows = base::ParseJson(base::JsonText(ImagesJson(PlainSurvey(), tags)));
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows.at(0).at("filename"), "a.jpg");
  EXPECT_EQ(rows.at(0).at("path"), "flight/a.jpg");
  EXPECT_EQ(rows.at(0).at("camera_make"), "DJI");
  EXPECT_EQ(rows.at(0).at("latitude"), 47.0);
  EXPECT_TRUE(rows.at(0).at("altitude").is_null());
  EXPECT_EQ(rows.at(0).at("width"), 4000);
  EXPECT_EQ(rows.at(2).at("filename"), "c.jpg");
  EXPECT_EQ(rows.at(2).at("has_pose"), false);
}

TEST(ClosingWarnings, SayWhatTheUserShouldKnow) {
  survey::Survey survey = PlainSurvey();
  survey.unregistered.clear();
  EXPECT_TRUE(ClosingWarnings(survey).empty());
  survey.unregistered = {"1.jpg", "2.jpg", "3.jpg", "4.jpg", "5.jpg", "6.jpg"};
  survey.georeferenced = false;
  const std::vector<std::string> warnings = ClosingWarnings(survey);
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_EQ(warnings[0].find("6 of 8 photos are not used: 1.jpg, 2.jpg, 3.jpg, 4.jpg, 5.jpg, ...; warnings"), 0U) << warnings[0];
  EXPECT_NE(warnings[1].find("geo.txt"), std::string::npos) << warnings[1];
}

survey::Survey WithControl() {
  survey::Survey survey = PlainSurvey();
  survey::ControlPointFit point;
  point.label = "7";
  point.given_in_enu = {12.0, 18.0, 0.0};
  point.error_m = {0.03, -0.04, 0.12};
  const Eigen::Vector2d seen = *survey.cameras[0].ImgFromCam(survey.photos[0].cam_from_enu * (point.given_in_enu + point.error_m));
  point.marks = {{.photo = "flight/a.jpg", .pixel = seen + Eigen::Vector2d(4.0, 3.0), .error_px = 5.0, .used = true},
                 {.photo = "gone.jpg", .pixel = {1.0, 1.0}, .error_px = std::nan(""), .used = false}};
  survey.control.placed = true;
  survey.control.points = {point, point};
  survey.control.points[1].label = "8";
  survey.control.points[1].use = survey::ControlUse::kCheck;
  survey.control.points[1].marks.clear();
  return survey;
}

TEST(ControlPointsJson, ShowsWherePointsAreAndWhereTheyShouldBe) {
  const survey::Survey survey = WithControl();
  const nlohmann::json points = base::ParseJson(base::JsonText(ControlPointsJson(survey, FrameOf(survey, geo::Vertical::kAsTagged))));
  ASSERT_EQ(points.at("features").size(), 2U);
  const nlohmann::json& first = points.at("features").at(0).at("properties");
  EXPECT_EQ(first.at("id"), "7");
  EXPECT_LT((VectorOf(first.at("error")) - Eigen::Vector3d(0.03, -0.04, 0.12)).norm(), 1e-12);
  ASSERT_EQ(first.at("observations").size(), 1U) << "a photo without a pose shows nothing";
  const nlohmann::json& mark = first.at("observations").at(0);
  EXPECT_EQ(mark.at("shot_id"), "a.jpg");
  const double dx = mark.at("annotated").at(0).get<double>() - mark.at("reprojected").at(0).get<double>();
  const double dy = mark.at("annotated").at(1).get<double>() - mark.at("reprojected").at(1).get<double>();
  EXPECT_NEAR(dx, 4.0 / 4000.0, 1e-9);
  EXPECT_NEAR(dy, 3.0 / 3000.0, 1e-9);
  const nlohmann::json& second = points.at("features").at(1).at("properties");
  EXPECT_EQ(second.at("id"), "CHK-8");
  EXPECT_FALSE(second.contains("observations")) << "WebODM opens the first one";
}

TEST(StatsJson, HasWhatWebOdmShows) {
  survey::Survey survey = WithControl();
  survey.fit.n_inliers = 2;
  survey.fit.rmse_m = 1.5;
  std::vector<survey::PhotoTags> tags(2);
  tags[0].capture_time_s = 1'600'000'000.0;
  tags[1].capture_time_s = 1'600'000'060.0;
  const nlohmann::json stats = base::ParseJson(
      base::JsonText(StatsJson({.survey = &survey, .tags = &tags, .seconds = 3700.0, .gsd_m = 0.021, .area_m2 = 1234.0, .cloud_points = 5000})));
  EXPECT_EQ(stats.at("point_cloud_statistics").at("dense"), true);
  EXPECT_EQ(stats.at("point_cloud_statistics").at("stats").at("statistic").at(0).at("count"), 5000);
  EXPECT_NEAR(stats.at("odm_processing_statistics").at("average_gsd").get<double>(), 2.1, 1e-12);
  EXPECT_EQ(stats.at("processing_statistics").at("area"), 1234.0);
  EXPECT_EQ(stats.at("processing_statistics").at("start_date"), "13/09/2020 at 12:26:40");
  EXPECT_EQ(stats.at("processing_statistics").at("end_date"), "13/09/2020 at 12:27:40");
  EXPECT_EQ(stats.at("reconstruction_statistics").at("has_gcp"), true);
  EXPECT_EQ(stats.at("reconstruction_statistics").at("initial_shots_count"), 3);
  EXPECT_NEAR(stats.at("gcp_errors").at("average_error").get<double>(), 0.13, 1e-12) << "check points do not count";
  const survey::Survey bare;
  const std::vector<survey::PhotoTags> none;
  const nlohmann::json empty = base::ParseJson(base::JsonText(StatsJson({.survey = &bare, .tags = &none})));
  EXPECT_EQ(empty.at("point_cloud_statistics").at("dense"), false);
  EXPECT_FALSE(empty.at("processing_statistics").contains("area"));
  EXPECT_FALSE(empty.contains("gcp_errors"));
}

}  // namespace
}  // namespace skyquilt::odm
