#include "prepare/poses/seed/seed_poses.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/linear/linear.h"
#include "tests/prepare/poses/seed/made_survey.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::test {
namespace {

using prepare::poses::SeededModel;
using prepare::poses::SeedPoses;

struct Accuracy {
  double centre_m = 0.0;  // root mean square after a similarity
  double worst_m = 0.0;
  double worst_deg = 0.0;  // of rotations, after the same
};

Accuracy Compare(const MadeSurvey& made, const survey::ColmapModel& model) {
  Eigen::Matrix3Xd found(3, static_cast<Eigen::Index>(model.images.size())), truth = found;
  for (size_t k = 0; k < model.images.size(); ++k) {
    found.col(static_cast<Eigen::Index>(k)) = model.images[k].cam_from_world.OriginInSource();
    truth.col(static_cast<Eigen::Index>(k)) = made.cam_from_enu[model.images[k].id - 1].OriginInSource();
  }
  const Eigen::Matrix4d map = linear::Similarity(found, truth);
  const double scale = std::cbrt(map.topLeftCorner<3, 3>().determinant());
  const Eigen::Quaterniond turn(Eigen::Matrix3d(map.topLeftCorner<3, 3>() / scale));
  Accuracy accuracy;
  for (size_t k = 0; k < model.images.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const double off = (map.topLeftCorner<3, 3>() * found.col(i) + map.topRightCorner<3, 1>() - truth.col(i)).norm();
    accuracy.centre_m += off * off / static_cast<double>(model.images.size());
    accuracy.worst_m = std::max(accuracy.worst_m, off);
    const Eigen::Quaterniond rotation = model.images[k].cam_from_world.rotation * turn.conjugate();
    const double angle = rotation.angularDistance(made.cam_from_enu[model.images[k].id - 1].rotation) * 180.0 / M_PI;
    accuracy.worst_deg = std::max(accuracy.worst_deg, angle);
  }
  accuracy.centre_m = std::sqrt(accuracy.centre_m);
  return accuracy;
}

class SeedPosesTest : public testing::Test {
 protected:
  void ExpectRight(const MadeSurvey& made, const std::optional<SeededModel>& seeded, size_t n_photos) {
    ASSERT_TRUE(seeded) << reason_;
    EXPECT_EQ(seeded->model.images.size(), n_photos);
    const Accuracy accuracy = Compare(made, seeded->model);
    // The GSD is 6 cm; the height of a camera is the least certain.
    EXPECT_LT(accuracy.centre_m, 0.12);
    EXPECT_LT(accuracy.worst_m, 0.4);
    // In the corners; a level survey hardly resists being bent.
    EXPECT_LT(accuracy.worst_deg, 0.3);
    EXPECT_LT(seeded->median_error, 0.8);
    for (const auto& [id, camera] : seeded->model.cameras)
      EXPECT_NEAR(camera.FocalX() / made.cameras[id - 1].FocalX(), 1.0, 0.015) << "camera " << id;
  }

  base::ThreadPool threads_{2};
  std::string reason_;
};

TEST_F(SeedPosesTest, FindsPosesAndLensByGimbal) {
  const MadeSurvey made = MakeSurvey({});
  const auto seeded = SeedPoses(made.input, threads_, &reason_);
  ExpectRight(made, seeded, 30);
  EXPECT_TRUE(seeded->by_gimbal);
  EXPECT_LT(seeded->median_gps_m, 4.0);
}

// Two zones of a survey without a photo between them: each is as good as alone, and tags place them beside each other.
TEST_F(SeedPosesTest, PartsWithoutCommonFeaturesArePlacedByTheirTags) {
  for (const bool gimbal : {true, false}) {
    const MadeSurvey made = MakeSurvey({.strips = 6, .gimbal_tags = gimbal, .chance_matches = gimbal ? 20 : 0, .gap_m = 200.0, .seed = 7});
    const auto seeded = SeedPoses(made.input, threads_, &reason_);
    ASSERT_TRUE(seeded) << reason_;
    ASSERT_EQ(seeded->model.images.size(), 36U);
    // In ENU about a tag; of all photos, and of each part.
    std::array<survey::ColmapModel, 2> parts;
    for (const survey::ColmapImage& image : seeded->model.images) parts[image.id <= 18 ? 0 : 1].images.push_back(image);
    for (const survey::ColmapModel& part : parts) {
      ASSERT_EQ(part.images.size(), 18U);
      EXPECT_LT(Compare(made, part).centre_m, 0.15);
    }
    // The means of 18 tags with errors of 1.5 m and 3 m.
    EXPECT_LT(Compare(made, seeded->model).worst_m, 3.0);
    EXPECT_LT(Compare(made, seeded->model).worst_deg, 2.0);
  }
}

TEST_F(SeedPosesTest, PartsThatShowTheSameGroundMustHaveFeaturesInCommon) {
  MadeSurvey made = MakeSurvey({.strips = 6, .seed = 8});
  std::erase_if(made.input.pairs, [](const auto& pair) { return (pair.image_a <= 18) != (pair.image_b <= 18); });
  EXPECT_FALSE(SeedPoses(made.input, threads_, &reason_));
  EXPECT_NE(reason_.find("only 18 of 36 photos fit together"), std::string::npos) << reason_;
}

TEST_F(SeedPosesTest, AFifthOfTheMatchesWrong) {
  const MadeSurvey made = MakeSurvey({.wrong_matches = 0.2, .seed = 2});
  const auto seeded = SeedPoses(made.input, threads_, &reason_);
  ExpectRight(made, seeded, 30);
}

TEST_F(SeedPosesTest, LooksDownWithoutAngles) {
  const MadeSurvey made = MakeSurvey({.tilt_noise_deg = 4.0, .gimbal_tags = false, .seed = 3});
  const auto seeded = SeedPoses(made.input, threads_, &reason_);
  ExpectRight(made, seeded, 30);
  EXPECT_FALSE(seeded->by_gimbal);
}

TEST_F(SeedPosesTest, Oblique) {
  const MadeSurvey made = MakeSurvey({.pitch_deg = -60.0, .seed = 4});
  ExpectRight(made, SeedPoses(made.input, threads_, &reason_), 30);
}

TEST_F(SeedPosesTest, TwoCameras) {
  const MadeSurvey made = MakeSurvey({.cameras = 2, .seed = 5});
  ExpectRight(made, SeedPoses(made.input, threads_, &reason_), 30);
}

// The initial focal length is 6 % too long.
TEST_F(SeedPosesTest, AFocalLengthIsHeldAsFirmlyAsItsAccuracySays) {
  MadeSurvey made = MakeSurvey({.seed = 5});
  const double initial_px = made.input.cameras.begin()->second.camera.FocalX(), true_px = made.cameras.front().FocalX();
  const auto free = SeedPoses(made.input, threads_, &reason_);
  ASSERT_TRUE(free) << reason_;
  EXPECT_LT(std::abs(free->model.cameras.begin()->second.FocalX() - true_px), 0.5 * std::abs(initial_px - true_px));
  made.input.cameras.begin()->second.focal_sigma = 1e-5;
  const auto held = SeedPoses(made.input, threads_, &reason_);
  ASSERT_TRUE(held) << reason_;
  EXPECT_NEAR(held->model.cameras.begin()->second.FocalX(), initial_px, 1e-3 * initial_px);
}

// A camera mounted across, or a compass that is off: the same error of all.
TEST_F(SeedPosesTest, YawOffsetCommonToAll) {
  MadeSurvey made = MakeSurvey({.seed = 6});
  for (prepare::poses::SeedPhoto& photo : made.input.photos) *photo.yaw_deg += 90.0;
  const auto seeded = SeedPoses(made.input, threads_, &reason_);
  ExpectRight(made, seeded, 30);
  EXPECT_TRUE(seeded->by_gimbal);
}

TEST_F(SeedPosesTest, UselessYawIsReplacedByMatchesWhenLookingDown) {
  MadeSurvey made = MakeSurvey({.seed = 7});
  for (prepare::poses::SeedPhoto& photo : made.input.photos) photo.yaw_deg = 0.0;
  const auto seeded = SeedPoses(made.input, threads_, &reason_);
  ExpectRight(made, seeded, 30);
  EXPECT_FALSE(seeded->by_gimbal);
}

TEST_F(SeedPosesTest, UselessYawOfObliquePhotosIsRefused) {
  MadeSurvey made = MakeSurvey({.pitch_deg = -55.0, .seed = 8});
  for (prepare::poses::SeedPhoto& photo : made.input.photos) photo.yaw_deg = 0.0;
  EXPECT_FALSE(SeedPoses(made.input, threads_, &reason_));
  EXPECT_NE(reason_.find("gimbal angles and positions agree with only"), std::string::npos) << reason_;
}

TEST_F(SeedPosesTest, MirroredYawIsRightOrRefused) {
  MadeSurvey made = MakeSurvey({.seed = 9});
  // Every second strip across, so that a mirrored yaw is not the same error for all.
  for (size_t i = 0; i < made.input.photos.size(); ++i) *made.input.photos[i].yaw_deg = -*made.input.photos[i].yaw_deg + (i % 3 == 0 ? 70.0 : 0.0);
  const auto seeded = SeedPoses(made.input, threads_, &reason_);
  if (seeded) ExpectRight(made, seeded, 30);
}

TEST_F(SeedPosesTest, RandomPositionsAreRefused) {
  MadeSurvey made = MakeSurvey({.seed = 10});
  for (size_t i = 0; i < made.input.photos.size(); ++i) made.input.photos[i].gps = made.input.photos[(7 * i + 11) % 30].gps;
  EXPECT_FALSE(SeedPoses(made.input, threads_, &reason_));
  EXPECT_FALSE(reason_.empty());
}

TEST_F(SeedPosesTest, HalfOfThePhotosWithoutTagsIsRefused) {
  MadeSurvey made = MakeSurvey({.seed = 11});
  for (size_t i = 0; i < made.input.photos.size(); i += 2) made.input.photos[i].gps.reset();
  EXPECT_FALSE(SeedPoses(made.input, threads_, &reason_));
  EXPECT_EQ(reason_, "only 15 of 30 photos have a GPS tag");
}

TEST_F(SeedPosesTest, FewPhotosWithoutTagsAreResected) {
  MadeSurvey made = MakeSurvey({.seed = 12});
  made.input.photos[4].gps.reset();
  made.input.photos[17].yaw_deg.reset();
  // A tag in another part of the survey: its photo must not pull others away.
  made.input.photos[8].gps = made.input.photos[29].gps;
  ExpectRight(made, SeedPoses(made.input, threads_, &reason_), 30);
}

TEST_F(SeedPosesTest, SmallSurveysAreHeldByTheTags) {
  struct SmallSurvey {
    SurveyPlan plan;
    double centre_m;
  };
  // A strip says little about its own bend: only the tags hold it.
  for (const auto& [plan, centre_m] :
       {SmallSurvey{{.strips = 1, .per_strip = 12, .seed = 13}, 1.0}, SmallSurvey{{.strips = 2, .per_strip = 2, .seed = 14}, 0.5}}) {
    const MadeSurvey made = MakeSurvey(plan);
    const auto seeded = SeedPoses(made.input, threads_, &reason_);
    ASSERT_TRUE(seeded) << reason_;
    EXPECT_EQ(seeded->model.images.size(), static_cast<size_t>(plan.strips * plan.per_strip));
    EXPECT_LT(Compare(made, seeded->model).centre_m, centre_m);
  }
}

TEST_F(SeedPosesTest, TwoPhotosAreRefused) {
  const MadeSurvey made = MakeSurvey({.strips = 1, .per_strip = 2, .seed = 15});
  EXPECT_FALSE(SeedPoses(made.input, threads_, &reason_));
}

TEST_F(SeedPosesTest, DuplicatePhotosAndMatches) {
  MadeSurvey made = MakeSurvey({.seed = 16});
  // The same photo under another name, with the matches of the first and all features matched to it.
  prepare::poses::SeedPhoto twin = made.input.photos[9];
  twin.image_id = 31;
  twin.name = "twin.jpg";
  prepare::poses::PairMatches same{10, 31, {}};
  for (uint32_t k = 0; k < twin.features.size(); ++k) same.features.push_back({k, k});
  const std::vector<prepare::poses::PairMatches> pairs = made.input.pairs;
  for (prepare::poses::PairMatches pair : pairs) {
    made.input.pairs.push_back(pair);  // once more
    if (pair.image_a == 10) pair.image_a = 31;
    if (pair.image_b == 10) pair.image_b = 31;
    if (pair.image_a == 31 || pair.image_b == 31) made.input.pairs.push_back(pair);
  }
  made.input.pairs.push_back(same);
  made.input.photos.push_back(twin);
  made.cam_from_enu.push_back(made.cam_from_enu[9]);
  ExpectRight(made, SeedPoses(made.input, threads_, &reason_), 31);
}

TEST_F(SeedPosesTest, PartsWithoutCommonMatchesAreRefused) {
  MadeSurvey made = MakeSurvey({.strips = 6, .seed = 17});
  std::erase_if(made.input.pairs, [](const prepare::poses::PairMatches& pair) { return (pair.image_a <= 18) != (pair.image_b <= 18); });
  EXPECT_FALSE(SeedPoses(made.input, threads_, &reason_));
  EXPECT_NE(reason_.find("18 of 36 photos fit together"), std::string::npos) << reason_;
}

TEST_F(SeedPosesTest, SameBitsWithAnyNumberOfThreads) {
  const MadeSurvey made = MakeSurvey({.strips = 3, .wrong_matches = 0.05, .seed = 18});
  base::ThreadPool one(1), four(4);
  const auto a = SeedPoses(made.input, one, &reason_), b = SeedPoses(made.input, four, &reason_);
  ASSERT_TRUE(a && b) << reason_;
  ASSERT_EQ(a->model.images.size(), b->model.images.size());
  ASSERT_EQ(a->model.points.size(), b->model.points.size());
  for (size_t k = 0; k < a->model.images.size(); ++k) {
    EXPECT_EQ(a->model.images[k].cam_from_world.translation, b->model.images[k].cam_from_world.translation);
    EXPECT_EQ(a->model.images[k].cam_from_world.rotation.coeffs(), b->model.images[k].cam_from_world.rotation.coeffs());
  }
}

// Points of two photos only where a photo has few others.
TEST_F(SeedPosesTest, PointsOfTwoPhotosFillGapsOnly) {
  const auto count = [](const SeededModel& seeded, size_t* n_two, size_t* n_wrong) {
    std::map<uint32_t, size_t> firm;
    for (const survey::ColmapPoint& point : seeded.model.points) {
      for (const uint32_t id : point.image_ids) firm[id] += point.image_ids.size() >= 3 ? 1 : 0;
    }
    for (const survey::ColmapPoint& point : seeded.model.points) {
      if (point.image_ids.size() != 2) continue;
      ++*n_two;
      *n_wrong += firm[point.image_ids[0]] >= 200 && firm[point.image_ids[1]] >= 200 ? 1 : 0;
    }
  };
  size_t n_two = 0, n_wrong = 0;
  const auto dense = SeedPoses(MakeSurvey({.strips = 3, .per_strip = 4, .points_per_photo = 600, .seed = 20}).input, threads_, &reason_);
  ASSERT_TRUE(dense) << reason_;
  count(*dense, &n_two, &n_wrong);
  EXPECT_EQ(n_wrong, 0U);
  EXPECT_LT(10 * n_two, dense->model.points.size());
  n_two = 0;
  const auto sparse = SeedPoses(MakeSurvey({.strips = 2, .per_strip = 2, .points_per_photo = 200, .seed = 21}).input, threads_, &reason_);
  ASSERT_TRUE(sparse) << reason_;
  count(*sparse, &n_two, &n_wrong);
  EXPECT_GT(n_two, 0U);
}

TEST_F(SeedPosesTest, StopsWhenAsked) {
  const MadeSurvey made = MakeSurvey({.strips = 2, .per_strip = 3});
  ExpectStopsWhenAsked([&] { SeedPoses(made.input, threads_, &reason_); });
}

TEST_F(SeedPosesTest, WrittenModelIsReadBack) {
  const MadeSurvey made = MakeSurvey({.strips = 3, .per_strip = 4, .seed = 19});
  const auto seeded = SeedPoses(made.input, threads_, &reason_);
  ASSERT_TRUE(seeded) << reason_;
  const TemporaryFolder folder;
  prepare::poses::WriteSeededModel(*seeded, folder.path() / "model");
  const survey::ColmapModel model = survey::ReadColmapModel(folder.path() / "model");
  const survey::ColmapObservations observations = survey::ReadColmapObservations(folder.path() / "model");
  ASSERT_EQ(model.images.size(), seeded->model.images.size());
  ASSERT_EQ(model.points.size(), seeded->model.points.size());
  EXPECT_EQ(model.cameras.at(1).params, seeded->model.cameras.at(1).params);
  for (size_t k = 0; k < model.images.size(); ++k) {
    EXPECT_EQ(model.images[k].name, seeded->model.images[k].name);
    EXPECT_EQ(model.images[k].cam_from_world.translation, seeded->model.images[k].cam_from_world.translation);
  }
  std::map<uint64_t, const survey::ColmapPoint*> points;
  for (const survey::ColmapPoint& point : model.points) points[point.id] = &point;
  // Every observation is near the projection of its point, so the numbers belong together.
  size_t n = 0;
  for (const survey::ColmapImage& image : model.images) {
    const camera::Camera& camera = model.cameras.at(image.camera_id);
    for (const survey::ColmapObservation& observation : observations.at(image.id)) {
      const auto pixel = camera.ImgFromCam(image.cam_from_world * points.at(observation.point_id)->x_in_world);
      ASSERT_TRUE(pixel);
      EXPECT_LT((*pixel - observation.pixel).norm(), 4.1);
      ++n;
    }
  }
  size_t n_tracked = 0;
  for (const survey::ColmapPoint& point : model.points) n_tracked += point.image_ids.size();
  EXPECT_EQ(n, n_tracked);
}

}  // namespace
}  // namespace skyquilt::test
