// Rigs in the bundle adjustment: cameras around one centre, and cameras apart, over points all around.
#include "prepare/bundle/shots.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "core/base/random.h"
#include "prepare/bundle/adjust_bundle.h"
#include "prepare/poses/seed/seed_rotation.h"

namespace skyquilt::test {
namespace {

using namespace prepare::bundle;

constexpr double kDegree = std::numbers::pi / 180.0;

struct RigScene {
  BundleProblem truth, noisy;
};

Eigen::Quaterniond SmallTurn(base::Random& random, double sigma_rad) {
  const Eigen::Vector3d turn(random.Normal(), random.Normal(), random.Normal());
  return Eigen::Quaterniond(Eigen::AngleAxisd(sigma_rad * turn.norm(), turn.normalized()));
}

// Four cameras that look around from each of six places; `arm_m`: of each from the rig's centre.
RigScene MakeRigScene(double arm_m, double pixel_sigma, double pose_sigma_deg) {
  base::Random random(5);
  RigScene scene;
  BundleProblem& truth = scene.truth;
  BundleLens lens;
  lens.camera = {camera::CameraModel::kPinhole, 800, 800, {400.0, 400.0, 400.0, 400.0}};
  lens.numbers = lens.initial = *LensOf(lens.camera);
  lens.exact = true;
  truth.lenses = {lens};
  for (int shot = 0; shot < 6; ++shot) {
    const RigPose pose{prepare::poses::RotationFromAngles(60.0 * shot, 3.0, -2.0),
                       {10.0 + 8.0 * std::cos(shot), 8.0 * std::sin(shot), 2.0 + 0.3 * shot}};
    for (int view = 0; view < 4; ++view) {
      BundlePhoto photo;
      photo.shot = shot;
      photo.cam_from_rig.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(90.0 * kDegree * view, Eigen::Vector3d::UnitY()));
      photo.cam_from_rig.translation = {0.0, 0.0, -arm_m};
      PlaceByRig(pose, photo);
      photo.gps = pose.centre;
      photo.gps_sigma = Eigen::Vector3d::Constant(0.05);
      truth.photos.push_back(photo);
    }
  }
  for (int k = 0; k < 600; ++k) {
    const double angle = random.Uniform(0.0, 2.0 * std::numbers::pi), radius = random.Uniform(15.0, 40.0);
    const Eigen::Vector3d point(10.0 + radius * std::cos(angle), radius * std::sin(angle), random.Uniform(-5.0, 12.0));
    for (uint32_t i = 0; i < truth.photos.size(); ++i) {
      const Eigen::Vector3d x_in_cam = truth.photos[i].cam_from_enu * (point - truth.photos[i].centre);
      const std::optional<Eigen::Vector2d> pixel = lens.camera.ImgFromCam(x_in_cam);
      if (!pixel || pixel->minCoeff() < 0.0 || pixel->maxCoeff() > 800.0) continue;
      truth.tracks.entries.push_back({i, 0});
      const double dx = random.Normal(), dy = random.Normal();
      truth.pixel.push_back(*pixel + pixel_sigma * Eigen::Vector2d(dx, dy));
    }
    truth.tracks.first.push_back(static_cast<uint32_t>(truth.tracks.entries.size()));
    truth.point.push_back(point);
  }
  truth.has_point.assign(truth.point.size(), 1);
  truth.agrees.assign(truth.pixel.size(), 1);
  scene.noisy = truth;
  for (BundlePhoto& photo : scene.noisy.photos) {
    photo.cam_from_enu = (SmallTurn(random, pose_sigma_deg * kDegree) * photo.cam_from_enu).normalized();
    const double x = random.Normal(), y = random.Normal(), z = random.Normal();
    photo.centre += 0.05 * Eigen::Vector3d(x, y, z);
  }
  return scene;
}

std::vector<uint32_t> AllTracks(const BundleProblem& bundle) {
  std::vector<uint32_t> tracks(bundle.tracks.size());
  std::iota(tracks.begin(), tracks.end(), 0U);
  return tracks;
}

double AngleWithinShots_deg(const BundleProblem& bundle) {
  double largest = 0.0;
  for (const BundlePhoto& a : bundle.photos) {
    for (const BundlePhoto& b : bundle.photos) {
      if (a.shot != b.shot) continue;
      const Eigen::Quaterniond found = a.cam_from_enu * b.cam_from_enu.conjugate();
      const Eigen::Quaterniond stated = a.cam_from_rig.rotation * b.cam_from_rig.rotation.conjugate();
      largest = std::max(largest, found.angularDistance(stated) / kDegree);
    }
  }
  return largest;
}

void ExpectRigsAreFound(double arm_m) {
  RigScene scene = MakeRigScene(arm_m, 0.3, 1.0);
  BundleProblem& bundle = scene.noisy;
  EXPECT_GT(AngleWithinShots_deg(bundle), 1.0);
  const BundleStage stage{.loss = 3.0, .gentle = true, .max_iterations = 50, .tolerance = 1e-9};
  ASSERT_TRUE(AdjustBundle(bundle, AllTracks(bundle), stage, nullptr));
  EXPECT_LT(AngleWithinShots_deg(bundle), 1e-6);
  for (size_t i = 0; i < bundle.photos.size(); ++i) {
    const BundlePhoto &found = bundle.photos[i], &truth = scene.truth.photos[i];
    EXPECT_LT(found.cam_from_enu.angularDistance(truth.cam_from_enu), 0.05 * kDegree) << i;
    EXPECT_LT((found.centre - truth.centre).norm(), 0.05) << i;
    EXPECT_NEAR((found.cam_from_rig * Eigen::Vector3d::Zero()).norm(), arm_m, 1e-12);
  }
  // An exact lens is not touched.
  EXPECT_EQ(bundle.lenses[0].numbers, scene.truth.lenses[0].numbers);
}

TEST(Shots, ViewsOfOneCentreGetOnePose) {
  ExpectRigsAreFound(0.0);
}

TEST(Shots, CamerasThatAreApartKeepTheirDistance) {
  ExpectRigsAreFound(0.4);
}

TEST(Shots, APhotoWithoutAPoseGetsThatOfItsRig) {
  RigScene scene = MakeRigScene(0.4, 0.0, 0.0);
  BundleProblem bundle = scene.truth;
  for (size_t i = 0; i < bundle.photos.size(); ++i) bundle.photos[i].placed = i % 4 == 1;
  for (size_t i = 20; i < 24; ++i) bundle.photos[i].placed = false;
  EXPECT_EQ(PlaceShots(bundle), 15U);
  for (size_t i = 0; i < 20; ++i) {
    EXPECT_LT((bundle.photos[i].centre - scene.truth.photos[i].centre).norm(), 1e-12) << i;
    EXPECT_LT(bundle.photos[i].cam_from_enu.angularDistance(scene.truth.photos[i].cam_from_enu), 1e-7) << i;
  }
  EXPECT_FALSE(bundle.photos[20].placed);
}

TEST(Shots, OneWrongPoseDoesNotMoveTheOthers) {
  RigScene scene = MakeRigScene(0.0, 0.0, 0.0);
  BundleProblem bundle = scene.truth;
  bundle.photos[0].cam_from_enu = prepare::poses::RotationFromAngles(170.0, 40.0, 0.0);
  bundle.photos[0].centre += Eigen::Vector3d(30.0, 0.0, 0.0);
  PlaceShots(bundle);
  EXPECT_LT((bundle.photos[0].centre - scene.truth.photos[0].centre).norm(), 1e-9);
  EXPECT_LT(bundle.photos[0].cam_from_enu.angularDistance(scene.truth.photos[0].cam_from_enu), 1e-7);
}

TEST(Shots, DistancesOnTheRigGiveItsScale) {
  RigScene scene = MakeRigScene(0.4, 0.0, 0.0);
  for (BundlePhoto& photo : scene.truth.photos) photo.centre *= 7.0;
  EXPECT_NEAR(RigScale(scene.truth), 1.0 / 7.0, 1e-9);
  EXPECT_EQ(RigScale(MakeRigScene(0.0, 0.0, 0.0).truth), 1.0);
}

}  // namespace
}  // namespace skyquilt::test
