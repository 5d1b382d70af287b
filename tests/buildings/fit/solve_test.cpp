#include "buildings/fit/solve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "buildings/fit/correlation.h"
#include "buildings/fit/fit_points.h"
#include "buildings/fit/roof_groups.h"
#include "buildings/fit/wall_groups.h"
#include "core/base/random.h"
#include "tests/buildings/fit/made_surface.h"

namespace skyquilt::buildings {
namespace {

// Groups of a made surface seen from the true shape, weighed as a fit does. shift_m: a random shift of each group, and what is said of it.
std::vector<Group> GroupsOf(const Shape& shape, const Parameters& parameters, const MadeSurface& made, double gsd_m, double shift_m,
                            base::Random* random) {
  const FitPoints points = PointsFor(shape, made.candidate, made.cloud);
  std::vector<Group> groups = RoofGroups(points, shape, {gsd_m, 0.4, 1.0});
  for (Group& group : WallGroups(points, shape, parameters, {gsd_m, 0.4, 1.0})) groups.push_back(group);
  for (Group& group : EdgeGroups(points, shape, parameters, {gsd_m, 0.4, 1.0})) groups.push_back(group);
  Eigen::VectorXd values = parameters.Of(shape);
  values[parameters.overhang(true)] = 0.4;
  for (Group& group : groups) {
    const double shift = shift_m * random->Normal();
    for (Observation& o : group.observations) {
      if (o.kind == ObservationKind::kRoof) o.height += shift / o.tilt;
      o.value += o.kind == ObservationKind::kRoof ? 0.0 : shift;
    }
    EstimateNoise(parameters, values, 0.01, &group);
    group.common_m = shift_m;
  }
  for (const bool pitched : {false, true}) {
    Observation prior;
    prior.kind = ObservationKind::kPrior;
    prior.parameter = parameters.overhang(pitched);
    prior.value = pitched ? 0.4 : 0.0;
    Group group;
    group.observations = {prior};
    group.sigma_m = pitched ? 10.0 : 0.001;
    groups.push_back(group);
  }
  return groups;
}

// Share of errors of all parameters of a shape within 1.96 standard deviations, over many surfaces of different noise.
double Coverage(const Shape& shape, const SurfacePlan& plan, double shift_m, int fits) {
  const Parameters parameters(shape);
  base::Random random(77);
  Eigen::VectorXd truth = parameters.Of(shape);
  truth[parameters.overhang(true)] = 0.4;
  int within = 0, all = 0;
  for (int i = 0; i < fits; ++i) {
    SurfacePlan one = plan;
    one.seed = static_cast<uint64_t>(i) + 1;
    const MadeSurface made = SurfaceOf(shape, one);
    std::vector<Group> groups = GroupsOf(shape, parameters, made, plan.gsd_m, shift_m, &random);
    Eigen::VectorXd values = truth;
    EXPECT_TRUE(Solve(groups, parameters, &values));
    const Eigen::MatrixXd covariance = CovarianceOf(groups, parameters, values);
    for (int k = 0; k < parameters.shape_size(); ++k) {
      ++all;
      if (std::abs(values[k] - truth[k]) < 1.96 * std::sqrt(covariance(k, k))) ++within;
    }
  }
  return static_cast<double>(within) / all;
}

SurfacePlan CoarsePlan(double noise_m, double waves_m) {
  SurfacePlan plan;
  plan.spacing_m = 0.5;
  plan.noise_m = noise_m;
  plan.waves_m = waves_m;
  plan.wave_length_m = 0.6;
  return plan;
}

TEST(Covariance, IsCalibratedForWhiteNoise) {
  const double share = Coverage(OnePart(RoofKind::kGable, 11, 8, 10, 13, 0.3), CoarsePlan(0.08, 0.0), 0.0, 40);
  EXPECT_GT(share, 0.88);
  EXPECT_LT(share, 0.995);
}

TEST(Covariance, IsCalibratedForCorrelatedNoise) {
  const double share = Coverage(OnePart(RoofKind::kHip, 13, 9, 10, 13, 0.3), CoarsePlan(0.03, 0.08), 0.0, 75);
  EXPECT_GT(share, 0.88);
  EXPECT_LT(share, 0.995);
}

TEST(Covariance, IsCalibratedForFlatRoofsWithCorrelatedNoise) {
  const double share = Coverage(OnePart(RoofKind::kFlat, 12, 9, 10, 10, 0.3), CoarsePlan(0.03, 0.08), 0.0, 75);
  EXPECT_GT(share, 0.88);
  EXPECT_LT(share, 0.995);
}

TEST(Covariance, CountsErrorsThatSurfacesHaveInCommon) {
  const Shape shape = OnePart(RoofKind::kGable, 11, 8, 10, 13, 0.3);
  const double share = Coverage(shape, CoarsePlan(0.05, 0.0), 0.1, 40);
  EXPECT_GT(share, 0.88);
  EXPECT_LT(share, 0.995);
}

TEST(Solve, OutliersDoNotCount) {
  const Shape shape = OnePart(RoofKind::kGable, 11, 8, 10, 13, 0.3);
  const Parameters parameters(shape);
  base::Random random(5);
  MadeSurface made = SurfaceOf(shape, CoarsePlan(0.02, 0.0));
  for (size_t i = 0; i < made.cloud.points.size(); i += 7) made.cloud.points[i].position.z() += 0.6F;
  const std::vector<Group> groups = GroupsOf(shape, parameters, made, 0.1, 0.0, &random);
  Eigen::VectorXd values = parameters.Of(shape);
  values[parameters.eave(0)] += 0.2;
  ASSERT_TRUE(Solve(groups, parameters, &values));
  EXPECT_NEAR(values[parameters.eave(0)], 10.0, 0.03);
  EXPECT_NEAR(values[parameters.ridge(0)], 13.0, 0.03);
}

TEST(Solve, ValuesThatAreNoNumbersAreRefused) {
  const Shape shape = OnePart(RoofKind::kFlat, 11, 8, 10, 10);
  const Parameters parameters(shape);
  Observation o;
  o.half_low = -1;
  o.height = std::nan("");
  Group group;
  group.observations = {o};
  Eigen::VectorXd values = parameters.Of(shape);
  const Eigen::VectorXd before = values;
  EXPECT_FALSE(Solve(std::vector<Group>{group}, parameters, &values));
  EXPECT_EQ(values, before);
}

// The integral of exp(-h^2 / (2 l^2)) over the plane is 2 pi l^2.
TEST(CorrelationArea, OfWavesAndOfWhiteNoise) {
  double waves = 0.0, white = 0.0;
  constexpr int kRuns = 12;
  for (int run = 0; run < kRuns; ++run) {
    base::Random random(static_cast<uint64_t>(run) + 1);
    std::vector<double> a, b, phase;
    for (int i = 0; i < 80; ++i) {
      a.push_back(random.Normal() / 0.8);
      b.push_back(random.Normal() / 0.8);
      phase.push_back(random.Uniform(0, 6.2832));
    }
    std::vector<Eigen::Vector2d> at;
    std::vector<double> wave, noise;
    for (double x = 0; x < 12; x += 0.4) {
      for (double y = 0; y < 12; y += 0.4) {
        at.emplace_back(x, y);
        double sum = 0.0;
        for (size_t i = 0; i < a.size(); ++i) sum += std::cos(a[i] * x + b[i] * y + phase[i]);
        wave.push_back(sum);
        noise.push_back(random.Normal());
      }
    }
    waves += CorrelationArea(at, wave, 144.0) / kRuns;
    white += CorrelationArea(at, noise, 144.0) / kRuns;
  }
  EXPECT_NEAR(waves, 2.0 * 3.1416 * 0.64, 1.6);
  EXPECT_NEAR(white, 0.16, 0.05);
}

TEST(CorrelationArea, OfNothing) {
  EXPECT_EQ(CorrelationArea({}, {}, 0.0), 0.0);
  const std::vector<Eigen::Vector2d> at(10, Eigen::Vector2d::Zero());
  const std::vector<double> same(10, 1.0);
  EXPECT_NEAR(CorrelationArea(at, same, 5.0), 0.5, 1e-12);
}

}  // namespace
}  // namespace skyquilt::buildings
