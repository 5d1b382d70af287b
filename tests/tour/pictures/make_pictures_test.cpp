#include "tour/pictures/make_pictures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/tour/pictures/sample_fields.h"
#include "tour/pictures/estimate_seconds.h"
#include "tour/pictures/picture_file.h"

namespace skyquilt::tour {
namespace {

std::vector<PictureRequest> ThreeRequests() {
  return {PanoramaAt({0.0, 0.0, 30.0}, 64, "normal"), PanoramaAt({-20.0, 5.0, 12.0}, 64, "normal"),
          StillAt({0.0, 0.0, 30.0}, Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0), 60.0, 40, 30, "-1")};
}

std::set<std::string> FilesIn(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

class MakePicturesTest : public ::testing::Test {
 protected:
  CountedField counted_;
  const TemporaryFolder work_;
  std::vector<PictureRequest> requests_ = ThreeRequests();
};

TEST_F(MakePicturesTest, ASecondRunRendersNothing) {
  const PictureFiles first = MakePictures(requests_, counted_.field, work_.path());
  EXPECT_EQ(first.rendered, 3);
  EXPECT_EQ(counted_.n_rays, 2 * 64 * 32 + 40 * 30);
  EXPECT_EQ(first.rays, counted_.n_rays);
  ASSERT_EQ(first.files.size(), 3U);
  const std::string bytes = base::ReadFile(first.files[1]);
  const PictureFiles second = MakePictures(requests_, counted_.field, work_.path());
  EXPECT_EQ(second.rendered, 0);
  EXPECT_EQ(counted_.n_rays, first.rays);
  EXPECT_EQ(second.files, first.files);
  EXPECT_EQ(base::ReadFile(first.files[1]), bytes);
}

// Any byte: those of the header, of the colours, of the depths, of the checksum; and a file that is cut off.
TEST_F(MakePicturesTest, ADamagedPictureIsRenderedAnew) {
  const std::filesystem::path file = MakePictures(requests_, counted_.field, work_.path()).files[0];
  const std::string good = base::ReadFile(file);
  const auto expect_repaired = [&](const std::string& bad) {
    base::WriteFileAtomically(file, bad);
    EXPECT_THROW(OpenPicture(file), base::InputError);
    EXPECT_EQ(MissingPictures(requests_, counted_.field, work_.path()).size(), 1U);
    counted_.n_rays = 0;
    EXPECT_EQ(MakePictures(requests_, counted_.field, work_.path()).rendered, 1);
    EXPECT_EQ(counted_.n_rays, 64 * 32);
    EXPECT_EQ(base::ReadFile(file), good);
  };
  for (const size_t at : {size_t{0}, size_t{9}, size_t{30}, size_t{50}, good.size() / 2, good.size() - 20, good.size() - 1}) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x10);
    expect_repaired(bad);
  }
  expect_repaired(good.substr(0, good.size() - 1));
  expect_repaired(good.substr(0, 20));
  expect_repaired("");
}

TEST_F(MakePicturesTest, ContinuesAfterAnInterruption) {
  // In the middle of the second picture, which has three batches as the first one.
  int batches = 0;
  counted_.after_batch = [&batches] {
    if (++batches == 4) base::RequestCancel();
  };
  EXPECT_THROW(MakePictures(requests_, counted_.field, work_.path()), base::Interrupted);
  base::ClearCancel();
  EXPECT_EQ(FilesIn(work_.path()).size(), 1U) << "whole or absent";
  EXPECT_EQ(MissingPictures(requests_, counted_.field, work_.path()).size(), 2U);
  counted_.n_rays = 0;
  EXPECT_EQ(MakePictures(requests_, counted_.field, work_.path()).rendered, 2);
  EXPECT_EQ(counted_.n_rays, 64 * 32 + 40 * 30);
}

TEST_F(MakePicturesTest, RendersWhatHasChangedAndRemovesTheRest) {
  const PictureFiles before = MakePictures(requests_, counted_.field, work_.path());
  base::WriteFileAtomically(work_ / "notes.txt", "not ours");
  // As a killed process leaves it.
  base::WriteFileAtomically(work_ / ("." + before.files[0].filename().string() + ".tmp.123.0"), "half");
  const auto expect_rendered = [&](int64_t rendered, const char* why) {
    const PictureFiles made = MakePictures(requests_, counted_.field, work_.path());
    EXPECT_EQ(made.rendered, rendered) << why;
    std::set<std::string> expected = {"notes.txt"};
    for (const auto& file : made.files) expected.insert(file.filename().string());
    EXPECT_EQ(FilesIn(work_.path()), expected) << why;
  };
  requests_[0].cam_from_enu = Eigen::Quaterniond(0.6, 0.0, 0.8, 0.0);
  expect_rendered(0, "a panorama looks everywhere");
  requests_[2].cam_from_enu = Eigen::Quaterniond(0.6, 0.8, 0.0, 0.0);
  expect_rendered(1, "a still does not");
  requests_[1].eye_enu.x() += 1e-6;
  expect_rendered(1, "another eye");
  requests_[1].exposure = "0.5";
  expect_rendered(1, "another exposure");
  std::swap(requests_[0], requests_[2]);
  expect_rendered(0, "another order");
  requests_.push_back(requests_[0]);
  expect_rendered(0, "the same picture twice");
  counted_.field.identity = "another scene";
  expect_rendered(3, "another scene");
}

TEST_F(MakePicturesTest, ExposuresAreThoseOfTheRequests) {
  const std::vector<PictureRequest> requests = {PanoramaAt({0.0, 0.0, 30.0}, 32, "normal"), PanoramaAt({0.0, 0.0, 30.0}, 32, "-1")};
  const PictureFiles made = MakePictures(requests, counted_.field, work_.path());
  const image::Image8 normal = ColorsOf(OpenPicture(made.files[0])), darker = ColorsOf(OpenPicture(made.files[1]));
  // Ground east of the eye is red.
  EXPECT_EQ(normal.At(24, 15)[0], 255);
  EXPECT_EQ(darker.At(24, 15)[0], 128);
}

TEST(PanoramaAt, RefusesSizesThatAreNone) {
  for (const int width : {0, -2, 33, kMaxPanoramaWidth + 2}) EXPECT_THROW(PanoramaAt(Eigen::Vector3d::Zero(), width, "normal"), base::UsageError);
}

TEST(EstimateSeconds, LooksAtAFewRaysOfAllPictures) {
  CountedField counted;
  EXPECT_EQ(EstimateSeconds({}, counted.field), 0.0);
  std::vector<PictureRequest> requests = ThreeRequests();
  requests.push_back(PanoramaAt({5.0, 5.0, 50.0}, 2048, "normal"));
  const double seconds = EstimateSeconds(requests, counted.field);
  EXPECT_GT(seconds, 0.0);
  EXPECT_TRUE(std::isfinite(seconds));
  EXPECT_GT(counted.n_rays, 10'000);
  EXPECT_LE(counted.n_rays, 32 * 1024);
}

}  // namespace
}  // namespace skyquilt::tour
