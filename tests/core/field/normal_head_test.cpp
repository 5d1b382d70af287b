// The head that predicts normals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/field/optimizer.h"
#include "core/kernel/reference.h"
#include "tests/support/encoding_reference.h"

namespace skyquilt::field {
namespace {

FieldConfig ConfigOf(bool normal_head, bool luminance) {
  FieldConfig config;
  config.grid.levels = 2;
  config.grid.log2_table_size = 6;
  config.grid.base_resolution = 2;
  config.grid.finest_resolution = 7;
  config.hidden = 8;
  config.normal_head = normal_head;
  config.luminance = luminance;
  return config;
}

TEST(NormalHead, AppendsItsWeightsAndChangesNoOthers) {
  for (const bool luminance : {false, true}) {
    const HashField without(ConfigOf(false, luminance)), with(ConfigOf(true, luminance));
    EXPECT_EQ(with.NetworkParameters(), without.NetworkParameters() + kNormalRows * kGeometryRows);
    EXPECT_EQ(with.NormalHeadOffset(), without.NetworkParameters());
    Parameters plain, headed;
    plain.Allocate(without);
    headed.Allocate(with);
    base::Random first(3), second(3);
    without.Initialize(first, plain.grid, plain.networks);
    with.Initialize(second, headed.grid, headed.networks);
    EXPECT_EQ(plain.grid, headed.grid);
    EXPECT_TRUE(std::equal(plain.networks.begin(), plain.networks.end(), headed.networks.begin()));
    const auto head = headed.networks.begin() + with.NormalHeadOffset();
    EXPECT_TRUE(std::all_of(head, head + 3 * kGeometryRows, [](float w) { return w != 0.0F && std::abs(w) < 1.0F; }));
    EXPECT_TRUE(std::all_of(head + 3 * kGeometryRows, headed.networks.end(), [](float w) { return w == 0.0F; })) << "padding";
    EXPECT_THROW(without.Prepare(headed.networks), std::invalid_argument);
  }
}

TEST(NormalHead, IsRefusedWithoutOne) {
  const HashField without(ConfigOf(false, false));
  std::vector<float> rows(size_t{kGeometryRows} * kernel::kPad, 0.0F), raw(size_t{kNormalRows} * kernel::kPad);
  const NetworkWeights weights = without.Prepare(std::vector<float>(static_cast<size_t>(without.NetworkParameters()), 0.1F));
  EXPECT_THROW(without.PredictNormals(weights, rows.data(), kernel::kPad, kernel::kPad, raw.data(), kernel::kPad), std::logic_error);
}

// The loss is sum_s u_s . raw_s, for fixed u.
TEST(NormalHead, GradientsMatchDifferencesInDoubleAndStopWhereAsked) {
  constexpr size_t kSamples = 5;
  const HashField field(ConfigOf(true, true));
  base::Random random(5);
  Parameters parameters;
  parameters.Allocate(field);
  field.Initialize(random, parameters.grid, parameters.networks);
  for (float& value : parameters.grid) value = random.Uniform() - 0.5F;
  std::vector<float> x(3 * kSamples), u(3 * kSamples);
  for (float& value : x) value = random.Uniform();
  for (float& value : u) value = random.Uniform() - 0.5F;
  const kernel::Positions at{x.data(), x.data() + kSamples, x.data() + 2 * kSamples};
  const NetworkWeights weights = field.Prepare(parameters.networks);
  Activations a;
  a.Reserve(field, kSamples);
  const auto rows = static_cast<size_t>(field.FeatureRows());
  const auto backward = [&](bool stopped, std::vector<float>* features) {
    features->assign(rows * a.stride, 0.0F);
    field.EncodeSerial(parameters.grid, at, kSamples, features->data(), a.stride);
    field.Density(weights, features->data(), a.stride, kernel::kPad, a.density_hidden, a.stride, a.geometry(), a.stride);
    std::vector<float> raw(kNormalRows * a.stride), raw_gradient(kNormalRows * a.stride, 0.0F), geometry_gradient(kGeometryRows * a.stride, 0.0F);
    field.PredictNormals(weights, a.geometry(), a.stride, kernel::kPad, raw.data(), a.stride);
    for (size_t s = 0; s < kSamples; ++s) {
      for (size_t axis = 0; axis < 3; ++axis) raw_gradient[axis * a.stride + s] = u[axis * kSamples + s];
      EXPECT_EQ(raw[3 * a.stride + s], 0.0F);
    }
    std::vector<float> gradient(parameters.networks.size(), 0.0F);
    field.NormalHeadBackward(weights, raw_gradient.data(), a.stride, a.geometry(), a.stride, kernel::kPad,
                             stopped ? nullptr : geometry_gradient.data(), gradient.data());
    field.Backward(weights, a, features->data(), a.stride, kernel::kPad, gradient.data(), stopped ? nullptr : geometry_gradient.data());
    return gradient;
  };
  std::vector<float> feature_gradient, stopped_feature_gradient;
  const std::vector<float> gradient = backward(false, &feature_gradient), stopped = backward(true, &stopped_feature_gradient);

  const std::vector<double> grid(parameters.grid.begin(), parameters.grid.end());
  std::vector<double> networks(parameters.networks.begin(), parameters.networks.end());
  const auto hidden = static_cast<size_t>(field.config().hidden);
  const auto loss = [&] {
    double sum = 0.0;
    for (size_t s = 0; s < kSamples; ++s) {
      const double p[3] = {static_cast<double>(x[s]), static_cast<double>(x[kSamples + s]), static_cast<double>(x[2 * kSamples + s])};
      std::vector<double> in = testing::EncodeInDouble(field.encoding(), field.config().grid, grid, p);
      auto next = networks.begin();
      const auto take = [&](size_t n) { return std::vector<double>(std::exchange(next, next + static_cast<ptrdiff_t>(n)), next); };
      const std::vector<double> first = take(hidden * rows);
      in = kernel::reference::Dense(first, static_cast<int>(hidden), in, true);
      const std::vector<double> second = take(kGeometryRows * hidden);
      in = kernel::reference::Dense(second, kGeometryRows, in, false);
      const std::vector<double> head(networks.begin() + field.NormalHeadOffset(), networks.end());
      const std::vector<double> raw = kernel::reference::Dense(head, kNormalRows, in, false);
      for (size_t axis = 0; axis < 3; ++axis) sum += static_cast<double>(u[axis * kSamples + s]) * raw[axis];
    }
    return sum;
  };
  const auto head_begin = static_cast<size_t>(field.NormalHeadOffset());
  const size_t density_end = hidden * rows + kGeometryRows * hidden;
  double passed = 0.0;
  for (size_t i = 0; i < networks.size(); ++i) {
    if (i >= head_begin + size_t{3} * kGeometryRows) break;  // padding
    const double keep = networks[i];
    constexpr double kStep = 1e-5;
    networks[i] = keep + kStep;
    const double above = loss();
    networks[i] = keep - kStep;
    const double numeric = (above - loss()) / (2.0 * kStep);
    networks[i] = keep;
    EXPECT_NEAR(static_cast<double>(gradient[i]), numeric, 1e-5 * std::max(1.0, std::abs(numeric))) << i;
    if (i < density_end) passed += std::abs(numeric);
    EXPECT_EQ(stopped[i], i >= head_begin ? gradient[i] : 0.0F) << i;
  }
  EXPECT_GT(passed, 0.1);
  EXPECT_TRUE(
      std::all_of(gradient.begin() + static_cast<ptrdiff_t>(head_begin) + 3 * kGeometryRows, gradient.end(), [](float g) { return g == 0.0F; }));
  EXPECT_TRUE(std::all_of(stopped_feature_gradient.begin(), stopped_feature_gradient.end(), [](float g) { return g == 0.0F; }));
  EXPECT_TRUE(std::any_of(feature_gradient.begin(), feature_gradient.end(), [](float g) { return g != 0.0F; }));
}

}  // namespace
}  // namespace skyquilt::field
