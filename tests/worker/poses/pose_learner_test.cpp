// Refined poses: gradients, gauge and files on their own, and as a part of training.
#include "worker/poses/pose_learner.h"

#include <algorithm>
#include <cmath>

#include "core/geo/pose_gauge.h"
#include "tests/worker/small_survey.h"

namespace skyquilt::worker {
namespace {

using Eigen::Vector3d;

class PoseLearnerTest : public SmallSurvey {
 protected:
  PoseLearner Learner(const RaySource& source) const { return PoseLearner(survey_, source, {.on = true}); }
  // A smooth function of a ray, and its derivatives.
  static double Loss(const Vector3d& origin, const Vector3d& direction) {
    return std::sin(0.3 * origin.x() + 2.0 * direction.y()) + origin.y() * direction.x() + 0.1 * origin.z() * direction.z() * direction.z();
  }
  static RayGradient GradientOf(const Vector3d& o, const Vector3d& d) {
    const double cosine = std::cos(0.3 * o.x() + 2.0 * d.y());
    return {{0.3 * cosine, d.x(), 0.1 * d.z() * d.z()}, {o.y(), 2.0 * cosine, 0.2 * o.z() * d.z()}};
  }
  // Steps with made-up gradients, different for every photo.
  static void Exercise(PoseLearner& learner, RaySource& source, int steps, int first = 0) {
    for (int step = first; step < first + steps; ++step) {
      for (int photo = 0; photo < 16; ++photo) {
        if (photo % 8 == 0) continue;
        PixelRay ray;
        ray.photo = photo;
        source.RayThrough(photo, {20.0 + step % 7, 30.0}, &ray.origin_enu, &ray.direction_enu);
        const Vector3d way(std::sin(1.0 * photo), std::cos(2.0 * photo), 0.3);
        for (int k = 0; k < 40; ++k) learner.Add(ray, {way, 20.0 * way.cross(ray.direction_enu)}, 0.01);
      }
      learner.Step(0.3, source);
    }
  }

  brightness::Response response_ = brightness::Response::Neutral(16, 1);
};

TEST_F(PoseLearnerTest, TurnsGradientsOfRaysIntoThoseOfPoses) {
  RaySource source(survey_, *pixels_, response_);
  PoseLearner learner = Learner(source);
  const int photo = 5;
  PoseVector offset;
  offset << 0.2, -0.3, 0.1, 0.5, -0.4, 0.3;  // large, so that the order of rotations matters
  for (int i = 0; i < 6; ++i) learner.state().offsets[6 * photo + static_cast<size_t>(i)] = offset[i];
  const geo::Rigid3d given = survey_.photos[photo].cam_from_enu.Inverse();
  const Vector3d in_cam = source.CameraOf(photo).RayFromImg({13.0, 40.0});
  const auto ray_at = [&](const PoseVector& x) {
    const geo::Rigid3d pose = survey::WithOffset(given, {x.head<3>(), x.tail<3>()});
    PixelRay ray;
    ray.photo = photo;
    ray.origin_enu = pose.translation;
    ray.direction_enu = pose.rotation * in_cam;
    return ray;
  };
  const PixelRay ray = ray_at(offset);
  constexpr double kShare = 0.25;
  RayGradient gradient = GradientOf(ray.origin_enu, ray.direction_enu);
  gradient.by_origin *= kShare;
  gradient.by_direction *= kShare;
  learner.Add(ray, gradient, kShare);
  PoseVector by_offset;
  for (int i = 0; i < 6; ++i) {
    constexpr double kStep = 1e-6;
    const PixelRay more = ray_at(offset + kStep * PoseVector::Unit(i)), less = ray_at(offset - kStep * PoseVector::Unit(i));
    by_offset[i] = (Loss(more.origin_enu, more.direction_enu) - Loss(less.origin_enu, less.direction_enu)) / (2.0 * kStep);
  }
  // The sparse points tell no distance here, and the photos no height: 1 m.
  const PoseWhitening whitening = WhitenPose(source.CameraOf(photo), 1.0);
  const PoseVector expected = whitening.parameters_of_phi.lazyProduct(by_offset);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(learner.state().gradient[6 * photo + static_cast<size_t>(i)], expected[i], 1e-7) << i;
}

TEST_F(PoseLearnerTest, WhitenedCoordinatesMoveThePictureByAboutAPixel) {
  for (const double distance : {5.0, 80.0}) {
    const PoseWhitening whitening = WhitenPose(survey_.cameras[0], distance);
    for (int i = 0; i < 6; ++i) {
      const double pixels = whitening.MovedPixels(whitening.parameters_of_phi.col(i));
      EXPECT_LT(pixels, 1.01) << i;
      EXPECT_GT(pixels, 0.1) << i;
    }
    // A turn about the axis by an angle moves places by their distance from the middle of the picture.
    PoseVector turn = PoseVector::Zero();
    turn[2] = 0.01;
    double squares = 0.0;
    for (int row = 0; row < 5; ++row) {
      for (int column = 0; column < 5; ++column) squares += std::pow((column - 2) * 12.8, 2) + std::pow((row - 2) * 9.6, 2);
    }
    EXPECT_NEAR(whitening.MovedPixels(turn), 0.01 * std::sqrt(squares / 25.0), 1e-4);
  }
}

TEST_F(PoseLearnerTest, KeepsTheSurveyInItsPlace) {
  RaySource source(survey_, *pixels_, response_);
  PoseLearner learner = Learner(source);
  Exercise(learner, source, 150);
  std::vector<geo::Rigid3d> given, changed;
  std::vector<double> weights;
  double largest = 0.0;
  for (int photo = 0; photo < 16; ++photo) {
    given.push_back(survey_.photos[static_cast<size_t>(photo)].cam_from_enu.Inverse());
    changed.push_back(source.PoseOf(photo));
    weights.push_back(photo % 8 == 0 ? 0.0 : 1.0);
    largest = std::max(largest, (changed.back().translation - given.back().translation).norm());
    if (photo % 8 == 0) {
      EXPECT_EQ(changed.back().translation, given.back().translation) << "held out";
    }
  }
  EXPECT_GT(largest, 0.01);
  constexpr double kArm_m = 1.0;  // no sparse points and no heights: the distance is not known
  const geo::Similarity3d s = geo::SmallSimilarity(given, changed, weights, kArm_m);
  for (const Vector3d& x : {Vector3d(-20, -20, 0), Vector3d(20, 20, 0), Vector3d(0, 0, 32)}) EXPECT_LT((s * x - x).norm(), 1e-3);
}

TEST_F(PoseLearnerTest, LearnsNothingBeforeItBeginsAndCoarseLevelsFirst) {
  RaySource source(survey_, *pixels_, response_);
  PoseLearner learner = Learner(source);
  EXPECT_FALSE(learner.ActiveAt(0.0));
  EXPECT_TRUE(learner.ActiveAt(0.5));
  learner.Step(0.0, source);
  EXPECT_EQ(RefinedPosesOf(learner.state(), survey_).photos.size(), 0U);
  const std::vector<float> early = PoseLearner::LevelShares(PoseLearner::kBegin, 8), late = PoseLearner::LevelShares(1.0, 8);
  EXPECT_EQ(early, (std::vector<float>{1, 1, 1, 1, 0, 0, 0, 0}));
  EXPECT_EQ(late, std::vector<float>(8, 1.0F));
  for (double progress = 0.0; progress < 1.0; progress += 0.05) {
    const std::vector<float> shares = PoseLearner::LevelShares(progress, 8);
    EXPECT_TRUE(std::is_sorted(shares.rbegin(), shares.rend()));
  }
  EXPECT_EQ(PoseLearner::LevelShares(0.0, 1), std::vector<float>(1, 1.0F));
}

TEST_F(PoseLearnerTest, ItsFileBringsBackAllThatStepsDependOn) {
  RaySource one(survey_, *pixels_, response_), two(survey_, *pixels_, response_);
  PoseLearner whole = Learner(one), resumed = Learner(two);
  Exercise(whole, one, 11);
  checkpoint::ArchiveWriter writer("context", 1);
  whole.Put(writer);
  writer.Commit(folder_ / "poses.h5");
  resumed.Get(checkpoint::ArchiveReader(folder_ / "poses.h5"), folder_ / "poses.h5");
  resumed.Tell(two);
  Exercise(whole, one, 6, 11);
  Exercise(resumed, two, 6, 11);
  EXPECT_EQ(resumed.state().offsets, whole.state().offsets);
  EXPECT_EQ(resumed.state().moment2, whole.state().moment2);
  EXPECT_EQ(resumed.state().rays, whole.state().rays);
  for (int photo = 0; photo < 16; ++photo) EXPECT_EQ(one.PoseOf(photo).translation, two.PoseOf(photo).translation);
  survey_.photos.pop_back();
  EXPECT_THROW(ReadRefinedPoses(checkpoint::ArchiveReader(folder_ / "poses.h5"), folder_ / "poses.h5", survey_), base::InputError);
}

class RefineTest : public PoseLearnerTest {
 protected:
  TrainJob RefiningJob(const std::string& name, int steps) const {
    TrainJob job = Job(name, steps);
    job.options.refine_poses = true;
    return job;
  }
  TrainResult Context(const TrainJob& job) const {
    base::ThreadPool threads(2);
    return TrainContext(job, Box(20.0, 0.0), threads, {});
  }
  // Moves the poses of the training photos by about a pixel, and keeps the true ones.
  void Disturb() {
    for (survey::Photo& photo : survey_.photos) photo.agl_m = 30.0;  // there are no sparse points to tell it
    true_ = survey_;
    base::Random random(17);
    std::vector<geo::Rigid3d> given, changed;
    std::vector<double> weights;
    for (const survey::Photo& photo : survey_.photos) {
      const auto error = [&random](double size) { return Vector3d(size * Vector3d(random.Normal(), random.Normal(), random.Normal())); };
      given.push_back(photo.cam_from_enu.Inverse());
      changed.push_back(survey::WithOffset(given.back(), {error(0.012), error(0.35)}));
      weights.push_back(photo.is_test ? 0.0 : 1.0);
    }
    geo::RemoveSimilarity(given, weights, 30.0, changed);
    for (size_t i = 0; i < changed.size(); ++i) {
      if (!survey_.photos[i].is_test) survey_.photos[i].cam_from_enu = changed[i].Inverse();
    }
  }
  // Root mean square distance in pixels, over the photos, between where the poses of two surveys show places of the ground.
  static double ErrorPx(const survey::Survey& a, const survey::Survey& b) {
    double squares = 0.0;
    int places = 0;
    for (size_t i = 0; i < a.photos.size(); ++i) {
      if (a.photos[i].is_test) continue;
      for (const double x : {-8.0, 0.0, 8.0}) {
        for (const double y : {-6.0, 0.0, 6.0}) {
          Vector3d place = a.photos[i].cam_from_enu.OriginInSource() + Vector3d(x, y, 0.0);
          place.z() = 0.0;
          const auto in_a = a.cameras[0].ImgFromCam(a.photos[i].cam_from_enu * place),
                     in_b = b.cameras[0].ImgFromCam(b.photos[i].cam_from_enu * place);
          squares += (*in_a - *in_b).squaredNorm();
          ++places;
        }
      }
    }
    return std::sqrt(squares / places);
  }

  survey::Survey true_;
};

TEST_F(RefineTest, BringsDisturbedPosesBackAndBlocksUseThem) {
  Disturb();
  TrainJob job = RefiningJob("context.h5", 900);
  const double before = ErrorPx(true_, survey_);
  ASSERT_GT(before, 0.6);
  ASSERT_TRUE(Context(job).ok);
  const std::optional<survey::RefinedPoses> poses = LoadContextPoses(folder_ / "context.h5", survey_);
  ASSERT_TRUE(poses.has_value());
  EXPECT_EQ(poses->photos.size(), 14U);
  survey::Survey refined = survey_;
  survey::ApplyRefinedPoses(*poses, refined);
  EXPECT_LT(ErrorPx(true_, refined), 0.5 * before);
  // The block that uses them agrees better with its photos than one that does not.
  base::ThreadPool threads(2);
  const TrainResult with = TrainBlock(RefiningJob("with.h5", 400), Box(12.0, 1.0), folder_ / "context.h5", threads, {});
  const TrainResult without = TrainBlock(Job("without.h5", 400), Box(12.0, 1.0), folder_ / "context.h5", threads, {});
  EXPECT_GT(with.final_psnr_db, without.final_psnr_db + 0.5);
}

TEST_F(RefineTest, ResumesWithTheSameBits) {
  Disturb();
  ASSERT_TRUE(Context(RefiningJob("context.h5", 120)).ok);
  TrainInterrupted(RefiningJob("resumed.h5", 120), [this](const TrainJob& job) { Context(job); });
  EXPECT_EQ(Bytes("context.h5"), Bytes("resumed.h5"));
  const auto offsets = [this](const char* name) { return checkpoint::ArchiveReader(folder_ / name).Doubles("poses/offsets"); };
  EXPECT_EQ(offsets("context.h5"), offsets("resumed.h5"));
  EXPECT_GT(*std::max_element(offsets("context.h5").begin(), offsets("context.h5").end()), 0.0);
}

TEST_F(RefineTest, ACheckpointWithoutRefinementHasNoPoses) {
  ASSERT_TRUE(Context(Job("context.h5", 20)).ok);
  const checkpoint::ArchiveReader reader(folder_ / "context.h5");
  for (const std::string& name : reader.Names()) EXPECT_EQ(name.find("poses"), std::string::npos) << name;
  EXPECT_FALSE(LoadContextPoses(folder_ / "context.h5", survey_).has_value());
}

}  // namespace
}  // namespace skyquilt::worker
