#include "bench/numerics/reference_trainer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bench/numerics/numeric_case.h"
#include "bench/numerics/synthetic_trainer.h"
#include "core/encoding/encoding.h"
#include "core/encoding/spherical_harmonics.h"
#include "tests/support/gradient_check.h"

namespace skyquilt::bench {
namespace {

SyntheticOptions TinyScene() {
  SyntheticOptions scene;
  scene.levels = 2;
  scene.log2_table_size = 4;
  scene.hidden = 4;
  scene.voxel_m = 0.5;
  return scene;
}

// Exposures of plus and minus one stop, and some empty rays, so that every loss is used.
const SyntheticRays kMixedRays{.rays = 12, .empty_share = 0.25F, .most_stops = 1.0F};

// Points, and cones with each number of positions; with and without rows that tell the scale; other activations of density; codes of photos.
struct Kind {
  const char* name;
  int multisample = 0;
  bool scale_features = false;
  field::DensityActivation activation = field::DensityActivation::kExp;
  int appearance = 0;
};

void SetKind(const Kind& kind, SyntheticOptions* scene) {
  scene->multisample = kind.multisample;
  scene->scale_features = kind.scale_features;
  scene->density_activation = kind.activation;
  scene->appearance = kind.appearance;
}

// Codes as after some training.
void FillCodes(base::Random& random, SyntheticTrainer& trainer) {
  for (float& number : trainer.codes().state().codes) number = random.Uniform() - 0.5F;
}

// Samples of other lengths than one step, as at the far end of a ray and for wide pixels.
void ChangeLengths(base::Random& random, worker::RayBatch* batch) {
  for (float& length : batch->unit_length) length *= 0.5F + random.Uniform();
}

class ReferenceGradients : public ::testing::TestWithParam<Kind> {};

TEST_P(ReferenceGradients, MatchFiniteDifferencesInDouble) {
  SyntheticOptions scene = TinyScene();
  SetKind(GetParam(), &scene);
  SyntheticTrainer trainer(scene, 3, 1);
  const ReferenceTrainer reference(trainer.target(), trainer.field());
  base::Random random(5);
  SyntheticRays rays = kMixedRays;
  rays.least_width_m = 0.05;
  rays.most_width_m = scene.edge_m;
  worker::RayBatch batch = trainer.Draw(rays, random);
  ChangeLengths(random, &batch);
  FillCodes(random, trainer);
  ReferenceState state = ReferenceState::From(trainer.state(), trainer.codes().state());
  for (double& value : state.grid) value = random.Uniform(-0.5, 0.5);  // large enough to matter
  std::vector<double> grid, networks, codes;
  const double distortion = 0.05;
  const ReferenceResult at = reference.Gradient(batch, state, distortion, &grid, &networks, &codes);
  EXPECT_GT(at.loss, 0.01);
  const auto loss_with = [&](std::vector<double> ReferenceState::*part) {
    return [&, part](const std::vector<double>& values) {
      ReferenceState moved = state;
      moved.*part = values;
      return reference.Gradient(batch, moved, distortion, nullptr, nullptr).loss;
    };
  };
  testing::ExpectGradient(loss_with(&ReferenceState::grid), state.grid, grid, 1e-7);
  testing::ExpectGradient(loss_with(&ReferenceState::networks), state.networks, networks, 1e-7);
  testing::ExpectGradient(loss_with(&ReferenceState::codes), state.codes, codes, 1e-7);
  const auto nonzero = [](const std::vector<double>& values) {
    return std::count_if(values.begin(), values.end(), [](double v) { return v != 0.0; });
  };
  EXPECT_GT(nonzero(grid), 20);
  EXPECT_GT(nonzero(networks), 80);
  EXPECT_GT(nonzero(codes), GetParam().appearance > 0 ? 8 : -1);
}

// Behind opaque samples; in several packets, from which the trainer drops them before the backward pass.
TEST_P(ReferenceGradients, AreTheWorkersWithHiddenSamples) {
  SyntheticOptions scene;
  scene.log2_table_size = 8;
  scene.hidden = 8;
  SetKind(GetParam(), &scene);
  SyntheticTrainer trainer(scene, 3, 2);
  base::Random random(9);
  for (float& value : trainer.state().parameters.grid) value = 60.0F * (random.Uniform() - 0.5F);
  FillCodes(random, trainer);
  SyntheticRays rays{.rays = 150, .empty_share = 0.1F, .most_stops = 1.0F, .least_width_m = 0.05, .most_width_m = 1.0};
  worker::RayBatch batch = trainer.Draw(rays, random);
  ChangeLengths(random, &batch);
  ASSERT_GT(batch.packets.size(), 3U);
  const ReferenceTrainer reference(trainer.target(), trainer.field());
  std::vector<double> grid, networks, codes;
  const ReferenceResult exact =
      reference.Gradient(batch, ReferenceState::From(trainer.state(), trainer.codes().state()), 1e-2, &grid, &networks, &codes);
  const SyntheticTrainer::Gradients seen = trainer.GradientsOf(batch, 1e-2);
  EXPECT_EQ(seen.result.n_live, exact.live);
  EXPECT_LT(10 * exact.live, 9 * batch.n_samples);
  EXPECT_GT(10 * exact.live, batch.n_samples);
  EXPECT_NEAR(seen.result.loss, exact.loss, 1e-5 * exact.loss);
  EXPECT_LT(RelativeDistance(seen.grid, grid), 1e-4);
  EXPECT_LT(RelativeDistance(seen.networks, networks), 1e-4);
  ASSERT_EQ(seen.codes.size(), codes.size());
  if (!codes.empty()) {
    EXPECT_LT(RelativeDistance(seen.codes, codes), 1e-4);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, ReferenceGradients,
                         ::testing::Values(Kind{"points"}, Kind{"cones", 1}, Kind{"cones_with_scales", 1, true}, Kind{"cones_of_4", 4},
                                           Kind{"cones_of_6", 6}, Kind{"cones_of_6_with_scales", 6, true},
                                           Kind{"softplus", 0, false, field::DensityActivation::kSoftplus},
                                           Kind{"relu", 1, true, field::DensityActivation::kRelu},
                                           Kind{"codes_of_5", 0, false, field::DensityActivation::kExp, 5},
                                           Kind{"codes_of_8_and_softplus", 1, true, field::DensityActivation::kSoftplus, 8}),
                         [](const auto& of) { return of.param.name; });

// Footprints as large as the scene leave less of the fine level than of the coarse one.
TEST(ReferenceField, FootprintsFadeFineLevelsFirst) {
  const SyntheticTrainer trainer(TinyScene(), 3, 1);
  const ReferenceField reference(trainer.field());
  const std::vector<double> grid(static_cast<size_t>(trainer.field().GridParameters()), 1.0);
  const auto features = [&](double deviation) { return reference.Features(grid, {{{0.3, 0.4, 0.2}}, deviation}); };
  for (const double feature : features(0.0)) EXPECT_NEAR(feature, 1.0, 1e-12);
  // 4 cells per unit length: erf(1 / (sqrt(8) 0.1 4)).
  EXPECT_NEAR(features(0.1)[0], std::erf(1.0 / (std::sqrt(8.0) * 0.4)), 1e-12);
  EXPECT_LT(features(0.1).back(), features(0.1)[0]);
  for (const double feature : features(kEver)) EXPECT_EQ(feature, 0.0);
}

// Of two levels the finer one has a row, with three rows of padding.
TEST(ReferenceField, ScalesAreWhatTheFootprintHides) {
  SyntheticOptions scene = TinyScene();
  scene.multisample = 6;
  EXPECT_TRUE(ReferenceField(SyntheticTrainer(scene, 3, 1).field()).Scales({{{0.3, 0.4, 0.2}}, 0.1}).empty());
  scene.scale_features = true;
  const SyntheticTrainer trainer(scene, 3, 1);
  const ReferenceField reference(trainer.field());
  const auto scales = [&](double deviation) { return reference.Scales({{{0.3, 0.4, 0.2}}, deviation}); };
  EXPECT_EQ(scales(0.0), std::vector<double>(4, 0.0));
  EXPECT_EQ(scales(kEver), (std::vector<double>{1.0, 0.0, 0.0, 0.0}));
  const double cells = encoding::LevelResolution(trainer.field().config().grid, 1);
  EXPECT_NEAR(scales(0.1)[0], std::erfc(1.0 / (std::sqrt(8.0) * 0.1 * cells)), 1e-9);
}

// Two implementations of the same functions, in the order and with the signs of Sloan 2013.
TEST(ReferenceField, HarmonicsEqualTheFields) {
  base::Random random(7);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d d = i == 0 ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d{random.Normal(), random.Normal(), random.Normal()}.normalized();
    double own[16];
    encoding::SphericalHarmonics(d.x(), d.y(), d.z(), 4, own);
    const std::vector<double> values = ReferenceHarmonics({d.x(), d.y(), d.z()}, 4);
    ASSERT_EQ(values.size(), 16U);
    for (size_t k = 0; k < values.size(); ++k) EXPECT_NEAR(values[k], own[k], 1e-12) << k;
  }
}

TEST(ReferenceTrainer, LearnsAndDoesNotChangeUntouchedEntries) {
  SyntheticTrainer trainer(TinyScene(), 3, 1);
  const ReferenceTrainer reference(trainer.target(), trainer.field());
  base::Random random(5);
  ReferenceState state = ReferenceState::From(trainer.state());
  const worker::RayBatch one = trainer.Draw({.rays = 1}, random);
  const ReferenceState before = state;
  reference.Step(one, {.learning_rate = 1e-3}, state);
  size_t moved = 0;
  for (size_t i = 0; i < state.grid.size(); ++i) {
    if (state.grid[i] == before.grid[i]) {
      EXPECT_EQ(state.grid_moment2[i], 0.0) << i;
    } else {
      // The size of Adam's first step is the learning rate.
      EXPECT_NEAR(std::abs(state.grid[i] - before.grid[i]), 1e-3, 1e-6) << i;
      ++moved;
    }
  }
  EXPECT_GT(moved, 4U);
  EXPECT_LT(moved, state.grid.size());
  double first = 0.0, last = 0.0;
  for (int step = 0; step < 150; ++step) {
    const ReferenceResult result = reference.Step(trainer.Draw({.rays = 32}, random), {.learning_rate = 1e-2}, state);
    if (step < 10) first += result.squared_error;
    if (step >= 140) last += result.squared_error;
  }
  EXPECT_LT(last, 0.7 * first);
}

// Adam and the zero mean of codes, of which some photos have none yet.
TEST(ReferenceTrainer, StepsCodesAsTheWorker) {
  SyntheticOptions scene = TinyScene();
  scene.appearance = 5;
  SyntheticTrainer trainer(scene, 3, 2);
  const ReferenceTrainer reference(trainer.target(), trainer.field());
  base::Random random(5);
  ReferenceState state = ReferenceState::From(trainer.state(), trainer.codes().state());
  for (int step = 0; step < 12; ++step) {
    const worker::RayBatch batch = trainer.Draw({.rays = step < 6 ? 3 : 24, .empty_share = 0.2F}, random);
    trainer.Train(batch, {.learning_rate = 1e-3});
    reference.Step(batch, {.learning_rate = 1e-3}, state);
    const worker::AppearanceCodes::State& seen = trainer.codes().state();
    EXPECT_EQ(seen.steps, state.code_steps);
    EXPECT_EQ(std::count(seen.steps.begin(), seen.steps.end(), 0), step < 6 ? 2 : 0);
    for (size_t i = 0; i < state.codes.size(); ++i) EXPECT_NEAR(seen.codes[i], state.codes[i], 2e-5) << step << " " << i;
  }
  EXPECT_GT(*std::max_element(state.codes.begin(), state.codes.end()), 1e-3) << "nothing was learned";
}

TEST_P(ReferenceGradients, AreTheWorkersFromTheSameStart) {
  SyntheticOptions scene = TinyScene();
  SetKind(GetParam(), &scene);
  SyntheticTrainer trainer(scene, 3, 1);
  const ReferenceTrainer reference(trainer.target(), trainer.field());
  base::Random random(5);
  SyntheticRays rays = kMixedRays;
  rays.least_width_m = 0.05;
  rays.most_width_m = scene.edge_m;
  worker::RayBatch batch = trainer.Draw(rays, random);
  ChangeLengths(random, &batch);
  std::vector<double> grid, networks, codes;
  const ReferenceResult exact =
      reference.Gradient(batch, ReferenceState::From(trainer.state(), trainer.codes().state()), 1e-2, &grid, &networks, &codes);
  const SyntheticTrainer::Gradients seen = trainer.GradientsOf(batch, 1e-2);
  EXPECT_NEAR(seen.result.loss, exact.loss, 1e-5 * exact.loss);
  EXPECT_EQ(seen.result.n_live, exact.live);
  for (size_t i = 0; i < networks.size(); ++i) EXPECT_NEAR(seen.networks[i], networks[i], 1e-6) << i;
  for (size_t i = 0; i < grid.size(); ++i) EXPECT_NEAR(seen.grid[i], grid[i], 1e-6) << i;
  ASSERT_EQ(seen.codes.size(), codes.size());
  for (size_t i = 0; i < codes.size(); ++i) EXPECT_NEAR(seen.codes[i], codes[i], 1e-6) << i;
}

}  // namespace
}  // namespace skyquilt::bench
