#include "prepare/poses/seed/verdict.h"

#include <gtest/gtest.h>

namespace skyquilt::prepare::poses {
namespace {

// All photos but the last have a pose, and their tracks agree.
class VerdictTest : public testing::Test {
 protected:
  void SetUp() override { Chain(300); }
  void Chain(size_t common_tracks) {
    bundle_ = {};
    bundle_.photos.resize(kPhotos);
    bundle_.lenses.resize(1);
    for (uint32_t i = 0; i < kLast; ++i) bundle_.photos[i].placed = true;
    for (uint32_t i = 0; i + 1 < kLast; ++i) Add({i, i + 1}, common_tracks);
  }
  void Add(const std::vector<uint32_t>& photos, size_t n) {
    for (size_t i = 0; i < n; ++i) {
      for (const uint32_t photo : photos) {
        bundle_.tracks.entries.push_back({photo, feature_++});
        bundle_.agrees.push_back(bundle_.photos[photo].placed ? 1 : 0);
      }
      bundle_.tracks.first.push_back(static_cast<uint32_t>(bundle_.tracks.entries.size()));
      bundle_.has_point.push_back(0);
      bundle_.point.push_back(Eigen::Vector3d::Zero());
    }
    bundle_.pixel.resize(bundle_.tracks.entries.size());
  }

  static constexpr uint32_t kPhotos = 12, kLast = kPhotos - 1;
  bundle::BundleProblem bundle_;
  uint32_t feature_ = 0;
};

// Two strips of ten photos that look down, 10 m apart along the strip; `apart_m`: between the strips.
class Parts : public VerdictTest {
 protected:
  size_t RemovedOf(double apart_m, bool tags, bool angles, std::optional<double> height_m = 80.0) {
    bundle_ = {};
    bundle_.lenses.resize(1);
    bundle_.lenses[0].camera = {camera::CameraModel::kPinhole, 1600, 1200, {1400.0, 1400.0, 800.0, 600.0}};
    bundle_.photos.resize(2 * kEach);
    for (uint32_t i = 0; i < 2 * kEach; ++i) {
      bundle::BundlePhoto& photo = bundle_.photos[i];
      photo.placed = true;
      photo.cam_from_enu = Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
      photo.centre = Eigen::Vector3d(10.0 * (i % kEach), i < kEach ? 0.0 : apart_m, 80.0);
      if (tags) photo.gps = photo.centre;
      if (angles) photo.tagged_rotation = photo.cam_from_enu;
    }
    for (uint32_t i = 0; i + 1 < 2 * kEach; ++i) {
      if (i + 1 != kEach) Add({i, i + 1}, 100);
    }
    bundle_.has_point.assign(bundle_.tracks.size(), 1);
    return RemoveContradicted(bundle_, height_m);
  }
  static constexpr uint32_t kEach = 10;
};

using PartsOfASurvey = Parts;

TEST_F(PartsOfASurvey, StayWhenTagsHoldThemOverOtherGround) {
  EXPECT_EQ(RemovedOf(200.0, true, true), 0U);
}

TEST_F(PartsOfASurvey, MustBeTiedWhereTheyShowTheSameGround) {
  // A photo shows 80 m x 1600 / 1400 = 91 m across.
  EXPECT_EQ(RemovedOf(50.0, true, true), kEach);
  EXPECT_EQ(RemovedOf(200.0, true, true, {}), kEach);
}

TEST_F(PartsOfASurvey, OnOneLineNeedAngles) {
  EXPECT_EQ(RemovedOf(200.0, true, false), kEach);
  EXPECT_EQ(RemovedOf(200.0, false, false), kEach);
}

TEST_F(VerdictTest, APhotoOfAnotherPlaceDoesNotSpeakAgainstTheOthers) {
  for (uint32_t i = 0; i < kLast; ++i) Add({i, kLast}, 30);
  const Verdict verdict = Judge(bundle_, 80.0);
  EXPECT_EQ(verdict.n_matched, 11U);
  EXPECT_EQ(verdict.n_placed, 11U);
  EXPECT_TRUE(verdict.good) << verdict.reason;
}

TEST_F(VerdictTest, APhotoThatLooksLikeAnotherOneDoes) {
  Add({3, kLast}, 45);
  const Verdict verdict = Judge(bundle_, 80.0);
  EXPECT_EQ(verdict.n_matched, 12U);
  EXPECT_FALSE(verdict.good);
  EXPECT_NE(verdict.reason.find("only 11 of 12 photos"), std::string::npos) << verdict.reason;
}

// Where all photos have few matches, few are as good as any.
TEST_F(VerdictTest, FewMatchesAmongFewAreNotStrange) {
  Chain(60);
  Add({3, kLast}, 35);
  EXPECT_EQ(Judge(bundle_, 80.0).n_matched, 12U);
}

// A tenth of the photos may be of another place; more lack a connection.
TEST_F(VerdictTest, ManyPhotosAreNoStrangers) {
  bundle_.photos[kLast - 1].placed = false;
  bundle_.tracks = {};
  bundle_.agrees.clear();
  for (uint32_t i = 0; i + 2 < kLast; ++i) Add({i, i + 1}, 300);
  Add({kLast - 1, kLast}, 300);
  EXPECT_EQ(Judge(bundle_, 80.0).n_matched, 12U);
  EXPECT_FALSE(Judge(bundle_, 80.0).good);
}

}  // namespace
}  // namespace skyquilt::prepare::poses
