// The positions that stand for a sample's piece of space: their mean, their variances, and how far they reach.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/render/footprint.h"

namespace skyquilt::render {
namespace {

using Vectors = std::vector<Eigen::Vector3d>;

double Between(double low, double high) {
  return low + (high - low) * *rc::gen::inRange(0, 1'000'001) * 1e-6;
}

Eigen::Vector3d AnyDirection() {
  const Eigen::Vector3d d(Between(-1.0, 1.0), Between(-1.0, 1.0), Between(-1.0, 1.0));
  return d.norm() > 1e-3 ? Eigen::Vector3d(d.normalized()) : Eigen::Vector3d::UnitZ();
}

Turn AnyTurn() {
  return {Between(0.0, 2.0 * std::numbers::pi), *rc::gen::arbitrary<bool>()};
}

// A sample of a ray.
struct ConeSample {
  Ray ray;
  double t = 0.0, length_m = 0.0;
  Turn turn;
  double Width() const { return ray.Footprint(t); }
  Eigen::Vector3d Middle() const { return ray.origin_enu + t * ray.direction_enu; }
};

// A cone or a column of this width at t.
ConeSample AnySample(double t, double length_m, double width_m, bool column) {
  ConeSample sample;
  sample.t = t;
  sample.length_m = length_m;
  sample.turn = AnyTurn();
  sample.ray.origin_enu = {Between(-500.0, 500.0), Between(-500.0, 500.0), Between(-50.0, 50.0)};
  sample.ray.direction_enu = AnyDirection();
  (column ? sample.ray.pixel_width : sample.ray.pixel_pitch) = static_cast<float>(column ? width_m : width_m / t);
  return sample;
}

int SomePoints() {
  return *rc::gen::element(4, 6);
}

// Positions relative to the middle, metres, through a box of 20 m about it: a float there is exact to a thousandth of a millimetre.
Vectors AroundMiddle(const ConeSample& sample, int points) {
  const Eigen::Vector3d middle = sample.Middle(), half = Eigen::Vector3d::Constant(10.0);
  const encoding::SpaceMap map = encoding::SpaceMap::Box(middle - half, middle + half);
  float x[kMaxPositions], y[kMaxPositions], z[kMaxPositions];
  Cone(map, sample.ray, points).Positions(sample.t, sample.length_m, sample.Width(), sample.turn, x, y, z, 1);
  Vectors around;
  for (int j = 0; j < points; ++j) {
    const Eigen::Vector3d unit(static_cast<double>(x[j]), static_cast<double>(y[j]), static_cast<double>(z[j]));
    around.emplace_back(map.EnuFromUnit(unit) - middle);
  }
  return around;
}

struct Moments {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};
Moments MomentsOf(const Vectors& points) {
  Moments moments;
  const auto n = static_cast<double>(points.size());
  for (const Eigen::Vector3d& p : points) moments.mean += p / n;
  for (const Eigen::Vector3d& p : points) moments.covariance += (p - moments.mean) * (p - moments.mean).transpose() / n;
  return moments;
}

// Of a piece of space of this length along d and a square of this width across it.
Eigen::Matrix3d Covariance(const ConeSample& sample) {
  const Eigen::Vector3d& d = sample.ray.direction_enu;
  const Eigen::Matrix3d along = d * d.transpose();
  return (sample.length_m * sample.length_m * along + sample.Width() * sample.Width() * (Eigen::Matrix3d::Identity() - along)) / 12.0;
}

constexpr double kRounding_m = 5e-6;

RC_GTEST_PROP(FootprintPositions, HaveTheirMiddleAsMean, ()) {
  const bool column = *rc::gen::arbitrary<bool>();
  const ConeSample sample = AnySample(Between(5.0, 300.0), Between(0.01, 4.0), Between(0.01, 4.0), column);
  RC_ASSERT(MomentsOf(AroundMiddle(sample, SomePoints())).mean.norm() < kRounding_m);
}

// Exactly, however near the ray begins.
RC_GTEST_PROP(FootprintPositions, OfAColumnHaveTheVariancesOfItsPiece, ()) {
  const double length_m = Between(0.01, 4.0);
  const ConeSample sample = AnySample(0.5 * length_m + std::exp(Between(-10.0, 5.0)), length_m, Between(0.01, 4.0), true);
  const Eigen::Matrix3d expected = Covariance(sample);
  const double error = (MomentsOf(AroundMiddle(sample, SomePoints())).covariance - expected).norm();
  RC_ASSERT(error < 1e-4 * expected.norm() + kRounding_m * (length_m + sample.Width()));
}

// To first order in the share by which the cone grows over the interval.
RC_GTEST_PROP(FootprintPositions, OfASlowlyGrowingConeHaveTheVariancesOfItsPiece, ()) {
  const double t = std::exp(Between(2.0, 7.0)), length_m = t * Between(1e-4, 0.02);
  const double width_m = length_m * std::exp(Between(-1.5, 1.5));
  RC_PRE(std::max(length_m, width_m) < 6.0);
  const ConeSample sample = AnySample(t, length_m, width_m, false);
  const Eigen::Matrix3d covariance = MomentsOf(AroundMiddle(sample, SomePoints())).covariance, expected = Covariance(sample);
  const Eigen::Vector3d& d = sample.ray.direction_enu;
  RC_ASSERT(std::abs(d.dot(covariance * d) / (length_m * length_m / 12.0) - 1.0) < 1e-3 + kRounding_m / length_m);
  RC_ASSERT((covariance - expected).norm() < (3.0 * length_m / t + 1e-3) * expected.norm() + kRounding_m * (length_m + width_m));
}

// t_j = m + d sqrt(5/7) (2 j / 5 - 1), with the half length d (Zip-NeRF, section 3, for intervals that are short beside their distance).
RC_GTEST_PROP(FootprintPositions, OfSixLieAlongTheRayAsPublished, ()) {
  const ConeSample sample = AnySample(Between(5.0, 300.0), Between(0.01, 4.0), Between(0.01, 4.0), *rc::gen::arbitrary<bool>());
  const Vectors around = AroundMiddle(sample, 6);
  for (size_t j = 0; j < 6; ++j) {
    const double place = 2.0 * static_cast<double>(sample.turn.reversed ? 5 - j : j) / 5.0 - 1.0;
    RC_ASSERT(std::abs(around[j].dot(sample.ray.direction_enu) - 0.5 * sample.length_m * std::sqrt(5.0 / 7.0) * place) < kRounding_m);
  }
}

RC_GTEST_PROP(FootprintPositions, AreInsideTheirIntervalAndTheirCone, ()) {
  const double length_m = Between(0.01, 8.0);
  const ConeSample sample = AnySample(0.5 * length_m + std::exp(Between(-6.0, 5.0)), length_m, Between(0.01, 4.0), *rc::gen::arbitrary<bool>());
  for (const Eigen::Vector3d& p : AroundMiddle(sample, SomePoints())) {
    const double along = p.dot(sample.ray.direction_enu);
    RC_ASSERT(std::abs(along) < 0.5 * length_m);
    const double across = (p - along * sample.ray.direction_enu).norm();
    RC_ASSERT(across < 0.5 * sample.ray.Footprint(sample.t + along) + kRounding_m);
  }
}

RC_GTEST_PROP(FootprintPositions, TurnAboutTheRay, ()) {
  ConeSample sample = AnySample(Between(5.0, 300.0), Between(0.01, 4.0), Between(0.01, 4.0), *rc::gen::arbitrary<bool>());
  const int points = SomePoints();
  const Turn turn = sample.turn;
  const Vectors turned = AroundMiddle(sample, points);
  sample.turn.angle = 0.0;
  const Eigen::AngleAxisd rotation(-turn.angle, sample.ray.direction_enu);
  const Vectors straight = AroundMiddle(sample, points);
  for (size_t j = 0; j < straight.size(); ++j) RC_ASSERT((rotation * straight[j] - turned[j]).norm() < 2.0 * kRounding_m);
}

// The same places along the ray, each at another side of it.
RC_GTEST_PROP(FootprintPositions, ReversedAreMirroredAlongTheRay, ()) {
  ConeSample sample = AnySample(Between(5.0, 300.0), Between(0.01, 4.0), Between(0.01, 4.0), true);
  const int points = SomePoints();
  sample.turn.reversed = false;
  const Vectors forwards = AroundMiddle(sample, points);
  sample.turn.reversed = true;
  const Vectors backwards = AroundMiddle(sample, points);
  const Eigen::Vector3d& d = sample.ray.direction_enu;
  for (size_t j = 0; j < forwards.size(); ++j) {
    RC_ASSERT((forwards[j] - 2.0 * forwards[j].dot(d) * d - backwards[j]).norm() < 2.0 * kRounding_m);
  }
}

RC_GTEST_PROP(FootprintPositions, OfOneAreTheBitsOfTheRay, ()) {
  const ConeSample sample = AnySample(Between(0.0, 300.0), Between(0.01, 4.0), Between(0.01, 4.0), true);
  const Eigen::Vector3d low = sample.Middle() - Eigen::Vector3d(3.0, 4.0, 5.0), high = sample.Middle() + Eigen::Vector3d(70.0, 20.0, 9.0);
  const encoding::SpaceMap map = *rc::gen::arbitrary<bool>() ? encoding::SpaceMap::Contracted(low, high) : encoding::SpaceMap::Box(low, high);
  Eigen::Vector3f p;
  Cone(map, sample.ray, 1).Positions(sample.t, sample.length_m, sample.Width(), sample.turn, &p.x(), &p.y(), &p.z(), 1);
  const Eigen::Vector3f expected = UnitRay(map, sample.ray.origin_enu, sample.ray.direction_enu).At(sample.t);
  for (int axis = 0; axis < 3; ++axis) RC_ASSERT(std::bit_cast<uint32_t>(p[axis]) == std::bit_cast<uint32_t>(expected[axis]));
}

// Inside and far outside the survey: places are spread in metres, then contracted.
RC_GTEST_PROP(FootprintPositions, OfAContractedMapAreThoseOfSpaceContracted, ()) {
  const ConeSample sample = AnySample(Between(5.0, 300.0), Between(0.01, 4.0), Between(0.01, 4.0), *rc::gen::arbitrary<bool>());
  const int points = SomePoints();
  const encoding::SpaceMap map = encoding::SpaceMap::Contracted({-100.0, -80.0, -60.0}, {100.0, 80.0, 200.0});
  float x[kMaxPositions], y[kMaxPositions], z[kMaxPositions];
  Cone(map, sample.ray, points).Positions(sample.t, sample.length_m, sample.Width(), sample.turn, x, y, z, 1);
  const Vectors around = AroundMiddle(sample, points);
  for (size_t j = 0; j < around.size(); ++j) {
    const Eigen::Vector3f expected = map.UnitFromEnu(sample.Middle() + around[j]);
    RC_ASSERT((Eigen::Vector3f(x[j], y[j], z[j]) - expected).norm() < 1e-6F);
  }
}

RC_GTEST_PROP(FootprintPositions, AreFiniteWhateverTheWidth, ()) {
  const encoding::SpaceMap map = *rc::gen::arbitrary<bool>() ? encoding::SpaceMap::Contracted({-1.0, -1.0, -1.0}, {30.0, 20.0, 9.0})
                                                             : encoding::SpaceMap::Box({-1.0, -1.0, -1.0}, {30.0, 20.0, 9.0});
  ConeSample sample = AnySample(1.0, Between(0.0, 4.0), 1.0, false);
  sample.t = *rc::gen::element(0.0, 1e-300, 1e-30, 1e-6, 1.0, 1e6);
  sample.ray.pixel_pitch = *rc::gen::element(0.0F, 1e-30F, 0.01F, 1.0F);
  sample.ray.pixel_width = *rc::gen::element(0.0F, 0.1F, 1e30F);
  float x[kMaxPositions], y[kMaxPositions], z[kMaxPositions];
  const int points = SomePoints();
  Cone(map, sample.ray, points).Positions(sample.t, sample.length_m, sample.Width(), sample.turn, x, y, z, 1);
  for (int j = 0; j < points; ++j) RC_ASSERT(std::isfinite(x[j]) && std::isfinite(y[j]) && std::isfinite(z[j]));
}

RC_GTEST_PROP(FootprintPositions, OfALineAreOnIt, ()) {
  const ConeSample sample = AnySample(Between(0.0, 300.0), Between(0.01, 4.0), 0.0, true);
  for (const Eigen::Vector3d& p : AroundMiddle(sample, SomePoints())) {
    RC_ASSERT((p - p.dot(sample.ray.direction_enu) * sample.ray.direction_enu).norm() < kRounding_m);
  }
}

TEST(FootprintPositions, AreWrittenAStepApart) {
  const encoding::SpaceMap map = encoding::SpaceMap::Box({0, 0, 0}, {10, 10, 10});
  Ray ray;
  ray.origin_enu = {5.0, 5.0, 30.0};
  ray.direction_enu = {0.0, 0.0, -1.0};
  ray.pixel_pitch = 0.01F;
  constexpr size_t kStep = 3;
  for (const int points : {1, 4, 6}) {
    const auto n = static_cast<size_t>(points);
    std::array<float, kStep * kMaxPositions + 1> x, y, z;
    for (auto* v : {&x, &y, &z}) v->fill(-7.0F);
    Cone(map, ray, points).Positions(25.0, 0.5, 0.25, {}, x.data(), y.data(), z.data(), kStep);
    for (const auto* v : {&x, &y, &z}) {
      for (size_t i = 0; i < v->size(); ++i) EXPECT_EQ((*v)[i] != -7.0F, i % kStep == 0 && i / kStep < n) << points << " " << i;
    }
  }
}

// Neighbouring samples of a rendered ray see different places, and every second one the same.
TEST(FootprintPositions, AlternateAlongARenderedRay) {
  const Turn even = Turn::Alternating(0), odd = Turn::Alternating(1);
  EXPECT_NE(even.angle, odd.angle);
  EXPECT_NE(even.reversed, odd.reversed);
  for (const int index : {2, 8, 1000}) {
    EXPECT_EQ(Turn::Alternating(index).angle, even.angle);
    EXPECT_EQ(Turn::Alternating(index + 1).angle, odd.angle);
    EXPECT_EQ(Turn::Alternating(index).reversed, even.reversed);
    EXPECT_EQ(Turn::Alternating(index + 1).reversed, odd.reversed);
  }
}

}  // namespace
}  // namespace skyquilt::render
