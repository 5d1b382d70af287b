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
