#include "core/survey/survey.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/survey/geo_fit.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::survey {
namespace {

using SurveyTest = InTemporaryFolder;

Survey SmallSurvey() {
  Survey survey;
  survey.origin = {46.84271234567, -91.99412345678, 158.5};
  survey.georeferenced = true;
  survey.height_reference = geo::HeightReference::kEgm96;
  survey.photo_root = "/some/where";
  survey.cameras.push_back({camera::CameraModel::kPinhole, 100, 80, {90.0, 91.0, 50.0, 40.0}});
  for (int i = 0; i < 3; ++i) {
    Photo photo;
    photo.name = "p" + std::to_string(i) + ".jpg";
    photo.cam_from_enu.rotation = Eigen::Quaterniond(0.3, 0.4 + i, -0.1, 0.7).normalized();
    photo.cam_from_enu.translation = Eigen::Vector3d(1.0 / 3.0, 1e5 + i, -7.0);
    photo.agl_m = i == 2 ? std::numeric_limits<double>::quiet_NaN() : 40.0 + 10.0 * i;
    photo.gps_residual_m = std::numeric_limits<double>::quiet_NaN();
    if (i == 1) {
      photo.gps = geo::Geodetic{46.8, -91.9, 198.0};
      photo.relative_altitude_m = 39.8;
      photo.time_s = 12.25;
      photo.exposure = {1.0 / 546.0, 2.8, 100.0};
      photo.gps_residual_m = 0.123456789;
      photo.gps_inlier = true;
      photo.flight = 1;
      photo.is_test = true;
      photo.mask = "/some/where/masks/p1.jpg.png";
    }
    survey.photos.push_back(photo);
  }
  survey.unregistered = {"lost.jpg"};
  for (int i = 0; i < 5; ++i) survey.points.push_back({Eigen::Vector3d(0.1 * i, 1.0 / 7.0, -1e4), {1, 2, 250}, 0.25F, 3 + i});
  for (int i = 0; i < 5; ++i) survey.tracks.Add({0, i % 3});
  for (int i = 0; i < 2; ++i) survey.kept_points.push_back({Eigen::Vector3d(7.0, 1.0 / 3.0, i), {3, 4, 5}, 0.75F, 2});
  for (int i = 0; i < 2; ++i) survey.kept_tracks.Add({1, 2});
  survey.photos[1].gps_correction_m = Eigen::Vector3d(0.1, -3.0, 1.0 / 3.0);
  survey.fit = {.n_matches = 3,
                .n_inliers = 2,
                .rmse_m = 0.6,
                .rmse_horizontal_m = 0.5,
                .rmse_vertical_m = 0.3,
                .scale = 12.5,
                .tag_lag_s = 0.27,
                .tag_lag_sigma_s = 0.02,
                .flight_vertical_offset_m = {0.0, 15.5},
                .flight_vertical_drift_m = {1.0, -100.0},
                .accuracy = {.scale_percent = 0.2, .tilt_deg = 0.3, .yaw_deg = 0.1, .horizontal_m = 1.5},
                .gravity = {{.kind = "gimbal", .n = 3, .lean_east_deg = 0.1, .lean_north_deg = -0.2, .sigma_deg = 0.25, .weight = 0.9}},
                .tags_alone_tilt_deg = 19.0,
                .scale_bars = {{"left", "0;0;1", 2.5, 1.0 / 3.0}},
                .adjusted_to_tags = true};
  survey.checks = {.speed_mps = 8.0, .speed_source = "speed tags", .camera_name = "DJI FC300S", .smear_px = 2.0, .k1 = -0.02};
  survey.problems = {{.code = "tags_disagree", .finding = "half of the tags disagree", .advice = "look", .about_place = true}};
  survey.truth = Truth{"/t/depth",       "/t/buildings.json", "/t/exposure.json",  "/t/normals",          "/t/classes",
                       "/t/surface.ply", "/t/masks",          "/t/orthophoto.tif", "/t/edge_targets.json"};
  return survey;
}

// Replaces a value in survey.json and expects the load to fail with `word` in its message.
template <typename Edit>
void ExpectRefused(const std::string& word, const Edit& edit) {
  const TemporaryFolder folder;
  SaveSurvey(SmallSurvey(), folder.path());
  nlohmann::json json = base::ParseJson(base::ReadFile(folder / "survey.json"));
  edit(json);
  base::WriteFileAtomically(folder / "survey.json", base::JsonText(json));
  const std::string error = InputErrorOf([&] { LoadSurvey(folder.path()); });
  EXPECT_NE(error.find(word), std::string::npos) << word << ": " << error;
}

TEST_F(SurveyTest, SavingAndLoadingKeepsEveryBit) {
  const Survey before = SmallSurvey();
  SaveSurvey(before, folder_.path());
  const Survey after = LoadSurvey(folder_.path());
  EXPECT_EQ(after.origin.latitude_deg, before.origin.latitude_deg);
  EXPECT_EQ(after.origin.height_m, before.origin.height_m);
  EXPECT_EQ(after.georeferenced, true);
  EXPECT_EQ(after.photo_root, before.photo_root);
  EXPECT_EQ(after.unregistered, before.unregistered);
  EXPECT_EQ(after.problems, before.problems);
  EXPECT_EQ(after.cameras[0].params, before.cameras[0].params);
  ASSERT_EQ(after.photos.size(), before.photos.size());
  for (size_t i = 0; i < before.photos.size(); ++i) {
    EXPECT_EQ(after.photos[i].cam_from_enu.rotation.coeffs(), before.photos[i].cam_from_enu.rotation.coeffs());
    EXPECT_EQ(after.photos[i].cam_from_enu.translation, before.photos[i].cam_from_enu.translation);
    EXPECT_EQ(after.photos[i].gps.has_value(), before.photos[i].gps.has_value());
    EXPECT_EQ(after.photos[i].time_s, before.photos[i].time_s);
    EXPECT_EQ(after.photos[i].exposure.time_s, before.photos[i].exposure.time_s);
    EXPECT_EQ(after.photos[i].mask, before.photos[i].mask);
    EXPECT_EQ(after.photos[i].is_test, before.photos[i].is_test);
    EXPECT_EQ(after.photos[i].flight, before.photos[i].flight);
    EXPECT_EQ(std::isnan(after.photos[i].agl_m), std::isnan(before.photos[i].agl_m));
  }
  EXPECT_EQ(after.photos[1].gps_residual_m, before.photos[1].gps_residual_m);
  EXPECT_TRUE(std::isnan(after.photos[0].gps_residual_m));
  ASSERT_EQ(after.points.size(), before.points.size());
  EXPECT_EQ(after.points[3].x_in_enu, before.points[3].x_in_enu);
  EXPECT_EQ(after.points[3].rgb, before.points[3].rgb);
  EXPECT_EQ(after.points[3].track_length, 6);
  ASSERT_EQ(after.kept_points.size(), 2U);
  EXPECT_EQ(after.kept_points[1].x_in_enu, before.kept_points[1].x_in_enu);
  EXPECT_EQ(after.kept_points[1].error_px, 0.75F);
  EXPECT_EQ(after.tracks, before.tracks);
  EXPECT_EQ(after.kept_tracks, before.kept_tracks);
  EXPECT_EQ(ToJson(after.fit), ToJson(before.fit));
  EXPECT_EQ(ToJson(after.checks), ToJson(before.checks));
  EXPECT_EQ(after.photos[1].gps_correction_m, before.photos[1].gps_correction_m);
  EXPECT_EQ(after.truth->depth_folder, before.truth->depth_folder);
  EXPECT_EQ(after.truth->normals_folder, before.truth->normals_folder);
  EXPECT_EQ(after.truth->classes_folder, before.truth->classes_folder);
  EXPECT_EQ(after.truth->surface_ply, before.truth->surface_ply);
  EXPECT_EQ(after.truth->masks_folder, before.truth->masks_folder);
  EXPECT_EQ(after.truth->ortho_tif, before.truth->ortho_tif);
  EXPECT_EQ(after.truth->edge_targets_json, before.truth->edge_targets_json);
}

// As earlier versions wrote it.
TEST_F(SurveyTest, KeepsWhatItsHeightsAreAbove) {
  SaveSurvey(SmallSurvey(), folder_.path());
  EXPECT_EQ(LoadSurvey(folder_.path()).height_reference, geo::HeightReference::kEgm96);
  nlohmann::json json = base::ParseJson(base::ReadFile(folder_ / "survey.json"));
  ASSERT_EQ(json.erase("height_reference"), 1U);
  base::WriteFileAtomically(folder_ / "survey.json", base::JsonText(json));
  EXPECT_EQ(LoadSurvey(folder_.path()).height_reference, geo::HeightReference::kUnknown) << "of an older program";
}

TEST_F(SurveyTest, KeepsWhetherHeldOutPhotosWereResected) {
  Survey survey = SmallSurvey();
  survey.resected_holdout = true;
  SaveSurvey(survey, folder_.path());
  EXPECT_TRUE(LoadSurvey(folder_.path()).resected_holdout);
  nlohmann::json json = base::ParseJson(base::ReadFile(folder_ / "survey.json"));
  EXPECT_EQ(json.at("holdout_poses"), "resected");
  ASSERT_EQ(json.erase("holdout_poses"), 1U);
  base::WriteFileAtomically(folder_ / "survey.json", base::JsonText(json));
  EXPECT_FALSE(LoadSurvey(folder_.path()).resected_holdout) << "of an older program";
  ExpectRefused("'guessed'", [](nlohmann::json& edited) { edited["holdout_poses"] = "guessed"; });
}

TEST_F(SurveyTest, ATruthWithoutNormalsAndClassesIsLoaded) {
  SaveSurvey(SmallSurvey(), folder_.path());
  nlohmann::json json = base::ParseJson(base::ReadFile(folder_ / "survey.json"));
  for (const char* key : {"normals_folder", "classes_folder", "surface_ply", "masks_folder", "ortho_tif", "edge_targets_json"})
    ASSERT_EQ(json["truth"].erase(key), 1U) << key;
  base::WriteFileAtomically(folder_ / "survey.json", base::JsonText(json));
  const Survey survey = LoadSurvey(folder_.path());
  ASSERT_TRUE(survey.truth);
  EXPECT_EQ(survey.truth->depth_folder, "/t/depth");
  EXPECT_TRUE(survey.truth->normals_folder.empty());
  EXPECT_TRUE(survey.truth->classes_folder.empty());
  EXPECT_TRUE(survey.truth->surface_ply.empty());
  EXPECT_TRUE(survey.truth->masks_folder.empty());
  EXPECT_TRUE(survey.truth->ortho_tif.empty());
  EXPECT_TRUE(survey.truth->edge_targets_json.empty());
}

TEST_F(SurveyTest, MedianAglIgnoresUnknownOnes) {
  EXPECT_DOUBLE_EQ(SmallSurvey().MedianAgl(), 45.0);
  EXPECT_TRUE(std::isnan(Survey().MedianAgl()));
}

TEST_F(SurveyTest, AnEmptySurveyIsSavedAndLoaded) {
  SaveSurvey({}, folder_.path());
  const Survey survey = LoadSurvey(folder_.path());
  EXPECT_TRUE(survey.photos.empty());
  EXPECT_TRUE(survey.points.empty());
  EXPECT_FALSE(survey.truth);
}

TEST_F(SurveyTest, OfAnOlderProgramHasNeitherKeptPointsNorTracks) {
  SaveSurvey(SmallSurvey(), folder_.path());
  nlohmann::json json = base::ParseJson(base::ReadFile(folder_ / "survey.json"));
  json.erase("n_kept_points");
  json.erase("n_observations");
  base::WriteFileAtomically(folder_ / "survey.json", base::JsonText(json));
  std::filesystem::remove(folder_ / "kept_points.ply");
  std::filesystem::remove(folder_ / "tracks.bin");
  const Survey survey = LoadSurvey(folder_.path());
  EXPECT_EQ(survey.points.size(), 5U);
  EXPECT_TRUE(survey.kept_points.empty());
  EXPECT_TRUE(survey.tracks.Empty());
  EXPECT_FALSE(survey.HasTracks());
}

TEST_F(SurveyTest, SavedWithoutKeptPointsOrTracksLeavesNoFilesOfThem) {
  Survey survey = SmallSurvey();
  SaveSurvey(survey, folder_.path());
  survey.kept_points.clear();
  survey.tracks = survey.kept_tracks = {};
  SaveSurvey(survey, folder_.path());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "kept_points.ply"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "tracks.bin"));
  EXPECT_FALSE(LoadSurvey(folder_.path()).HasTracks());
}

TEST_F(SurveyTest, DamagedDescriptionsAreRefusedWithTheReason) {
  ExpectRefused("p1.jpg", [](nlohmann::json& json) { json["photos"][1]["translation_m"][0] = nullptr; });
  ExpectRefused("p2.jpg", [](nlohmann::json& json) { json["photos"][2]["rotation_wxyz"] = {1.0, 1.0, 0.0, 0.0}; });
  ExpectRefused("camera 4", [](nlohmann::json& json) { json["photos"][0]["camera"] = 4; });
  ExpectRefused("twice", [](nlohmann::json& json) { json["photos"][0]["name"] = "p1.jpg"; });
  ExpectRefused("origin", [](nlohmann::json& json) { json["origin"]["latitude_deg"] = 91.0; });
  ExpectRefused("sea level", [](nlohmann::json& json) { json["height_reference"] = "sea level"; });
  ExpectRefused("another version", [](nlohmann::json& json) { json["version"] = 99; });
  ExpectRefused("damaged", [](nlohmann::json& json) { json.erase("fit"); });
  ExpectRefused("survey.json says", [](nlohmann::json& json) { json["n_points"] = 6; });
  ExpectRefused("kept_points.ply", [](nlohmann::json& json) { json["n_kept_points"] = 3; });
  ExpectRefused("tracks.bin", [](nlohmann::json& json) { json["n_observations"] = 3; });
  ExpectRefused("tracks.bin", [](nlohmann::json& json) { json["photos"].erase(2); });
}

TEST_F(SurveyTest, DamagedPointFilesAreRefused) {
  EXPECT_THROW(LoadSurvey(folder_.path()), base::InputError);
  SaveSurvey(SmallSurvey(), folder_.path());
  for (const char* name : {"points.ply", "kept_points.ply", "tracks.bin"}) {
    const std::string whole = base::ReadFile(folder_ / name);
    for (const size_t length : {size_t{0}, size_t{10}, whole.size() / 2, whole.size() - 1}) {
      std::ofstream(folder_ / name, std::ios::binary | std::ios::trunc) << whole.substr(0, length);
      EXPECT_THROW(LoadSurvey(folder_.path()), base::InputError) << name << " cut to " << length;
    }
    std::filesystem::remove(folder_ / name);
    EXPECT_THROW(LoadSurvey(folder_.path()), base::InputError) << "without " << name;
    base::WriteFileAtomically(folder_ / name, whole);
    EXPECT_NO_THROW(LoadSurvey(folder_.path()));
  }
}

}  // namespace
}  // namespace skyquilt::survey
