#include <gtest/gtest.h>

#include <limits>
#include <tuple>
#include <vector>

#include "tests/support/loss_check.h"
#include "worker/losses/distortion_loss.h"
#include "worker/losses/interlevel_loss.h"
#include "worker/losses/loss.h"
#include "worker/losses/normal_loss.h"
#include "worker/losses/photo_loss.h"
#include "worker/losses/point_depth_loss.h"
#include "worker/step/ray_loss.h"

namespace skyquilt::worker {
namespace {

using testing::CheckedLoss;
using testing::ExpectLossGradient;
using Inputs = std::vector<double>;

// Photo losses have weight 1.
CheckedLoss Weighted(double weight, const PhotoLoss<double>& loss) {
  return {weight * loss.value, {weight * loss.gradient}};
}

TEST(Losses, SquaredPhotoLossHasItsGradient) {
  ExpectLossGradient([](double weight, const Inputs& x) { return Weighted(weight, SquaredPhotoLoss(x[0], 0.37)); }, {1, -0.2, 1.4});
}

TEST(Losses, TonedPhotoLossHasItsGradient) {
  ExpectLossGradient([](double weight, const Inputs& x) { return Weighted(weight, TonedPhotoLoss(x[0], 0.62)); }, {1, 0.01, 0.99});
  // Beyond its ends the curve is a straight line.
  ExpectLossGradient([](double weight, const Inputs& x) { return Weighted(weight, TonedPhotoLoss(x[0], 0.62)); }, {1, 1.01, 1.4});
  ExpectLossGradient([](double weight, const Inputs& x) { return Weighted(weight, TonedPhotoLoss(x[0], 0.62)); }, {1, -0.4, -0.01});
}

TEST(Losses, RobustLossHasItsGradient) {
  for (const double kappa : {0.3, 1.0, 20.0}) {
    ExpectLossGradient(
        [kappa](double weight, const Inputs& x) {
          const Loss<double> loss = RobustLoss(weight, x[0], kappa);
          return CheckedLoss{loss.value, {loss.gradient}};
        },
        {1, -3.0, 3.0});
  }
}

CheckedLoss Checked(const VectorLoss<double>& loss) {
  return {loss.value, {loss.gradient.x(), loss.gradient.y(), loss.gradient.z()}};
}

TEST(Losses, NormalLossHasItsGradient) {
  const Eigen::Vector3d target = Eigen::Vector3d(0.3, -0.2, 0.8).normalized();
  ExpectLossGradient(
      [&](double weight, const Inputs& x) {
        return Checked(NormalLoss<double>(weight, {x[0], x[1], x[2] + 4.0}, target));
      },
      {3, -3.0, 3.0});
}

TEST(Losses, OrientationLossHasItsGradientWhereTheSurfaceTurnsAway) {
  const Eigen::Vector3d camera = Eigen::Vector3d(0.1, 0.2, 1.0).normalized();
  ExpectLossGradient(
      [&](double weight, const Inputs& x) {
        return Checked(OrientationLoss<double>(weight, {x[0], x[1], x[2] - 4.0}, camera));
      },
      {3, -3.0, 3.0});
  EXPECT_EQ(OrientationLoss<double>(1.0, {0.1, 0.0, 2.0}, camera).value, 0.0) << "a surface that faces the camera";
  EXPECT_NEAR(OrientationLoss<double>(1.0, -7.0 * camera, camera).value, 1.0, 1e-12);
}

TEST(Losses, VectorsWithoutDirectionHaveNoNormalLoss) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& v : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1e-200, 0, 0), Eigen::Vector3d(nan, 0, 1), Eigen::Vector3d(inf, 0, 0)}) {
    for (const VectorLoss<double>& loss : {NormalLoss<double>(1.0, v, up), OrientationLoss<double>(1.0, v, up)}) {
      EXPECT_EQ(loss.value, 0.0);
      EXPECT_TRUE(loss.gradient.isZero(0.0));
    }
  }
}

TEST(Losses, RobustLossLetsGoOfFarPoints) {
  EXPECT_NEAR(RobustLoss(1.0, 1e-3, 1.0).value, 1e-6, 1e-11);
  EXPECT_NEAR(RobustLoss(1.0, 1e6, 2.0).value, 4.0, 1e-6);
  EXPECT_LT(RobustLoss(1.0, 1e3, 1.0).gradient, 1e-8);
}

TEST(Losses, PointDepthLossHasItsGradient) {
  const Inputs t = {9.0, 9.5, 10.0, 10.5, 11.0};
  ExpectLossGradient(
      [&](double weight, const Inputs& w) {
        CheckedLoss loss;
        loss.gradient.assign(t.size(), 0.0);
        loss.value = AddPointDepthLoss(weight, t.size(), w.data(), t.data(), 0.5, 10.1, 0.4, loss.gradient.data());
        return loss;
      },
      {t.size(), 0.01, 0.4});
}

// Of all distributions over the samples that with weight where the point is has the smallest loss.
TEST(Losses, PointDepthLossIsSmallestAtThePoint) {
  const Inputs t = {9.0, 9.5, 10.0, 10.5, 11.0};
  const auto loss_at = [&](size_t peak) {
    Inputs w(t.size(), 0.025), unused(t.size());
    w[peak] = 0.9;
    return AddPointDepthLoss(1.0, t.size(), w.data(), t.data(), 0.5, 10.1, 0.2, unused.data());
  };
  for (const size_t other : {0U, 1U, 3U, 4U}) EXPECT_LT(loss_at(2), loss_at(other));
}

TEST(Losses, FreeSpaceLossHasItsGradientAndCountsOnlyWhatIsBefore) {
  const Inputs t = {9.0, 9.5, 10.0, 10.5, 11.0};
  ExpectLossGradient(
      [&](double weight, const Inputs& w) {
        CheckedLoss loss;
        loss.gradient.assign(t.size(), 0.0);
        loss.value = AddFreeSpaceLoss(weight, t.size(), w.data(), t.data(), 10.2, loss.gradient.data());
        return loss;
      },
      {t.size(), 0.01, 0.4});
  const Inputs w = {0.1, 0.2, 0.3, 0.2, 0.2};
  Inputs gradient(t.size(), 0.0);
  EXPECT_DOUBLE_EQ(AddFreeSpaceLoss(2.0, t.size(), w.data(), t.data(), 10.0, gradient.data()), 0.6);
  EXPECT_EQ(gradient, (Inputs{2.0, 2.0, 0.0, 0.0, 0.0}));
}

TEST(Losses, SaturatedAndBlackPixelsAreBounds) {
  for (const auto loss : {SquaredPhotoLoss<double>, TonedPhotoLoss<double>}) {
    for (const auto& [rendered, target, counts] : {std::tuple{1.2, 1.0, false}, {0.9, 1.0, true}, {-0.1, 0.0, false}, {0.1, 0.0, true}}) {
      const PhotoLoss<double> at = loss(rendered, target);
      EXPECT_EQ(at.counts, counts) << rendered;
      EXPECT_EQ(at.value > 0.0, counts) << rendered;
      EXPECT_EQ(at.gradient != 0.0, counts) << rendered;
      EXPECT_NEAR(at.squared_error, (rendered - target) * (rendered - target), 1e-15) << "the squared error is counted in any case";
    }
  }
}

TEST(Losses, ReducedPhotosWeighMoreByLevel) {
  constexpr float kShare = 0.25F, kStep = 1e-3F;
  const auto loss_of = [&](int level, float red, ComposedGradient* gradient) {
    BatchRay ray;
    ray.ray.level = level;
    ray.ray.target_srgb[0] = ray.ray.target_srgb[1] = ray.ray.target_srgb[2] = 0.3F;
    ComposedRay composed;
    composed.rgb[0] = red;
    composed.rgb[1] = composed.rgb[2] = 0.3F;
    composed.transmittance = 0.0F;
    LossSums sums;
    *gradient = LossOfRay(ray, RayView{}, composed, kShare, sums);
    return sums.loss;
  };
  ComposedGradient full, at, unused;
  const double full_loss = loss_of(0, 0.5F, &full);
  EXPECT_NEAR(full_loss, 0.04, 1e-5);
  float weight = 1.0F;
  for (int level = 1; level < kPyramidLevels; ++level) {
    weight *= 1.5F;
    EXPECT_NEAR(loss_of(level, 0.5F, &at), static_cast<double>(weight) * full_loss, 1e-6);
    EXPECT_NEAR(at.rgb[0], weight * full.rgb[0], 1e-6F);
    EXPECT_NEAR(at.log_gain[0], weight * full.log_gain[0], 1e-6F);
    const double slope = (loss_of(level, 0.5F + kStep, &unused) - loss_of(level, 0.5F - kStep, &unused)) / (2.0 * static_cast<double>(kStep));
    EXPECT_NEAR(static_cast<double>(at.rgb[0]) / static_cast<double>(kShare), slope, 2e-3 * slope);
  }
}

TEST(Losses, EmptinessLossHasItsGradient) {
  ExpectLossGradient(
      [](double weight, const Inputs& x) {
        const Loss<double> loss = EmptinessLoss(weight, x[0]);
        return CheckedLoss{loss.value, {loss.gradient}};
      },
      {1, 0.0, 1.0});
}

TEST(Losses, MeanLossHasItsGradient) {
  ExpectLossGradient(
      [](double weight, const Inputs& x) {
        const Loss<double> loss = MeanLoss(weight, x[0]);
        return CheckedLoss{loss.value, {loss.gradient}};
      },
      {1, -2.0, 2.0});
}

// A row of rays, each of which adds its half of the loss: together the sum over pairs.
TEST(Losses, SmoothnessLossOfAGroupHasItsGradient) {
  const auto loss = [](double weight, const Inputs& x) {
    CheckedLoss sum{0.0, Inputs(x.size(), 0.0)};
    for (size_t k = 0; k < x.size(); ++k) {
      if (k > 0) AddSmoothnessLoss(weight, x[k], x[k - 1], &sum.value, &sum.gradient[k]);
      if (k + 1 < x.size()) AddSmoothnessLoss(weight, x[k], x[k + 1], &sum.value, &sum.gradient[k]);
    }
    return sum;
  };
  ExpectLossGradient(loss, {6, -1.0, 1.0});
  EXPECT_NEAR(loss(0.5, {1.0, 3.0, 2.0}).value, 0.5 * (4.0 + 1.0), 1e-15);
}

TEST(Losses, DistortionLossHasItsGradient) {
  const Inputs distance = {12.0, 12.5, 13.0, 14.5, 15.0};
  const Inputs uneven = {0.1, 2.0, 1.0, 0.5, 3.0};
  DistortionScratch<double> scratch;
  for (const double* steps : {static_cast<const double*>(nullptr), uneven.data()}) {
    ExpectLossGradient(
        [&](double weight, const Inputs& weights) {
          CheckedLoss loss{0.0, Inputs(weights.size(), 0.0)};
          loss.value = AddDistortionLoss(weight, weights.size(), weights.data(), distance.data(), 0.5, steps, 0.1, scratch, loss.gradient.data());
          return loss;
        },
        {distance.size(), 0.0, 0.4});
  }
}

TEST(Losses, DistortionOfOneSampleGrowsWithItsLength) {
  DistortionScratch<double> scratch;
  const double weight = 1.0, distance = 10.0, steps = 3.0;
  double gradient = 0.0;
  EXPECT_NEAR(AddDistortionLoss(1.0, 1, &weight, &distance, 0.5, &steps, 0.1, scratch, &gradient), 0.5 * 3.0 * 0.1 / 3.0, 1e-12);
}

// Of weights between the bounds of the field's: the loss and its gradient are zero where a proposal has at least the field's weight.
TEST(Losses, InterlevelLossHasItsGradientWhereAProposalHasTooLittle) {
  const std::vector<double> mass = {0.3, 0.05, 0.0, 0.4, 0.2};
  ExpectLossGradient(
      [&](double weight, const Inputs& weights) {
        CheckedLoss loss{0.0, Inputs(weights.size(), 0.0)};
        loss.value = AddInterlevelLoss(weight, weights.size(), mass.data(), weights.data(), loss.gradient.data());
        return loss;
      },
      {mass.size(), 0.06, 0.29});
  const Inputs enough = {0.3, 0.06, 0.0, 0.5, 0.2};
  Inputs gradient(enough.size(), 0.0);
  EXPECT_EQ(AddInterlevelLoss(1.0, mass.size(), mass.data(), enough.data(), gradient.data()), 0.0);
  EXPECT_EQ(gradient, Inputs(enough.size(), 0.0));
}

}  // namespace
}  // namespace skyquilt::worker
