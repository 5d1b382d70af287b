// The gradient of a step's loss by origin and direction of its rays against finite differences.
#include "worker/step/ray_gradients.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "core/base/random.h"
#include "tests/support/random_field.h"
#include "worker/step/field_step.h"

namespace skyquilt::worker {
namespace {

using Eigen::Vector3d;

struct Case {
  const char* name;
  bool contracted;
  encoding::Kind encoding;
  int multisample;
};

class RayGradientsTest : public ::testing::TestWithParam<Case> {
 protected:
  RayGradientsTest() : target_(render::RandomField(5, {-10, -10, 0}, {10, 10, 8}, 1.0, -1.5, GetParam().contracted, GetParam().encoding)), times_(1) {
    target_.config.multisample = GetParam().multisample;
    target_.config.sh_degree = 3;
    field_ = std::make_unique<field::HashField>(target_.config);
    base::Random random(7);
    target_.parameters.grid.resize(static_cast<size_t>(field_->GridParameters()));
    target_.parameters.networks.resize(static_cast<size_t>(field_->NetworkParameters()));
    field_->Initialize(random, target_.parameters.grid, target_.parameters.networks);
    for (float& value : target_.parameters.grid) value = random.Uniform() - 0.5F;
  }

  // One ray with fixed distances of its samples.
  StepResult Loss(const Vector3d& origin, const Vector3d& direction, RayGradients* gradients) {
    constexpr size_t kSamples = 16;
    RayBatch batch;
    const auto points = static_cast<size_t>(std::max(1, GetParam().multisample));
    batch.Clear(static_cast<int>(points));
    BatchRay ray;
    ray.ray.origin_enu = origin;
    ray.ray.direction_enu = direction;
    const std::array<float, 3> wanted = {0.2F, 0.8F, 0.4F};
    for (size_t c = 0; c < 3; ++c) {
      ray.ray.target_srgb[c] = wanted[c];
      ray.background[c] = 0.3F;
    }
    ray.count = kSamples;
    std::vector<float> x, y, z, t, sharpness(kSamples, 40.0F), length(kSamples, 1.0F);
    for (size_t s = 0; s < kSamples; ++s) {
      t.push_back(2.0F + 0.5F * static_cast<float>(s));
      for (size_t j = 0; j < points; ++j) {
        // Beside the ray by as much as the sample's other positions are.
        const Vector3d beside(0.03 * static_cast<double>(j), -0.02 * static_cast<double>(j), 0.01 * static_cast<double>(j));
        const Eigen::Vector3f at = target_.map.UnitFromEnu(origin + static_cast<double>(t.back()) * direction + beside);
        x.push_back(at.x());
        y.push_back(at.y());
        z.push_back(at.z());
      }
    }
    const std::vector<int32_t> cells(kSamples, 0);
    batch.Append(ray, x.data(), y.data(), z.data(), sharpness.data(), t.data(), length.data(), cells.data());
    batch.LayOutFeatures(field_->FeatureRows());
    field::Parameters parameters = target_.parameters;
    field::OptimizerState state;
    state.Allocate(*field_);
    FieldStep step(target_, *field_, nullptr, LuminancePlan{}, threads_, times_);
    return step.Train(batch, {.learning_rate = 1e-4}, parameters, state, nullptr, nullptr, gradients);
  }

  render::TrainedField target_;
  std::unique_ptr<field::HashField> field_;
  base::ThreadPool threads_{1};
  PhaseTimes times_;
};

TEST_P(RayGradientsTest, AgreeWithFiniteDifferences) {
  base::Random random(11);
  double disagreement = 0.0, size = 0.0, without_direction = 0.0;
  for (int round = 0; round < 12; ++round) {
    const Vector3d origin(random.Uniform(-6.0, 6.0), random.Uniform(-6.0, 6.0), 9.0);
    const Vector3d direction = Vector3d(random.Uniform(-0.4, 0.4), random.Uniform(-0.4, 0.4), -1.0).normalized();
    RayGradients gradients;
    gradients.level_shares.assign(static_cast<size_t>(field_->encoding().parts()), 1.0F);
    ASSERT_TRUE(Loss(origin, direction, &gradients).finite);
    ASSERT_EQ(gradients.rays.size(), 1U);
    for (int axis = 0; axis < 3; ++axis) {
      constexpr double kStep = 4e-4;  // so short that few samples cross into the next cell, whose slope is another
      const Vector3d along = kStep * Vector3d::Unit(axis);
      const double by_origin = (Loss(origin + along, direction, nullptr).loss - Loss(origin - along, direction, nullptr).loss) / (2.0 * kStep);
      const double by_direction = (Loss(origin, direction + along, nullptr).loss - Loss(origin, direction - along, nullptr).loss) / (2.0 * kStep);
      disagreement += std::abs(by_origin - gradients.rays[0].by_origin[axis]) + std::abs(by_direction - gradients.rays[0].by_direction[axis]);
      size += std::abs(by_origin) + std::abs(by_direction);
      without_direction += std::abs(by_direction);
    }
  }
  EXPECT_GT(without_direction, 1e-3);
  EXPECT_LT(disagreement, 0.02 * size);
}

TEST_P(RayGradientsTest, CountOnlyTheLevelsThatAreAskedFor) {
  RayGradients all, none;
  const auto parts = static_cast<size_t>(field_->encoding().parts());
  all.level_shares.assign(parts, 1.0F);
  none.level_shares.assign(parts, 0.0F);
  const StepResult with = Loss({1.0, 2.0, 9.0}, {0.0, 0.0, -1.0}, &all), without = Loss({1.0, 2.0, 9.0}, {0.0, 0.0, -1.0}, nullptr);
  Loss({1.0, 2.0, 9.0}, {0.0, 0.0, -1.0}, &none);
  EXPECT_GT(all.rays[0].by_origin.norm(), 0.0);
  EXPECT_EQ(none.rays[0].by_origin.norm(), 0.0);
  EXPECT_GT(none.rays[0].by_direction.norm(), 0.0) << "the colour depends on the direction";
  EXPECT_EQ(with.loss, without.loss);
  EXPECT_EQ(with.gradient_norm, without.gradient_norm);
}

INSTANTIATE_TEST_SUITE_P(Fields, RayGradientsTest,
                         ::testing::Values(Case{"Box", false, encoding::Kind::kHash, 0}, Case{"Contracted", true, encoding::Kind::kHash, 1},
                                           Case{"Multisampled", false, encoding::Kind::kHash, 4}, Case{"Voxels", true, encoding::Kind::kVoxels, 1}),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace skyquilt::worker
