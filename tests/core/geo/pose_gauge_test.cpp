#include "core/geo/pose_gauge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/random.h"

namespace skyquilt::geo {
namespace {

using Eigen::Vector3d;

Vector3d Normal(base::Random& random, double size) {
  return size * Vector3d(random.Normal(), random.Normal(), random.Normal());
}

TEST(RotationVectors, GoThereAndBack) {
  base::Random random(1);
  for (const double size : {0.0, 1e-12, 1e-7, 1e-3, 0.1, 1.0, 3.1}) {
    const Vector3d v = size * Normal(random, 1.0).normalized();
    EXPECT_LT((VectorOfRotation(RotationOfVector(v)) - v).norm(), 1e-12) << size;
    EXPECT_NEAR(RotationOfVector(v).norm(), 1.0, 1e-14);
    Eigen::Quaterniond opposite = RotationOfVector(v);
    opposite.coeffs() *= -1.0;
    EXPECT_LT((VectorOfRotation(opposite) - v).norm(), 1e-12) << size;
  }
}

TEST(RotationVectors, HaveTheirRightJacobian) {
  base::Random random(2);
  for (const double size : {0.0, 1e-5, 1e-3, 0.3, 2.0}) {
    const Vector3d v = size * Normal(random, 1.0).normalized();
    const Eigen::Matrix3d jacobian = RightJacobianOfRotation(v);
    for (int axis = 0; axis < 3; ++axis) {
      constexpr double kStep = 1e-5;
      const Eigen::Quaterniond back = RotationOfVector(v).conjugate();
      const Vector3d more = VectorOfRotation(back * RotationOfVector(v + kStep * Vector3d::Unit(axis)));
      const Vector3d less = VectorOfRotation(back * RotationOfVector(v - kStep * Vector3d::Unit(axis)));
      EXPECT_LT((jacobian.col(axis) - (more - less) / (2.0 * kStep)).norm(), 1e-9) << size << " " << axis;
    }
  }
}

class PoseGauge : public ::testing::TestWithParam<int> {
 protected:
  // Cameras of a flight of 300 m, or in one line, that look down.
  void SetUp() override {
    base::Random random(static_cast<uint64_t>(GetParam()));
    const bool line = GetParam() % 2 == 1;
    const Vector3d away(5000.0 * random.Normal(), 5000.0 * random.Normal(), 300.0);
    for (int i = 0; i < 40; ++i) {
      Rigid3d pose;
      pose.translation = away + Vector3d(random.Uniform(-150.0, 150.0), line ? 0.0 : random.Uniform(-150.0, 150.0), random.Uniform(60.0, 80.0));
      pose.rotation = RotationOfVector(Vector3d(std::numbers::pi, 0.0, 0.0) + Normal(random, 0.3)).normalized();
      given_.push_back(pose);
      pose.rotation = (pose.rotation * RotationOfVector(Normal(random, 0.004))).normalized();  // a quarter of a degree
      pose.translation += Normal(random, 0.4);
      changed_.push_back(pose);
      weights_.push_back(i % 5 == 0 ? 0.0 : random.Uniform(0.5, 2.0));
    }
    // And a common part.
    const Similarity3d common{1.002, RotationOfVector(Normal(random, 0.005)), Normal(random, 0.5)};
    const Vector3d middle = given_[0].translation;
    for (Rigid3d& pose : changed_) {
      pose.rotation = (common.rotation * pose.rotation).normalized();
      pose.translation = middle + common * (pose.translation - middle);
    }
  }

  // By which the best similarity moves the corners of the box of all cameras and the ground below.
  double LargestMove() const {
    const Similarity3d s = SmallSimilarity(given_, changed_, weights_, 70.0);
    double largest = 0.0;
    for (const Rigid3d& pose : given_) {
      for (const double down : {0.0, 100.0}) {
        const Vector3d x = pose.translation - Vector3d(0.0, 0.0, down);
        largest = std::max(largest, (s * x - x).norm());
      }
    }
    return largest;
  }

  std::vector<Rigid3d> given_, changed_;
  std::vector<double> weights_;
};

TEST_P(PoseGauge, LeavesNoSimilarityThatMovesAPointByAMillimetre) {
  EXPECT_GT(LargestMove(), 0.1);
  RemoveSimilarity(given_, weights_, 70.0, changed_);
  EXPECT_LT(LargestMove(), 1e-3);
}

TEST_P(PoseGauge, TakesAnExactSimilarityOffWhole) {
  base::Random random(99);
  const Similarity3d common{1.003, RotationOfVector(Normal(random, 0.003)), Normal(random, 1.0)};
  const Vector3d middle = given_[1].translation;
  for (size_t i = 0; i < given_.size(); ++i) {
    changed_[i] = {(common.rotation * given_[i].rotation).normalized(), middle + common * (given_[i].translation - middle)};
  }
  RemoveSimilarity(given_, weights_, 70.0, changed_);
  for (size_t i = 0; i < given_.size(); ++i) {
    EXPECT_LT((changed_[i].translation - given_[i].translation).norm(), 1e-4);
    EXPECT_LT(VectorOfRotation(changed_[i].rotation * given_[i].rotation.conjugate()).norm(), 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(Flights, PoseGauge, ::testing::Range(1, 9));

TEST(PoseGaugeOfNothing, IsTheIdentity) {
  std::vector<Rigid3d> given(3), changed(3);
  changed[1].translation = {1.0, 2.0, 3.0};
  const std::vector<double> none(3, 0.0);
  EXPECT_EQ(SmallSimilarity(given, changed, none, 1.0).scale, 1.0);
  RemoveSimilarity(given, none, 1.0, changed);
  EXPECT_EQ(changed[1].translation, Vector3d(1.0, 2.0, 3.0));
}

}  // namespace
}  // namespace skyquilt::geo
