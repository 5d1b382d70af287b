// The gradient of the log density by position and its backward pass, against differences of a field in double.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/base/errors.h"
#include "core/encoding/hash_grid.h"
#include "core/field/optimizer.h"
#include "core/kernel/reference.h"

namespace skyquilt::field {
namespace {

constexpr size_t kPositions = 6;
constexpr size_t kPlane = kPositions + 1;

struct Shape {
  int multisample = 0;
  bool scale_features = false;
  int density_hidden_layers = 1;
};

FieldConfig ConfigOf(const Shape& shape) {
  FieldConfig config;
  config.grid.levels = 3;
  config.grid.log2_table_size = 6;
  config.grid.base_resolution = 2;
  config.grid.finest_resolution = 11;
  config.grid.extent[2] = 0.4;
  config.hidden = 8;
  config.multisample = shape.multisample;
  config.scale_features = shape.scale_features;
  config.density_hidden_layers = shape.density_hidden_layers;
  return config;
}

class DensityGradient : public ::testing::TestWithParam<Shape> {
 protected:
  void SetUp() override {
    base::Random random(23);
    parameters_.Allocate(field_);
    field_.Initialize(random, parameters_.grid, parameters_.networks);
    for (float& value : parameters_.grid) value = random.Uniform() - 0.5F;  // large enough to matter
    points_ = std::max(1, GetParam().multisample);
    const size_t n = kPlane * static_cast<size_t>(points_);
    for (std::vector<float>* v : {&x_, &y_, &z_}) v->resize(n);
    for (size_t i = 0; i < n; ++i) {
      x_[i] = random.Uniform();
      y_[i] = random.Uniform();
      z_[i] = 0.4F * random.Uniform();
    }
    for (size_t s = 0; s < kPositions; ++s) sharpness_.push_back(3.0F + 12.0F * random.Uniform());
    for (double& value : u_) value = random.Uniform(-1.0, 1.0);
  }

  kernel::Positions At() const { return {x_.data(), y_.data(), z_.data(), field_.config().Cones() ? sharpness_.data() : nullptr, points_, kPlane}; }

  // Log density of a sample in double, from first principles, with all its positions moved by `step`.
  double LogDensity(const std::vector<double>& grid, const std::vector<double>& networks, size_t s, const std::array<double, 3>& step) const {
    const encoding::HashGrid shape(field_.config().grid);
    std::vector<std::array<double, 3>> positions;
    for (size_t i = s; i < x_.size(); i += kPlane) {
      positions.push_back({static_cast<double>(x_[i]) + step[0], static_cast<double>(y_[i]) + step[1], static_cast<double>(z_[i]) + step[2]});
    }
    const double sharpness = field_.config().Cones() ? static_cast<double>(sharpness_[s]) : std::numeric_limits<double>::infinity();
    std::vector<double> in;
    for (int l = 0; l < shape.levels(); ++l) {
      const std::vector<double> table(grid.begin() + shape.Offset(l), grid.begin() + shape.Offset(l + 1));
      const std::vector<double> features = kernel::reference::HashForward(shape.level(l), shape.features(), table, positions, sharpness);
      in.insert(in.end(), features.begin(), features.end());
    }
    if (field_.config().scale_features) {
      for (int row = 0; row < field_.ScaleRows(); ++row) {
        const bool padding = row >= field_.ScaledLevels();
        const double cells = padding ? 1.0 : static_cast<double>(shape.level(field_.ScaledLevel(row)).cells_per_unit);
        in.push_back(padding ? 0.0 : 1.0 - std::erf(sharpness / cells));
      }
    }
    auto next = networks.begin();
    const auto dense = [&](int n_out, bool relu) {
      const auto end = next + n_out * static_cast<int>(in.size());
      in = kernel::reference::Dense(std::vector<double>(next, end), n_out, in, relu);
      next = end;
    };
    for (int l = 0; l < field_.config().density_hidden_layers; ++l) dense(field_.config().hidden, true);
    dense(kGeometryRows, false);
    return in[0];
  }

  // d log density / d position . u of a sample.
  double Growth(const std::vector<double>& grid, const std::vector<double>& networks, size_t s, const std::array<double, 3>& u) const {
    constexpr double kStep = 1e-5;
    const auto at = [&](double t) { return LogDensity(grid, networks, s, {t * u[0], t * u[1], t * u[2]}); };
    return (at(kStep) - at(-kStep)) / (2.0 * kStep);
  }
  std::array<double, 3> Along(size_t s) const { return {u_[s], u_[kPositions + s], u_[2 * kPositions + s]}; }

  HashField field_{ConfigOf(GetParam())};
  Parameters parameters_;
  int points_ = 1;
  std::vector<float> x_, y_, z_, sharpness_;
  std::array<double, 3 * kPositions> u_ = {};
};

TEST_P(DensityGradient, MatchesDifferencesInDouble) {
  DensitySlope slope;
  field_.DensityGradient(field_.Prepare(parameters_.networks), parameters_.grid, At(), kPositions, slope);
  const std::vector<double> grid(parameters_.grid.begin(), parameters_.grid.end());
  const std::vector<double> networks(parameters_.networks.begin(), parameters_.networks.end());
  double size = 0.0;
  for (size_t s = 0; s < kPositions; ++s) {
    for (size_t axis = 0; axis < 3; ++axis) {
      std::array<double, 3> unit = {0, 0, 0};
      unit[axis] = 1.0;
      const double expected = Growth(grid, networks, s, unit);
      EXPECT_NEAR(static_cast<double>(slope.gradient[axis * slope.stride + s]), expected, 3e-5 * std::max(1.0, std::abs(expected)))
          << "sample " << s << " axis " << axis;
      size += std::abs(expected);
    }
  }
  EXPECT_GT(size, 1.0);
}

// The loss is sum_s u_s . gradient_s, for fixed u.
TEST_P(DensityGradient, BackwardMatchesDifferencesInDouble) {
  const NetworkWeights weights = field_.Prepare(parameters_.networks);
  DensitySlope slope;
  field_.DensityGradient(weights, parameters_.grid, At(), kPositions, slope);
  std::vector<float> along(3 * slope.stride, 0.0F);
  for (size_t s = 0; s < kPositions; ++s) {
    for (size_t axis = 0; axis < 3; ++axis) along[axis * slope.stride + s] = static_cast<float>(u_[axis * kPositions + s]);
  }
  std::vector<float> network_gradient(parameters_.networks.size(), 0.0F), grid_gradient(parameters_.grid.size(), 0.0F);
  field_.DensityGradientBackward(weights, parameters_.grid, At(), kPositions, along.data(), slope, network_gradient.data());
  // The second segment has positions of its own.
  const kernel::Positions own = At().From(2);
  const kernel::Positions nowhere;
  std::vector<uint8_t> touched(grid_gradient.size() / kernel::kLineFloats, 0);
  for (int part = 0; part < field_.encoding().parts(); ++part) {
    const int64_t offset = field_.encoding().Offset(part);
    const auto add = [&](const kernel::Positions& at, const FeatureGradient& segment) {
      AddPartGradient(field_, part, parameters_.grid.data() + offset, at, std::span(&segment, 1), grid_gradient.data() + offset,
                      touched.data() + offset / kernel::kLineFloats);
    };
    add(At(), {.begin = 0, .count = 2, .gradient = slope.feature_gradient, .stride = slope.stride, .along = along.data()});
    add(nowhere,
        {.begin = 0, .count = kPositions - 2, .gradient = slope.feature_gradient + 2, .stride = slope.stride, .along = along.data() + 2, .at = &own});
  }

  std::vector<double> grid(parameters_.grid.begin(), parameters_.grid.end()), networks(parameters_.networks.begin(), parameters_.networks.end());
  const auto loss = [&] {
    double sum = 0.0;
    for (size_t s = 0; s < kPositions; ++s) sum += Growth(grid, networks, s, Along(s));
    return sum;
  };
  const auto check = [&](std::vector<double>& values, const std::vector<float>& gradient, size_t end, const char* name) {
    size_t nonzero = 0;
    for (size_t i = 0; i < end; ++i) {
      const double keep = values[i];
      double best = 1e300, numeric = 0.0;
      for (const double h : {1e-2, 1e-3, 1e-4}) {  // the smaller ones where a ReLU turns on within the larger
        values[i] = keep + h;
        const double above = loss();
        values[i] = keep - h;
        const double candidate = (above - loss()) / (2.0 * h);
        values[i] = keep;
        if (std::abs(candidate - static_cast<double>(gradient[i])) < best) {
          best = std::abs(candidate - static_cast<double>(gradient[i]));
          numeric = candidate;
        }
      }
      nonzero += std::abs(numeric) > 1e-6 ? 1U : 0U;
      EXPECT_NEAR(static_cast<double>(gradient[i]), numeric, 5e-5 * std::max(1.0, std::abs(numeric))) << name << " " << i;
    }
    EXPECT_GT(nonzero, 20U) << name;
  };
  check(grid, grid_gradient, grid.size(), "grid");
  // The density network; nothing reaches the colour network.
  size_t density = static_cast<size_t>(field_.config().hidden * field_.FeatureRows() + kGeometryRows * field_.config().hidden);
  density += static_cast<size_t>((field_.config().density_hidden_layers - 1) * field_.config().hidden * field_.config().hidden);
  check(networks, network_gradient, density, "networks");
  EXPECT_TRUE(std::all_of(network_gradient.begin() + static_cast<ptrdiff_t>(density), network_gradient.end(), [](float g) { return g == 0.0F; }));
}

INSTANTIATE_TEST_SUITE_P(Shapes, DensityGradient,
                         ::testing::Values(Shape{0, false, 1}, Shape{1, false, 1}, Shape{1, true, 1}, Shape{4, true, 1}, Shape{6, false, 1},
                                           Shape{6, true, 2}, Shape{0, false, 3}),
                         [](const auto& of) {
                           return std::to_string(of.param.multisample) + "_positions_" + (of.param.scale_features ? "with_scales_" : "") +
                                  std::to_string(of.param.density_hidden_layers) + "_layers";
                         });

// A workspace that held more samples gives the same bits.
TEST(DensitySlope, KeepsNothingOfEarlierSamples) {
  const HashField field(ConfigOf({}));
  base::Random random(3);
  Parameters parameters;
  parameters.Allocate(field);
  field.Initialize(random, parameters.grid, parameters.networks);
  for (float& value : parameters.grid) value = random.Uniform() - 0.5F;
  const NetworkWeights weights = field.Prepare(parameters.networks);
  std::vector<float> x(40);
  for (float& value : x) value = 0.4F * random.Uniform();
  const kernel::Positions at{x.data(), x.data(), x.data()};
  DensitySlope used, fresh;
  field.DensityGradient(weights, parameters.grid, at, 40, used);
  field.DensityGradient(weights, parameters.grid, at, 5, used);
  field.DensityGradient(weights, parameters.grid, at, 5, fresh);
  std::vector<float> along(3 * used.stride, 0.5F), gradient_used(parameters.networks.size(), 0.0F), gradient_fresh = gradient_used;
  field.DensityGradientBackward(weights, parameters.grid, at, 5, along.data(), used, gradient_used.data());
  field.DensityGradientBackward(weights, parameters.grid, at, 5, along.data(), fresh, gradient_fresh.data());
  for (size_t i = 0; i < 5; ++i) EXPECT_EQ(used.gradient[i], fresh.gradient[i]);
  EXPECT_EQ(gradient_used, gradient_fresh);
}

TEST(DensitySlope, NeedsAnEncodingThatInterpolates) {
  const float x = 0.1F;
  for (const auto kind : {encoding::Kind::kHash, encoding::Kind::kVoxels, encoding::Kind::kPlanes, encoding::Kind::kFrequency}) {
    FieldConfig config = ConfigOf({});
    config.grid.levels = 6;
    config.encoding = kind;
    const HashField field(config);
    base::Random random(3);
    Parameters parameters;
    parameters.Allocate(field);
    field.Initialize(random, parameters.grid, parameters.networks);
    DensitySlope slope;
    const auto compute = [&] { field.DensityGradient(field.Prepare(parameters.networks), parameters.grid, {&x, &x, &x}, 1, slope); };
    if (field.encoding().HasSlope()) {
      EXPECT_NO_THROW(compute()) << encoding::Name(kind);
    } else {
      EXPECT_THROW(compute(), base::UsageError) << encoding::Name(kind);
    }
    EXPECT_EQ(field.encoding().HasSlope(), kind == encoding::Kind::kHash || kind == encoding::Kind::kVoxels);
  }
}

}  // namespace
}  // namespace skyquilt::field
