#include "prepare/poses/colmap_run.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/geo/enu_frame.h"
#include "core/survey/colmap_database.h"
#include "core/survey/colmap_model.h"
#include "tests/prepare/poses/fake_colmap.h"
#include "tests/prepare/poses/made_photos.h"
#include "tests/support/error_of.h"
#include "tests/support/made_database.h"

namespace skyquilt::prepare::poses {
namespace {

TEST(ColmapProgress, IsReadFromItsOutput) {
  EXPECT_DOUBLE_EQ(ColmapLineProgress("Processed file [3/18]", 18), 3.0 / 18.0);
  EXPECT_DOUBLE_EQ(ColmapLineProgress("Matching block [1/2, 1/2] in 4.4s", 18), 0.0);
  EXPECT_DOUBLE_EQ(ColmapLineProgress("Matching block [2/2, 2/2]", 18), 0.75);
  EXPECT_DOUBLE_EQ(ColmapLineProgress("Matching image [84/167] in 0.2s", 167), 83.0 / 167.0);
  EXPECT_DOUBLE_EQ(ColmapLineProgress("Registering image #12 (7)", 18), 6.0 / 18.0);
  EXPECT_LT(ColmapLineProgress("  Name:            DJI_0018.JPG", 18), 0.0);
  EXPECT_LT(ColmapLineProgress("Registering image #", 18), 0.0);
}

using test::FakeColmap;

class ColmapAlone : public FakeColmap {
 protected:
  void SetUp() override {
    FakeColmap::SetUp();
    options_.fast = false;
    test::MadeDatabase(folder_ / "made.db").Run("PRAGMA journal_mode = DELETE");  // one file, to copy
  }
  void WriteFake(const std::string& mapper) {
    WriteProgram("#!/bin/sh\necho $1 >> " + (folder_ / "calls").string() + "\necho \"$@\" >> " + (folder_ / "arguments").string() +
                 "\nwhile [ $# -gt 0 ]; do case $1 in --output_path) out=$2;; --database_path) [ -e \"$2\" ] || cp " +
                 (folder_ / "made.db").string() +
                 " \"$2\";; mapper) m=1;; esac; shift; done\n"
                 "if [ -n \"$m\" ]; then " +
                 mapper + "; fi\n");
  }
};

TEST_F(ColmapAlone, FinishedStepsAreSkippedAndFailuresNameTheLog) {
  WriteFake("echo no good initial pair; exit 1");
  const std::string error = InputErrorOf([&] { Find(); });
  EXPECT_NE(error.find("colmap.log"), std::string::npos) << error;
  EXPECT_NE(error.find("no good initial pair"), std::string::npos) << error;
  WriteFake("exit 0");
  EXPECT_THROW(Find(), base::InputError);  // succeeded, but wrote no model
  EXPECT_EQ(Calls(), "feature_extractor\nexhaustive_matcher\nmapper\nmapper\n");

  options_.max_features = 500;
  EXPECT_THROW(Find(), base::InputError);
  EXPECT_EQ(Calls(), "feature_extractor\nexhaustive_matcher\nmapper\n");

  options_.colmap = "no-such-colmap";
  EXPECT_THROW(Find(), base::InputError);
}

// COLMAP's own settings stay as they are.
TEST_F(ColmapAlone, HasItsOwnSettings) {
  photos_ = test::GridPhotos(8, 8, 20.0, 25.0, {47.0, 8.0, 400.0});
  test::MadeDatabase made(folder_ / "made.db");
  made.Run("PRAGMA journal_mode = DELETE");
  for (uint32_t i = 0; i < photos_.size(); ++i) made.AddImage(i + 1, photos_[i].name);
  made.Run("UPDATE images SET prior_tx = 47, prior_ty = 8");
  WriteFake("exit 0");
  EXPECT_THROW(Find(), base::InputError);
  EXPECT_EQ(Calls(), "feature_extractor\nfeature_extractor\nspatial_matcher\nmapper\n");
  const std::string arguments = base::ReadFile(folder_ / "arguments");
  EXPECT_EQ(arguments.find("first_octave"), std::string::npos) << arguments;
  EXPECT_EQ(arguments.find("ba_global"), std::string::npos) << arguments;
  EXPECT_NE(arguments.find("--SiftExtraction.max_num_features 8192"), std::string::npos) << arguments;
  EXPECT_NE(arguments.find("--SpatialMatching.max_num_neighbors 24"), std::string::npos) << arguments;

  // COLMAP does not know positions from other files than the photos.
  made.Run("UPDATE images SET prior_tx = NULL, prior_ty = NULL");
  options_.seed = 2;
  Calls();
  EXPECT_THROW(Find(), base::InputError);
  EXPECT_EQ(Calls(), "feature_extractor\nfeature_extractor\nexhaustive_matcher\nmapper\n");
}

class FastWay : public FakeColmap {
 protected:
  void SetUp() override {
    FakeColmap::SetUp();
    WriteProgram(test::kFastProgram);
    base::Random random(2);
    std::vector<std::array<uint8_t, 128>> features;
    for (int i = 0; i < 30; ++i) features.push_back(test::RandomDescriptor(random));
    for (input::PhotoFile& photo : photos_) photo.name = "flight 1/" + photo.name;
    test::MadeDatabase made(folder_ / "made.db");
    made.Run("PRAGMA journal_mode = DELETE");  // one file, to copy
    for (uint32_t i = 0; i < photos_.size(); ++i) {
      std::vector<uint8_t> rows;
      for (const auto& feature : features) test::AddRow(rows, test::SeenAgain(feature, 5, random));
      made.AddImage(i + 1, photos_[i].name);
      made.AddDescriptors(i + 1, rows);
    }
  }
  // The tags of all photos say 60 px.
  void TagFocal() {
    test::MadeDatabase made(folder_ / "made.db");
    made.Run(
        "PRAGMA journal_mode = DELETE;"
        "INSERT INTO cameras VALUES(1, 1, 64, 48, X'0000000000004e400000000000004e4000000000000040400000000000003840', 1)");
  }
  std::string HeldModel() const { return (job_.folder / "more_pairs" / "sparse_held_focal" / "0").string(); }
};

// All photos have few features, so they are searched twice.
constexpr const char* kFastCalls = "feature_extractor\nfeature_extractor\nmatches_importer\nmapper\n";
constexpr const char* kSecondCalls = "feature_extractor again\nmatches_importer again\nmapper again\n";

TEST_F(FastWay, MatchesAllPairsOfASmallSurveyAndSkipsFinishedSteps) {
  SetNumber("first", 18);
  EXPECT_EQ(Find(), FirstModel());
  EXPECT_EQ(Calls(), kFastCalls);
  EXPECT_EQ(Find(), FirstModel());
  EXPECT_EQ(Calls(), "");
  const survey::ColmapDatabase database(job_.Database());
  EXPECT_EQ(database.ReadTwoViewMatches().size(), 190U);
  EXPECT_EQ(database.ReadImages()[0].name, photos_[0].name);
  EXPECT_FALSE(std::filesystem::exists(job_.folder / "matches"));
  const std::string arguments = base::ReadFile(folder_ / "arguments");
  for (const char* wanted : {"--SiftExtraction.first_octave 0", "--SiftExtraction.max_num_features 4096", "--match_type pairs",
                             "--Mapper.ba_global_function_tolerance 1e-06", "--Mapper.ba_global_images_ratio 1.3"}) {
    EXPECT_NE(arguments.find(wanted), std::string::npos) << wanted << " in " << arguments;
  }
}

TEST_F(FastWay, OnlyWhatDependsOnAChangeIsRepeated) {
  SetNumber("first", 20);
  Find();
  Calls();
  // Another position changes the choice of pairs, not the features.
  photos_[3].tags.gps->latitude_deg += 1e-4;
  Find();
  EXPECT_EQ(Calls(), "matches_importer\nmapper\n");
  options_.max_features = 300;
  Find();
  EXPECT_EQ(Calls(), kFastCalls);
}

TEST_F(FastWay, OnlyPhotosWithFewFeaturesAreSearchedAgain) {
  const size_t enough = FastColmapFlags().few_features;
  {
    test::MadeDatabase made(folder_ / "made.db");
    made.Run("PRAGMA journal_mode = DELETE; DELETE FROM descriptors WHERE image_id = 3");
    std::vector<uint8_t> rows(128 * enough, 11);
    made.AddDescriptors(3, rows);
  }
  SetNumber("first", 20);
  Find();
  const std::string names = base::ReadFile(folder_ / "searched_again");
  EXPECT_EQ(std::count(names.begin(), names.end(), '\n'), 19);
  EXPECT_EQ(names.find(photos_[2].name), std::string::npos) << names;
  const std::string arguments = base::ReadFile(folder_ / "arguments");
  EXPECT_NE(arguments.find("--ImageReader.existing_camera_id 1"), std::string::npos) << arguments;
  // A photo that has as many features as it may keep has enough.
  Calls();
  options_.max_features = 30;
  Find();
  EXPECT_EQ(Calls(), "feature_extractor\nmatches_importer\nmapper\n");
}

TEST_F(FastWay, PhotosThatColmapCannotReadAreLeftOut) {
  test::MadeDatabase(folder_ / "made.db").Run("PRAGMA journal_mode = DELETE; DELETE FROM images WHERE image_id = 3");
  SetNumber("first", 19);
  EXPECT_EQ(Find(), FirstModel());
  const survey::ColmapDatabase database(job_.Database());
  EXPECT_EQ(database.ReadImages().size(), 19U);
  EXPECT_EQ(database.ReadTwoViewMatches().size(), 171U);
}

// More pairs and features would not help, and take long.
TEST_F(FastWay, DoesNotTryAgainWhenTheMapperIsKilled) {
  SetNumber("kill_mapper", 1);
  EXPECT_NE(InputErrorOf([&] { Find(); }).find("mapper failed with status 137"), std::string::npos);
  EXPECT_EQ(Calls(), kFastCalls);
}

// The names are plain while pairs are verified; a kill there leaves them so until the next run.
TEST_F(FastWay, GoesOnAfterAKillWhileVerifying) {
  SetNumber("first", 20);
  SetNumber("fail_verifying", 1);
  EXPECT_NE(InputErrorOf([&] { Find(); }).find("matches_importer failed"), std::string::npos);
  SetNumber("fail_verifying", 0);
  Calls();
  Find();
  EXPECT_EQ(Calls(), "matches_importer\nmapper\n");
  EXPECT_EQ(survey::ColmapDatabase(job_.Database()).ReadImages()[4].name, photos_[4].name);
}

TEST_F(FastWay, TriesMorePairsWhenPhotosAreMissing) {
  SetNumber("first", 17);
  SetNumber("again", 19);
  EXPECT_EQ(Find(), SecondModel());
  EXPECT_EQ(Calls(), std::string(kFastCalls) + kSecondCalls);
  EXPECT_EQ(Find(), SecondModel());
  EXPECT_EQ(Calls(), "");
  const std::string arguments = base::ReadFile(folder_ / "arguments");
  EXPECT_NE(arguments.find("--SiftExtraction.max_num_features 8192"), std::string::npos) << arguments;
}

// Two parts of ten photos, 300 m apart, each in a frame of its own.
TEST_F(FastWay, PartsThatTheMapperDoesNotConnectArePlacedByTheirTags) {
  for (size_t i = 10; i < 20; ++i) photos_[i].tags.gps->latitude_deg += 300.0 / 111e3;
  const geo::EnuFrame frame(*photos_[0].tags.gps);
  for (uint32_t part = 0; part < 2; ++part) {
    const geo::Similarity3d own{0.1 + part, Eigen::Quaterniond(Eigen::AngleAxisd(1.0 + part, Eigen::Vector3d::UnitX())), {1.0, 2.0, 3.0}};
    survey::ColmapModel model;
    survey::ColmapObservations observations;
    model.cameras[1] = {camera::CameraModel::kPinhole, 64, 48, {60.0, 60.0, 32.0, 24.0}};
    for (uint32_t i = 10 * part; i < 10 * part + 10; ++i) {
      const geo::Rigid3d down = {Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0), {}};
      const Eigen::Vector3d centre = frame.EnuFromGeodetic(*photos_[i].tags.gps);
      const geo::Rigid3d pose{down.rotation, -(down.rotation * centre)};
      model.images.push_back({i + 1, 1, photos_[i].name, geo::TransformCameraWorld(pose, own)});
      for (int k = 0; k < 12 && i > 10 * part; ++k) {
        survey::ColmapPoint point;
        point.id = model.points.size() + 1;
        point.x_in_world = own * Eigen::Vector3d(centre.x(), centre.y(), centre.z() - 100.0);
        point.image_ids = {i, i + 1};
        for (const uint32_t id : point.image_ids) observations[id].push_back({point.id, {32.0, 24.0}});
        model.points.push_back(point);
      }
    }
    survey::WriteColmapBinary(model, observations, folder_ / "models" / std::to_string(part));
  }
  const std::string joined = Find();
  EXPECT_EQ(joined, (job_.folder / "sparse_joined").string());
  EXPECT_EQ(Calls(), kFastCalls) << "more pairs were tried";
  const survey::ColmapModel model = survey::ReadColmapModel(joined);
  ASSERT_EQ(model.images.size(), 20U);
  for (const survey::ColmapImage& image : model.images) {
    EXPECT_LT((image.cam_from_world.OriginInSource() - frame.EnuFromGeodetic(*photos_[image.id - 1].tags.gps)).norm(), 0.5) << image.name;
  }
  EXPECT_EQ(Find(), joined);
  EXPECT_EQ(Calls(), "");
}

TEST_F(FastWay, KeepsItsModelWhenMorePairsAreNoBetter) {
  SetNumber("first", 17);
  SetNumber("again", 17);
  EXPECT_EQ(Find(), FirstModel());
  SetNumber("again", 0);
  std::filesystem::remove(job_.folder / "more_pairs" / "model.done");
  EXPECT_EQ(Find(), FirstModel());
}

// Poses of level ground that looks alike everywhere.
TEST_F(FastWay, KeepsTheFocalLengthOfTheTagsWhenTheMapperLeavesItFarBehind) {
  TagFocal();
  SetNumber("first", 20);
  SetNumber("held", 11);
  EXPECT_EQ(Find(), FirstModel());
  SetNumber("focal", 170);
  std::filesystem::remove(job_.folder / "model.done");
  Calls();
  EXPECT_EQ(Find(), HeldModel());
  EXPECT_EQ(Calls(), std::string("mapper\n") + kSecondCalls);
  EXPECT_EQ(Find(), HeldModel());
  EXPECT_EQ(Calls(), "");
  // With too few photos it is the focal length of the tags that does not fit.
  SetNumber("held", 9);
  std::filesystem::remove(job_.folder / "more_pairs" / "model_held_focal.done");
  EXPECT_EQ(Find(), FirstModel());
  SetNumber("held", 0);
  std::filesystem::remove(job_.folder / "more_pairs" / "model_held_focal.done");
  EXPECT_EQ(Find(), FirstModel());
}

TEST_F(FastWay, KeepsTheFocalLengthOfTheTagsAlsoWithMorePairs) {
  TagFocal();
  SetNumber("first", 0);
  SetNumber("again", 19);
  SetNumber("held", 18);
  SetNumber("focal", 20);
  EXPECT_EQ(Find(), HeldModel());
  EXPECT_EQ(Calls(), std::string(kFastCalls) + kSecondCalls + "mapper again\n");
  EXPECT_EQ(Find(), HeldModel());
  EXPECT_EQ(Calls(), "mapper\n");  // only what failed is tried again
}

TEST_F(FastWay, FocalLengthsWithoutTagsAreFree) {
  SetNumber("first", 20);
  SetNumber("focal", 170);
  EXPECT_EQ(Find(), FirstModel());
  EXPECT_EQ(Calls(), kFastCalls);
}

TEST_F(FastWay, TriesMorePairsWhenItFindsNoModel) {
  SetNumber("again", 5);
  EXPECT_EQ(Find(), SecondModel());
  SetNumber("again", 0);
  std::filesystem::remove(job_.folder / "more_pairs" / "model.done");
  EXPECT_NE(InputErrorOf([&] { Find(); }).find("more_pairs"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::prepare::poses
