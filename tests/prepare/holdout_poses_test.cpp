#include "prepare/holdout_poses.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "core/base/order_statistics.h"
#include "core/geo/enu_frame.h"
#include "core/linear/linear.h"
#include "prepare/bundle/resect.h"
#include "tests/prepare/control/fit/made_control.h"

namespace skyquilt::prepare {
namespace {

base::ThreadPool& PoolOfTwo() {
  static base::ThreadPool threads(2);
  return threads;
}

// 4 strips of 5 photos, which have been found with all features.
const test::MadeControl& MadeFlight() {
  static const test::MadeControl made =
      test::MakeControl({.survey = {.strips = 4, .per_strip = 5, .gimbal_tags = false}, .control = 0, .check = 0}, PoolOfTwo());
  return made;
}

// The middle photo of each strip.
std::unordered_set<uint32_t> MiddlePhotos() {
  return {3, 8, 13, 18};
}

struct Resection {
  survey::ColmapModel model;
  WithheldPhotos withheld;
  std::vector<std::string> lost;
};

Resection Resected(test::MadeControl made, base::ThreadPool& threads) {
  Resection result;
  std::string reason;
  auto withheld = WithholdPhotos(MiddlePhotos(), made.observations, made.model, threads, &reason);
  EXPECT_TRUE(withheld) << reason;
  if (!withheld) return result;
  EXPECT_EQ(made.model.images.size(), 16U);
  EXPECT_EQ(withheld->images.size(), 4U);
  result.lost = ResectWithheld(*withheld, made.model);
  result.model = std::move(made.model);
  result.withheld = *std::move(withheld);
  return result;
}

const survey::ColmapImage* FindImage(const survey::ColmapModel& model, uint32_t id) {
  const auto found = std::find_if(model.images.begin(), model.images.end(), [id](const survey::ColmapImage& image) { return image.id == id; });
  return found == model.images.end() ? nullptr : &*found;
}

void ExpectSamePose(const survey::ColmapModel& a, const survey::ColmapModel& b, uint32_t id) {
  const survey::ColmapImage *in_a = FindImage(a, id), *in_b = FindImage(b, id);
  ASSERT_TRUE(in_a != nullptr && in_b != nullptr) << id;
  EXPECT_EQ(in_a->cam_from_world.rotation.coeffs(), in_b->cam_from_world.rotation.coeffs()) << id;
  EXPECT_EQ(in_a->cam_from_world.translation, in_b->cam_from_world.translation) << id;
}

// All poses but those of the middle photos, the lens and the points; not who observed these.
void ExpectSameOthers(const survey::ColmapModel& a, const survey::ColmapModel& b) {
  for (uint32_t id = 1; id <= 20; ++id) {
    if (!MiddlePhotos().contains(id)) ExpectSamePose(a, b, id);
  }
  EXPECT_EQ(a.cameras.at(1).params, b.cameras.at(1).params);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (size_t i = 0; i < a.points.size(); ++i) {
    EXPECT_EQ(a.points[i].id, b.points[i].id);
    EXPECT_EQ(a.points[i].x_in_world, b.points[i].x_in_world);
    EXPECT_EQ(a.points[i].error_px, b.points[i].error_px);
  }
}

// Median distance in pixels between features and the projections of their points.
double MedianErrorPx(const Resection& result, bool middle) {
  std::vector<double> errors;
  std::unordered_map<uint64_t, Eigen::Vector3d> place;
  for (const survey::ColmapPoint& point : result.model.points) place.emplace(point.id, point.x_in_world);
  for (const survey::ColmapImage& image : result.model.images) {
    if (MiddlePhotos().contains(image.id) != middle) continue;
    for (const survey::ColmapObservation& seen : result.withheld.observations.at(image.id)) {
      const auto point = place.find(seen.point_id);
      if (point == place.end()) continue;
      const auto pixel = result.model.cameras.at(image.camera_id).ImgFromCam(image.cam_from_world * point->second);
      if (pixel) errors.push_back((*pixel - seen.pixel).norm());
    }
  }
  EXPECT_GT(errors.size(), 500U);
  return errors.empty() ? 0.0 : base::Median(errors);
}

TEST(HoldoutPoses, FeaturesAndPosesOfHeldOutPhotosChangeNothingElse) {
  test::MadeControl changed = MadeFlight();
  for (survey::ColmapImage& image : changed.model.images) {
    if (MiddlePhotos().contains(image.id)) image.cam_from_world.translation += Eigen::Vector3d(3.0, -2.0, 5.0);
  }
  for (const uint32_t id : MiddlePhotos()) {
    double k = 0.0;
    for (survey::ColmapObservation& seen : changed.observations.at(id)) {
      k += 1.0;
      seen.pixel += Eigen::Vector2d(12.0 + std::sin(k), -9.0 + std::cos(k));
    }
  }
  const Resection as_found = Resected(MadeFlight(), PoolOfTwo()), garbled = Resected(changed, PoolOfTwo());
  ExpectSameOthers(as_found.model, garbled.model);
  ASSERT_NE(FindImage(garbled.model, 8), nullptr);
  EXPECT_NE(FindImage(garbled.model, 8)->cam_from_world.translation, FindImage(as_found.model, 8)->cam_from_world.translation);
}

// Distortion in the features of held-out photos alone gets into the lens of all, and out of it again.
TEST(HoldoutPoses, WhatHeldOutPhotosDidToTheLensIsUndone) {
  constexpr size_t kK1 = 4;  // of OPENCV
  const auto k1_of = [](const survey::ColmapModel& model) { return model.cameras.at(1).params[kK1]; };
  test::MadeControl bent = MadeFlight();
  const camera::Camera& camera = bent.model.cameras.at(1);
  for (const uint32_t id : MiddlePhotos()) {
    for (survey::ColmapObservation& seen : bent.observations.at(id)) {
      const Eigen::Vector2d from_centre = seen.pixel - camera.PrincipalPoint();
      seen.pixel += 0.004 * (from_centre / camera.FocalX()).squaredNorm() * from_centre;
    }
  }
  std::string reason;
  // With no photo withheld, this adjusts all of them together.
  ASSERT_TRUE(WithholdPhotos({}, bent.observations, bent.model, PoolOfTwo(), &reason)) << reason;
  const double clean = k1_of(Resected(MadeFlight(), PoolOfTwo()).model);
  const double shift = k1_of(bent.model) - clean;
  EXPECT_GT(std::abs(shift), 2e-4);
  EXPECT_LT(std::abs(k1_of(Resected(bent, PoolOfTwo()).model) - clean), 0.2 * std::abs(shift));
}

TEST(HoldoutPoses, ResectedPhotosAreAsRightAsTheOthers) {
  const test::MadeControl& made = MadeFlight();
  const Resection result = Resected(made, PoolOfTwo());
  EXPECT_TRUE(result.lost.empty());
  ASSERT_EQ(result.model.images.size(), 20U);
  // Features of 0.5 px per axis (0.59 px in the median), and points that are not exact.
  EXPECT_LT(MedianErrorPx(result, false), 0.65);
  EXPECT_LT(MedianErrorPx(result, true), 0.9);
  EXPECT_NEAR(result.withheld.tie_sigma, 0.5, 0.1);

  // Against the truth, in the frame that fits the other photos best.
  Eigen::Matrix3Xd found(3, 16), truth(3, 16);
  Eigen::Index n = 0;
  for (size_t i = 0; i < made.model.images.size(); ++i) {
    const uint32_t id = made.model.images[i].id;
    if (MiddlePhotos().contains(id)) continue;
    found.col(n) = FindImage(result.model, id)->cam_from_world.OriginInSource();
    truth.col(n++) = made.true_poses[i].OriginInSource();
  }
  ASSERT_EQ(n, 16);
  const Eigen::Matrix4d true_from_model = linear::Similarity(found, truth);
  const Eigen::Matrix3d scaled = true_from_model.topLeftCorner<3, 3>();
  const Eigen::Vector3d shift = true_from_model.topRightCorner<3, 1>();
  const double others_m = std::sqrt((((scaled.lazyProduct(found)).colwise() + shift) - truth).colwise().squaredNorm().mean());
  const Eigen::Matrix3d turn = scaled / scaled.col(0).norm();
  for (size_t i = 0; i < made.model.images.size(); ++i) {
    const uint32_t id = made.model.images[i].id;
    if (!MiddlePhotos().contains(id)) continue;
    const geo::Rigid3d& pose = FindImage(result.model, id)->cam_from_world;
    EXPECT_LT((scaled * pose.OriginInSource() + shift - made.true_poses[i].OriginInSource()).norm(), 4.0 * others_m + 0.02) << id;
    const Eigen::Quaterniond expected(made.true_poses[i].rotation.toRotationMatrix() * turn);
    EXPECT_LT(expected.angularDistance(pose.rotation), 5e-3) << id;
  }
  EXPECT_LT(others_m, 0.3);
}

TEST(HoldoutPoses, ResectedPhotosJoinTheTracksThatTheyFit) {
  test::MadeControl made = MadeFlight();
  // Wrong features of a photo do not.
  size_t n_wrong = 0;
  std::unordered_set<uint64_t> wrong;
  for (survey::ColmapObservation& seen : made.observations.at(8)) {
    if (++n_wrong % 4 != 0) continue;
    seen.pixel += Eigen::Vector2d(40.0, 0.0);
    wrong.insert(seen.point_id);
  }
  const Resection result = Resected(made, PoolOfTwo());
  size_t n_joined = 0;
  for (const survey::ColmapPoint& point : result.model.points) {
    const bool joined = std::find(point.image_ids.begin(), point.image_ids.end(), 8U) != point.image_ids.end();
    EXPECT_FALSE(joined && wrong.contains(point.id));
    n_joined += joined ? 1 : 0;
    EXPECT_GE(std::count_if(point.image_ids.begin(), point.image_ids.end(), [](uint32_t id) { return !MiddlePhotos().contains(id); }), 2);
  }
  EXPECT_GT(n_joined, 100U);
}

TEST(HoldoutPoses, AHeldOutPhotoThatSeesTooLittleLosesItsPose) {
  test::MadeControl blind = MadeFlight();
  std::vector<survey::ColmapObservation>& seen = blind.observations.at(8);
  ASSERT_GT(seen.size(), 100U);
  seen.resize(bundle::kLeastObservations - 1);
  const Resection all = Resected(MadeFlight(), PoolOfTwo()), result = Resected(blind, PoolOfTwo());
  EXPECT_EQ(result.lost, std::vector<std::string>{"photo_107.jpg"});
  EXPECT_EQ(result.model.images.size(), 19U);
  EXPECT_EQ(FindImage(result.model, 8), nullptr);
  ExpectSameOthers(all.model, result.model);
  for (const uint32_t id : {3U, 13U, 18U}) ExpectSamePose(all.model, result.model, id);
}

TEST(HoldoutPoses, AreTheSameWithAnyNumberOfThreads) {
  base::ThreadPool one(1);
  const Resection two_threads = Resected(MadeFlight(), PoolOfTwo()), one_thread = Resected(MadeFlight(), one);
  ExpectSameOthers(two_threads.model, one_thread.model);
  ExpectSamePose(two_threads.model, one_thread.model, 8);
}

TEST(HoldoutPoses, WhereNothingCanBeAdjustedTheModelStaysAndTheReasonIsTold) {
  const auto reason_of = [](test::MadeControl made, const std::unordered_set<uint32_t>& ids) {
    std::string reason;
    EXPECT_FALSE(WithholdPhotos(ids, made.observations, made.model, PoolOfTwo(), &reason));
    EXPECT_EQ(made.model.images.size(), 20U);
    EXPECT_EQ(made.model.points.size(), MadeFlight().model.points.size());
    ExpectSamePose(made.model, MadeFlight().model, 7);
    return reason;
  };
  test::MadeControl blind = MadeFlight();
  blind.observations.clear();
  EXPECT_NE(reason_of(blind, MiddlePhotos()).find("has 0 points with observations"), std::string::npos);
  test::MadeControl lens = MadeFlight();
  for (auto& [id, camera] : lens.model.cameras) {
    camera.model = camera::CameraModel::kFullOpencv;
    camera.params.insert(camera.params.end(), {0.0, 0.0, 0.0, 0.0});
  }
  EXPECT_NE(reason_of(lens, MiddlePhotos()).find("camera model"), std::string::npos);
}

TEST(HoldoutPoses, PhotosThatOnlyHeldOutOnesTieToTheRestAreNotAdjusted) {
  // Five strips; the outer two have no ground in common.
  test::MadeControl made = test::MakeControl({.survey = {.across_m = 36.0, .gimbal_tags = false}, .control = 0, .check = 0}, PoolOfTwo());
  ASSERT_EQ(made.model.images.size(), 30U);
  std::unordered_set<uint32_t> inner;
  for (uint32_t id = 7; id <= 24; ++id) inner.insert(id);
  std::string reason;
  EXPECT_FALSE(WithholdPhotos(inner, made.observations, made.model, PoolOfTwo(), &reason));
  EXPECT_NE(reason.find("6 of the other photos have nearly no points in common"), std::string::npos) << reason;
  EXPECT_EQ(made.model.images.size(), 30U);
}

TEST(HoldoutPoses, TagsOfResectedPhotosAreComparedAsTheirNeighbours) {
  const geo::EnuFrame frame({47.0, 8.0, 400.0});
  std::vector<input::PreparedPhoto> photos(5);
  for (size_t i = 0; i < photos.size(); ++i) {
    const Eigen::Vector3d centre(10.0 * static_cast<double>(i), 0.0, 50.0);
    photos[i].file.name = std::to_string(i);
    photos[i].cam_from_model = {Eigen::Quaterniond::Identity(), -centre};
    photos[i].gps = frame.GeodeticFromEnu(centre + Eigen::Vector3d(0.0, 1.0, -2.0));
    photos[i].file.tags.capture_time_s = 5.0 * static_cast<double>(i);
  }
  // 0 was taken after a pause, just before 4. The tag of 3 has no height.
  photos[0].file.tags.capture_time_s = 1000.0;
  photos[4].file.tags.capture_time_s = 1004.0;
  photos[3].gps->height_m = std::numeric_limits<double>::quiet_NaN();
  georeference::Georeference georeference;
  georeference.ok = true;
  georeference.origin = frame.origin();
  const Eigen::Vector3d residual_m(0.1, 0.1, 0.1);
  // Of photos 1, 2 and 4.
  georeference.photos = {{0, {0.0, -1.0, 0.0}, residual_m, true}, {0, {0.0, -1.0, 0.5}, residual_m, true}, {1, {0.0, -0.5, 2.0}, residual_m, true}};
  georeference::Georeference local = georeference;
  AddResected(photos, {"0", "3"}, georeference);
  const std::vector<georeference::TagFit>& fits = georeference.photos;
  ASSERT_EQ(fits.size(), 5U);
  const std::array<int, 5> flight{1, 0, 0, 0, 1};
  for (size_t i = 0; i < fits.size(); ++i) {
    EXPECT_EQ(fits[i].flight, flight[i]);
    EXPECT_EQ(fits[i].inlier, i != 0 && i != 3);
  }
  EXPECT_EQ(fits[0].correction_m, Eigen::Vector3d(0.0, -0.5, 2.0));
  EXPECT_EQ(fits[2].correction_m, Eigen::Vector3d(0.0, -1.0, 0.5));
  EXPECT_EQ(fits[4].residual_m, residual_m);
  EXPECT_LT((fits[0].residual_m - Eigen::Vector3d(0.0, -0.5, 0.0)).norm(), 1e-6);
  EXPECT_LT(fits[3].residual_m.head<2>().norm(), 1e-3);
  EXPECT_TRUE(std::isnan(fits[3].residual_m.z()));

  local.ok = false;
  AddResected(photos, {"0", "3"}, local);
  EXPECT_TRUE(std::isnan(local.photos[0].residual_m.x()));
  EXPECT_EQ(local.photos[0].correction_m, Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace skyquilt::prepare
