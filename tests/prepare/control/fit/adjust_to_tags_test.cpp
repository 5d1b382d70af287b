#include "prepare/control/fit/adjust_to_tags.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/base/random.h"
#include "core/geo/enu_frame.h"
#include "prepare/bundle/adjust_bundle.h"
#include "prepare/control/fit/control_bundle.h"
#include "prepare/control/fit/update_model.h"
#include "prepare/georeference/dome_fit.h"
#include "tests/prepare/control/fit/made_control.h"

namespace skyquilt::test {
namespace {

using namespace prepare::control;

base::ThreadPool& TwoThreads() {
  static base::ThreadPool threads(2);
  return threads;
}

constexpr size_t kK1 = 4;  // of a Lens

// The same photos with another k1: what a reconstruction looks like whose lens is wrong by as much.
void Bend(double k1_change, MadeControl* made) {
  const ControlPoints none;
  ControlBundle bundle = MakeControlBundle({.model = made->model, .observations = made->observations, .photos = made->photos, .control = none});
  const std::vector<prepare::bundle::BundlePhoto> before = bundle.bundle.photos;
  bundle.bundle.lenses[0].numbers[kK1] += k1_change;
  for (prepare::bundle::BundlePhoto& photo : bundle.bundle.photos) {
    photo.gps = photo.centre;
    photo.gps_sigma = Eigen::Vector3d::Constant(3.0);
  }
  std::vector<uint32_t> tracks(bundle.n_ties);
  std::iota(tracks.begin(), tracks.end(), 0U);
  ASSERT_TRUE(prepare::bundle::AdjustBundle(bundle.bundle, tracks,
                                            {.loss = 2.5, .gentle = true, .free_lens = false, .max_iterations = 60, .tolerance = 1e-9}, {}));
  UpdateModel(bundle, {}, before, true, made->model);
  for (size_t i = 0; i < made->photos.size(); ++i) made->photos[i].cam_from_model = made->model.images[i].cam_from_world;
}

// Tags at the true positions with so much noise.
void Tag(double horizontal_m, double vertical_m, MadeControl* made) {
  const geo::EnuFrame frame(kMadeOrigin);
  base::Random random(5, 1);
  for (size_t i = 0; i < made->photos.size(); ++i) {
    const Eigen::Vector3d noise{horizontal_m * random.Normal(), horizontal_m * random.Normal(), vertical_m * random.Normal()};
    made->photos[i].gps = frame.GeodeticFromEnu(made->true_poses[i].OriginInSource() + noise);
  }
}

// Of the model's cameras against the truth.
double DomeOf(const MadeControl& made) {
  std::vector<prepare::georeference::HeightDifference> differences;
  for (size_t i = 0; i < made.true_poses.size(); ++i) {
    const Eigen::Vector3d truth = made.true_poses[i].OriginInSource();
    differences.push_back({truth.head<2>(), made.model.images[i].cam_from_world.OriginInSource().z() - truth.z()});
  }
  return prepare::georeference::FitDome(differences).height_m;
}

TagJob JobOf(MadeControl& made) {
  return {.model = made.model, .observations = made.observations, .photos = made.photos, .origin = kMadeOrigin, .enu_from_model = {}};
}

const ControlPlan kPlan = {.survey = {.strips = 7, .per_strip = 9, .gimbal_tags = false}, .control = 0, .check = 0};

TEST(AdjustToTags, HoldsTheFocalLengthWhenAsked) {
  ControlPlan plan = kPlan;
  plan.survey.strips = 4;
  plan.survey.per_strip = 5;
  for (const bool hold : {true, false}) {
    MadeControl made = MakeControl(plan, TwoThreads());
    Tag(0.3, 0.5, &made);
    const uint32_t camera_id = made.model.images[0].camera_id;
    const double before_px = made.model.cameras.at(camera_id).FocalX();
    TagJob job = JobOf(made);
    job.hold_focal = hold;
    const AdjustedToTags result = AdjustToTags(job, TwoThreads());
    ASSERT_TRUE(result.adjusted) << result.reason;
    EXPECT_EQ(made.model.cameras.at(camera_id).FocalX() == before_px, hold);
  }
}

TEST(AdjustToTags, StraightensABentReconstruction) {
  for (const double sigma_m : {0.02, 0.3}) {
    MadeControl made = MakeControl(kPlan, TwoThreads());
    Bend(0.02, &made);
    Tag(sigma_m, sigma_m, &made);
    const double before_m = DomeOf(made);
    EXPECT_GT(std::abs(before_m), 1.0);
    const AdjustedToTags result = AdjustToTags(JobOf(made), TwoThreads());
    ASSERT_TRUE(result.adjusted) << result.reason;
    EXPECT_LT(std::abs(DomeOf(made)), 0.1 + 0.5 * sigma_m) << "tags of " << sigma_m << " m, before " << before_m << " m";
    EXPECT_LT(result.error_after, 1.02 * result.error_before);
    EXPECT_NEAR(made.model.cameras.begin()->second.FocalX(), made.true_focal_px, 6.0);
  }
}

TEST(AdjustToTags, ChangesNothingThatItCannotAdjust) {
  MadeControl made = MakeControl(kPlan, TwoThreads());
  Tag(0.02, 0.02, &made);
  const Eigen::Vector3d before = made.model.images[3].cam_from_world.translation;
  MadeControl few = made;
  for (size_t i = 9; i < few.photos.size(); ++i) few.photos[i].gps.reset();
  EXPECT_EQ(AdjustToTags(JobOf(few), TwoThreads()).reason, "too few GPS tags");
  EXPECT_EQ(few.model.images[3].cam_from_world.translation, before);
  MadeControl blind = made;
  blind.observations.clear();
  EXPECT_NE(AdjustToTags(JobOf(blind), TwoThreads()).reason.find("too few points"), std::string::npos);
  MadeControl lens = made;
  for (auto& [id, camera] : lens.model.cameras) {
    camera.model = camera::CameraModel::kFullOpencv;
    camera.params.insert(camera.params.end(), {0.0, 0.0, 0.0, 0.0});
  }
  EXPECT_NE(AdjustToTags(JobOf(lens), TwoThreads()).reason.find("camera model"), std::string::npos);
}

TEST(AdjustToTags, TagsThatThePhotosContradictDoNotBend) {
  MadeControl made = MakeControl(kPlan, TwoThreads());
  Tag(0.02, 0.02, &made);
  const geo::EnuFrame frame(kMadeOrigin);
  // Every other strip 6 m too far east: no lens does that.
  for (size_t i = 0; i < made.photos.size(); ++i) {
    if (i / 9 % 2 == 0) made.photos[i].gps = frame.GeodeticFromEnu(frame.EnuFromGeodetic(*made.photos[i].gps) + Eigen::Vector3d(6.0, 0.0, 0.0));
  }
  const AdjustedToTags result = AdjustToTags(JobOf(made), TwoThreads());
  ASSERT_TRUE(result.adjusted) << result.reason;
  EXPECT_LT(result.error_after, 1.1 * result.error_before);
  EXPECT_LT(std::abs(DomeOf(made)), 0.1);
  // Neighbours of different strips are as far apart as they were, not by the tags.
  double worst_m = 0.0;
  for (size_t i = 0; i + 9 < made.true_poses.size(); ++i) {
    const auto apart = [&](const geo::Rigid3d& a, const geo::Rigid3d& b) { return (a.OriginInSource() - b.OriginInSource()).norm(); };
    const double found_m = apart(made.model.images[i].cam_from_world, made.model.images[i + 9].cam_from_world);
    worst_m = std::max(worst_m, std::abs(found_m - apart(made.true_poses[i], made.true_poses[i + 9])));
  }
  EXPECT_LT(worst_m, 0.5);
}

TEST(AdjustToTags, IsTheSameWithAnyNumberOfThreads) {
  MadeControl made = MakeControl({.survey = {.gimbal_tags = false}, .control = 0, .check = 0}, TwoThreads());
  Tag(0.05, 0.05, &made);
  MadeControl again = made;
  base::ThreadPool one(1);
  ASSERT_TRUE(AdjustToTags(JobOf(made), TwoThreads()).adjusted);
  ASSERT_TRUE(AdjustToTags(JobOf(again), one).adjusted);
  for (size_t i = 0; i < made.model.images.size(); ++i) {
    EXPECT_EQ(made.model.images[i].cam_from_world.translation, again.model.images[i].cam_from_world.translation);
  }
}

}  // namespace
}  // namespace skyquilt::test
