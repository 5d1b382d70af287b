#include "prepare/prepare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/image/image.h"
#include "tests/prepare/synthetic_flight.h"
#include "tests/support/error_of.h"
#include "tests/support/raw_tiff.h"

namespace skyquilt::prepare {
namespace {

namespace fs = std::filesystem;

class PrepareTest : public ::testing::Test {
 protected:
  void Write() { test::WriteFlight(flight_, folder_.path()); }
  survey::Survey Run() { return Prepare({folder_ / "images", folder_ / "sparse/0", folder_ / "out"}, options_, threads_); }
  void ExpectInMessage(const std::string& word) {
    const std::string message = InputErrorOf([&] { Run(); });
    EXPECT_NE(message.find(word), std::string::npos) << "message: " << message;
  }

  TemporaryFolder folder_;
  test::Flight flight_ = test::MakeFlight({47.0, 8.0, 400.0});
  PrepareOptions options_;
  base::ThreadPool threads_{2};
};

TEST_F(PrepareTest, TheFlightIsCheckedAndTheResultSaved) {
  for (test::FlightPhoto& photo : flight_.photos) {
    photo.tags.make = "DJI";
    photo.tags.model = "FC220";
  }
  // A longer lens, so that 4 m/s in 64 ms are more than a pixel of 0.05 m.
  flight_.model.cameras[1].params = {1000.0, 1000.0, 32.0, 24.0};
  Write();
  const survey::Survey survey = Run();
  EXPECT_EQ(survey.checks.camera_name, "DJI FC220");
  EXPECT_NEAR(survey.checks.speed_mps, 4.0, 0.5);
  EXPECT_NEAR(survey.checks.smear_px, survey.checks.speed_mps * 0.064 * 1000.0 / survey.MedianAgl(), 1e-9);
  EXPECT_LT(std::abs(survey.checks.dome_m), 1.0);
  EXPECT_TRUE(std::isnan(survey.checks.k1_sigma));
  const survey::Survey loaded = survey::LoadSurvey(folder_ / "out");
  EXPECT_EQ(loaded.checks.smear_px, survey.checks.smear_px);
  ASSERT_EQ(loaded.problems.size(), 1U);
  EXPECT_EQ(loaded.problems[0].code, "rolling_shutter");
}

TEST_F(PrepareTest, DamagedObservationsLeaveTheLensUnknown) {
  flight_.model.cameras[1] = {camera::CameraModel::kSimpleRadial, 64, 48, {60.0, 32.0, 24.0, 0.01}};
  Write();
  std::string images = base::ReadFile(folder_ / "sparse/0/images.txt");
  images.resize(images.find_last_not_of('\n'));
  base::WriteFileAtomically(folder_ / "sparse/0/images.txt", images + " x");
  const survey::Survey survey = Run();
  EXPECT_EQ(survey.checks.k1, 0.01);
  EXPECT_TRUE(std::isnan(survey.checks.k1_sigma));
}

TEST_F(PrepareTest, AGoodFlightIsPlacedOnEarthAndSaved) {
  Write();
  const survey::Survey survey = Run();
  ASSERT_EQ(survey.photos.size(), 20U);
  EXPECT_TRUE(survey.georeferenced);
  EXPECT_TRUE(survey.unregistered.empty());
  EXPECT_LT(survey.fit.rmse_m, 0.02);
  EXPECT_NEAR(survey.MedianAgl(), test::kFlightHeight_m, 3.0);
  EXPECT_TRUE(survey.photos[0].is_test && survey.photos[8].is_test && survey.photos[16].is_test);
  EXPECT_FALSE(survey.photos[1].is_test);
  EXPECT_EQ(*survey.photos[3].time_s, 15.0);
  EXPECT_NEAR(*survey.photos[3].exposure.time_s, 0.002, 1e-9);
  EXPECT_NEAR(*survey.photos[3].relative_altitude_m, test::kFlightHeight_m, 1e-9);
  // Nadir cameras look down in ENU too.
  EXPECT_NEAR((survey.photos[5].cam_from_enu.rotation.conjugate() * Eigen::Vector3d::UnitZ()).z(), -1.0, 1e-3);
  EXPECT_GT(survey.points.size(), 1000U);

  const survey::Survey loaded = survey::LoadSurvey(folder_ / "out");
  EXPECT_EQ(loaded.photos.size(), 20U);
  EXPECT_EQ(loaded.points.size(), survey.points.size());
  const nlohmann::json map = base::ParseJson(base::ReadFile(folder_ / "out/cameras.geojson"));
  EXPECT_EQ(map["features"].size(), 20U);
  EXPECT_NEAR(map["features"][0]["geometry"]["coordinates"][0].get<double>(), 8.0, 0.01);
  EXPECT_NEAR(map["features"][0]["geometry"]["coordinates"][1].get<double>(), 47.0, 0.01);
  const std::string table = base::ReadFile(folder_ / "out/geo_residuals.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 21);
}

TEST_F(PrepareTest, WithoutGpsItGoesOnInALocalFrame) {
  for (test::FlightPhoto& photo : flight_.photos) {
    photo.tags.gps.reset();
    photo.tags.absolute_altitude_m.reset();
  }
  Write();
  const survey::Survey survey = Run();
  EXPECT_FALSE(survey.georeferenced);
  EXPECT_EQ(survey.photos.size(), 20U);
  EXPECT_NEAR(survey.MedianAgl(), 40.0, 4.0);
  EXPECT_TRUE(std::isnan(survey.photos[0].gps_residual_m));
  EXPECT_FALSE(fs::exists(folder_ / "out/cameras.geojson"));
  EXPECT_FALSE(survey::LoadSurvey(folder_ / "out").georeferenced);
}

TEST_F(PrepareTest, AScaleBarGivesALocalFrameMetres) {
  for (test::FlightPhoto& photo : flight_.photos) {
    photo.tags.gps.reset();
    photo.tags.absolute_altitude_m.reset();
  }
  Write();
  // 0.07 units of the model are a metre.
  options_.scale_bars = "0;0;0,0.7;0;0,10|1;1;1,1;1;2.4,20";
  const survey::Survey survey = Run();
  EXPECT_FALSE(survey.georeferenced);
  EXPECT_NEAR(survey.MedianAgl(), test::kFlightHeight_m, 2.0);
  EXPECT_NEAR(survey.fit.scale, 1.0 / 0.07, 1e-6);
  EXPECT_EQ(survey.fit.scale_bars.size(), 2U);
  EXPECT_TRUE(survey.fit.accuracy.HasScale());
}

TEST_F(PrepareTest, AllPhotosAtOnePlaceAreNotGeoreferenced) {
  test::SetTags(flight_, [](size_t, const Eigen::Vector3d&) { return Eigen::Vector3d(1.0, 2.0, 50.0); });
  Write();
  const survey::Survey survey = Run();
  EXPECT_FALSE(survey.georeferenced);
  EXPECT_EQ(survey.photos.size(), 20U);
}

TEST_F(PrepareTest, ARequiredPlaceIsAnErrorWhereItIsOtherwiseAWarning) {
  test::SetTags(flight_, [](size_t, const Eigen::Vector3d&) { return Eigen::Vector3d(1.0, 2.0, 50.0); });
  Write();
  options_.require_georeference = true;
  const std::string message = InputErrorOf([&] { Run(); });
  for (const std::string& part : {std::string("all GPS tags are at one place"), (folder_ / "out/geo_residuals.csv").string(),
                                  std::string("leave out prepare.require_georeference")}) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
  EXPECT_TRUE(fs::exists(folder_ / "out/geo_residuals.csv"));
  EXPECT_FALSE(fs::exists(folder_ / "out/survey.json"));

  options_.require_georeference = false;
  const survey::Survey survey = Run();
  const survey::Survey loaded = survey::LoadSurvey(folder_ / "out");
  EXPECT_FALSE(loaded.georeferenced);
  ASSERT_FALSE(loaded.problems.empty());
  EXPECT_EQ(loaded.problems.front().code, "equal_tags");
  EXPECT_TRUE(loaded.problems.front().about_place);
  EXPECT_EQ(loaded.problems, survey.problems);
}

TEST_F(PrepareTest, AGoodFlightFulfilsARequiredPlace) {
  // A few wrong tags do not concern the place.
  test::SetTags(flight_,
                [](size_t i, const Eigen::Vector3d& centre) { return Eigen::Vector3d(centre + Eigen::Vector3d(i == 7 ? 80.0 : 0.0, 0.0, 0.0)); });
  Write();
  options_.require_georeference = true;
  const survey::Survey survey = Run();
  EXPECT_TRUE(survey.georeferenced);
  ASSERT_EQ(survey.problems.size(), 1U);
  EXPECT_EQ(survey.problems[0].code, "tags_disagree");
  EXPECT_TRUE(fs::exists(folder_ / "out/survey.json"));
}

TEST_F(PrepareTest, TagsWithoutAltitudeStillPlaceTheSurvey) {
  for (test::FlightPhoto& photo : flight_.photos) {
    photo.tags.gps->height_m = std::numeric_limits<double>::quiet_NaN();
    photo.tags.absolute_altitude_m.reset();
  }
  Write();
  const survey::Survey survey = Run();
  EXPECT_TRUE(survey.georeferenced);
  EXPECT_EQ(survey.origin.height_m, 0.0);                                                       // take-off
  EXPECT_NEAR(survey.photos[7].cam_from_enu.OriginInSource().z(), test::kFlightHeight_m, 5.0);  // RelativeAltitude
  EXPECT_TRUE(std::isnan(survey.fit.accuracy.vertical_m));
  ASSERT_FALSE(survey.problems.empty());
  EXPECT_EQ(survey.problems.front().code, "no_heights");
  for (const survey::Photo& photo : survey.photos) EXPECT_TRUE(std::isnan(photo.gps->height_m));
}

TEST_F(PrepareTest, UnusablePhotosAreLeftOutByName) {
  Write();
  std::ofstream(folder_ / "images/notes.jpg") << "text, not a photo";
  std::ofstream(folder_ / "images/empty.JPG").flush();
  const std::string whole = base::ReadFile(folder_ / "images/photo_04.jpg");
  std::ofstream(folder_ / "images/photo_04.jpg", std::ios::binary | std::ios::trunc) << whole.substr(0, whole.size() - 40);
  image::SaveJpeg(image::Image8(32, 32, 3, 90), folder_ / "images/photo_06.jpg", 90);
  const survey::Survey survey = Run();
  EXPECT_EQ(survey.photos.size(), 18U);
  EXPECT_EQ(survey.unregistered, (std::vector<std::string>{"empty.JPG", "notes.jpg", "photo_04.jpg", "photo_06.jpg"}));
}

TEST_F(PrepareTest, EmptyFoldersAndTextFilesHaveTheirOwnMessages) {
  Write();
  fs::remove_all(folder_ / "images");
  ExpectInMessage("no such folder");
  fs::create_directories(folder_ / "images");
  ExpectInMessage("has no photos");
  for (const char* name : {"a.jpg", "b.jpg"}) image::SaveJpeg(image::Image8(64, 48, 3, 90), folder_ / (std::string("images/") + name), 90);
  ExpectInMessage("has only 2 photos, at least 3 are needed. Add photos");
  for (const char* name : {"a.jpg", "b.jpg", "c.jpg", "d.jpg"}) std::ofstream(folder_ / (std::string("images/") + name)) << "text";
  ExpectInMessage("only 0 of 4 photos can be used");
}

TEST_F(PrepareTest, PhotosTheModelNamesButTheFolderLacksAreLeftOut) {
  Write();
  for (int i = 5; i < 20; ++i) fs::remove(folder_ / ("images/" + flight_.photos[static_cast<size_t>(i)].name));
  const survey::Survey survey = Run();
  EXPECT_EQ(survey.photos.size(), 5U);
  for (int i = 2; i < 5; ++i) fs::remove(folder_ / ("images/" + flight_.photos[static_cast<size_t>(i)].name));
  for (const char* name : {"x.jpg", "y.jpg", "z.jpg"}) image::SaveJpeg(image::Image8(64, 48, 3, 90), folder_ / (std::string("images/") + name), 90);
  ExpectInMessage("18 are not in");
}

TEST_F(PrepareTest, PhotosOfAnotherAspectThanTheModelAreRefusedTogether) {
  flight_.model.cameras[1] = flight_.model.cameras[1].Resized(128, 80);
  Write();
  ExpectInMessage("is 64x48, its camera in the model 128x80");
}

TEST_F(PrepareTest, AModelOfLargerPhotosIsScaled) {
  const camera::Camera right = flight_.model.cameras[1];
  flight_.model.cameras[1] = right.Resized(128, 96);
  Write();
  const survey::Survey survey = Run();
  EXPECT_EQ(survey.photos.size(), 20U);
  EXPECT_EQ(survey.cameras[0].width, 64);
  EXPECT_EQ(survey.cameras[0].params, right.params);
  EXPECT_EQ(survey.photo_root, fs::absolute(folder_ / "images"));
}

TEST_F(PrepareTest, PhotosOfSixteenBitsAreReadAsPicturesOfEight) {
  Write();
  for (const test::FlightPhoto& photo : flight_.photos) {
    // 12 bits; the file's content counts, not its name.
    std::vector<uint16_t> values(size_t{64} * 48 * 3, 1024);
    values[0] = 4095;
    base::WriteFileAtomically(folder_ / ("images/" + photo.name), test::TiffBytes({.width = 64,
                                                                                   .height = 48,
                                                                                   .bands = 3,
                                                                                   .bits = 16,
                                                                                   .floating = false,
                                                                                   .photometric = 2,
                                                                                   .extra = {},
                                                                                   .pixels = test::LittleEndian<uint16_t>(values)}));
  }
  const survey::Survey survey = Run();
  EXPECT_EQ(survey.photo_root, fs::absolute(folder_ / "out/photos_8bit"));
  const image::Image8 picture = image::LoadRgb8(survey.photo_root / survey.photos[0].name);
  EXPECT_EQ(picture.data[0], 255);
  EXPECT_EQ(picture.data[3], 64);
}

TEST_F(PrepareTest, NanInAPoseNamesThePhoto) {
  flight_.model.images[7].cam_from_world.translation.x() = std::numeric_limits<double>::quiet_NaN();
  Write();
  ExpectInMessage("photo_07.jpg");
}

TEST_F(PrepareTest, PhotosInSubFoldersAreFoundByTheModelsNames) {
  Write();
  fs::create_directories(folder_ / "images/100MEDIA");
  for (size_t i = 0; i < 10; ++i) fs::rename(folder_ / ("images/" + flight_.photos[i].name), folder_ / ("images/100MEDIA/" + flight_.photos[i].name));
  const survey::Survey survey = Run();
  ASSERT_EQ(survey.photos.size(), 20U);
  EXPECT_EQ(survey.photos[0].name, "100MEDIA/photo_00.jpg");
  EXPECT_LT(survey.fit.rmse_m, 0.02);
}

TEST_F(PrepareTest, MasksFollowColmapsNames) {
  Write();
  fs::create_directories(folder_ / "masks");
  options_.masks = (folder_ / "masks").string();
  ExpectInMessage("no mask for any photo");
  image::SavePng(image::Image8(64, 48, 1, 255), folder_ / "masks/photo_02.jpg.png");
  const survey::Survey survey = Run();
  EXPECT_EQ(survey.photos[2].mask, (folder_ / "masks/photo_02.jpg.png").string());
  EXPECT_TRUE(survey.photos[3].mask.empty());
  image::SavePng(image::Image8(60, 48, 1, 255), folder_ / "masks/photo_03.jpg.png");
  ExpectInMessage("photo_03.jpg.png");
}

TEST_F(PrepareTest, MasksBesidePhotosAreUsedAndListed) {
  Write();
  image::SavePng(image::Image8(32, 24, 1, 255), folder_ / "images/photo_02_mask.png");
  base::WriteFileAtomically(folder_ / "images/photo_03.DNG", "raw");
  base::WriteFileAtomically(folder_ / "images/photo_99.jpg", "damaged");
  fs::create_directories(folder_ / "images/earlier/products");
  image::SavePng(image::Image8(64, 48, 3, 255), folder_ / "images/earlier/products/ortho.png");
  base::WriteFileAtomically(folder_ / "images/earlier/blocks.geojson", "{}");
  const survey::Survey survey = Run();
  ASSERT_EQ(survey.photos.size(), 20U);
  EXPECT_EQ(survey.photos[2].mask, (folder_ / "out/masks/photo_02.jpg.png").string());
  EXPECT_TRUE(survey.photos[3].mask.empty());
  const std::string table = base::ReadFile(folder_ / "out/input.csv");
  for (const char* line : {"photo_02.jpg,yes,photo,,photo_02,photo_02_mask.png,64,48\n", "photo_02_mask.png,no,mask,", "photo_03.DNG,no,other form,",
                           "photo_99.jpg,no,damaged,", "earlier/,no,other project,\"a Skyquilt project, with 1 picture\","}) {
    EXPECT_NE(table.find(line), std::string::npos) << line << " is not in\n" << table;
  }
  EXPECT_EQ(survey.unregistered, (std::vector<std::string>{"photo_99.jpg"}));
}

TEST_F(PrepareTest, PatternsChooseThePhotos) {
  Write();
  options_.photos = "photo_0?.JPG, photo_1[.jpg, photo_1*";
  EXPECT_EQ(Run().photos.size(), 20U);
  options_.photos = "photo_0*";
  EXPECT_EQ(Run().photos.size(), 10U);
  options_.photos = "*.webp";
  ExpectInMessage("for instance photo_00.jpg");
  options_.photos = ",";
  EXPECT_THROW(Run(), base::UsageError);
}

TEST_F(PrepareTest, ASimulatedSurveyKeepsItsFrameAndItsTruth) {
  // The model of a simulated survey is in ENU.
  for (size_t i = 0; i < 20; ++i) {
    geo::Rigid3d& pose = flight_.model.images[i].cam_from_world;
    pose.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
    pose.translation = -(pose.rotation * flight_.photos[i].centre_in_enu);
  }
  for (survey::ColmapPoint& point : flight_.model.points) {
    const geo::Similarity3d& a = flight_.model_from_enu;
    point.x_in_world = a.rotation.conjugate() * (point.x_in_world - a.translation) / a.scale;
  }
  test::SetTags(flight_, [](size_t, const Eigen::Vector3d& centre) { return Eigen::Vector3d(centre + Eigen::Vector3d(1.0, 0.0, 0.0)); });
  Write();
  fs::create_directories(folder_ / "truth/depth");
  fs::create_directories(folder_ / "truth/classes");
  fs::create_directories(folder_ / "truth/masks");
  image::SavePng(image::Image8(64, 48, 1, 255), folder_ / "truth/masks/photo_02.jpg.png");
  base::WriteFileAtomically(folder_ / "truth/orthophoto.tif", "");
  base::WriteFileAtomically(folder_ / "simulate.json", R"({"origin":{"latitude_deg":47.0,"longitude_deg":8.0,"height_m":400.0},"exact_frame":true})");
  const survey::Survey survey = Prepare({folder_.path(), {}, folder_ / "out"}, options_, threads_);
  EXPECT_EQ(survey.origin.latitude_deg, 47.0);
  EXPECT_EQ(survey.origin.height_m, 400.0);
  EXPECT_EQ(survey.fit.scale, 1.0);
  EXPECT_NEAR(survey.fit.rmse_m, 1.0, 0.01);
  EXPECT_LT((survey.photos[4].cam_from_enu.OriginInSource() - flight_.photos[4].centre_in_enu).norm(), 1e-9);
  ASSERT_TRUE(survey.truth);
  EXPECT_EQ(survey.truth->depth_folder, folder_ / "truth/depth");
  EXPECT_EQ(survey.truth->classes_folder, folder_ / "truth/classes");
  EXPECT_EQ(survey.truth->masks_folder, folder_ / "truth/masks");
  EXPECT_EQ(survey.truth->ortho_tif, folder_ / "truth/orthophoto.tif");
  EXPECT_TRUE(survey.truth->edge_targets_json.empty());
  EXPECT_TRUE(survey.truth->normals_folder.empty());  // a survey made before there were any
  EXPECT_TRUE(survey.photos[2].mask.empty());
  EXPECT_EQ(survey.photo_root, folder_ / "images");
}

TEST_F(PrepareTest, WrongOptionsAreUsageErrors) {
  Write();
  options_.ransac_threshold_m = 0.0;
  EXPECT_THROW(Run(), base::UsageError);
  options_ = {};
  options_.camera_model = "PINHOLEE";
  EXPECT_THROW(Run(), base::UsageError);
  options_ = {};
  options_.flight_offsets = "maybe";
  EXPECT_THROW(Run(), base::UsageError);
  options_ = {};
  options_.up = "north";
  EXPECT_THROW(Run(), base::UsageError);
  options_ = {};
  options_.scale_bars = "A,B,2.5";  // without a file of marks
  EXPECT_THROW(Run(), base::UsageError);
}

}  // namespace
}  // namespace skyquilt::prepare
