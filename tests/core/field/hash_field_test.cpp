#include "core/field/hash_field.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/encoding/spherical_harmonics.h"
#include "core/field/optimizer.h"
#include "core/kernel/reference.h"
#include "tests/support/encoding_reference.h"

namespace skyquilt::field {
namespace {

FieldConfig SmallConfig(int color_hidden_layers) {
  FieldConfig config;
  config.grid.levels = 3;
  config.grid.features = 4;
  config.grid.log2_table_size = 6;
  config.grid.base_resolution = 2;
  config.grid.finest_resolution = 11;
  config.grid.extent[2] = 0.4;
  config.hidden = 8;
  config.color_hidden_layers = color_hidden_layers;
  config.sh_degree = 3;
  return config;
}

// Reference: the same field for one sample, in double and without optimisation.
struct Reference {
  const HashField& field;
  std::vector<double> Forward(const std::vector<double>& grid, const std::vector<double>& networks, const double x[3], const double d[3],
                              std::vector<double> code) const {
    auto next = networks.begin();
    const auto dense = [&](int n_out, const std::vector<double>& in, bool relu) {
      const std::vector<double> weights(next, next + n_out * static_cast<int>(in.size()));
      next += n_out * static_cast<int>(in.size());
      return kernel::reference::Dense(weights, n_out, in, relu);
    };
    const int hidden = field.config().hidden;
    std::vector<double> in = testing::EncodeInDouble(field.encoding(), field.config().grid, grid, x);
    for (int l = 0; l < field.config().density_hidden_layers; ++l) in = dense(hidden, in, true);
    const std::vector<double> geometry = dense(kGeometryRows, in, false);
    in = geometry;
    double sh[16] = {};
    encoding::SphericalHarmonics(d[0], d[1], d[2], field.config().sh_degree, sh);
    for (int k = 0; k < field.AppearanceRow() - kGeometryRows; ++k)
      in.push_back(k < field.config().sh_degree * field.config().sh_degree ? sh[k] : 0.0);
    code.resize(static_cast<size_t>(field.AppearanceRows()), 0.0);
    in.insert(in.end(), code.begin(), code.end());
    for (int l = 0; l < field.config().color_hidden_layers; ++l) in = dense(hidden, in, true);
    const std::vector<double> color = dense(kColorRows, in, false);
    return {color[0], color[1], color[2], geometry[0]};
  }
};

struct FieldShape {
  encoding::Kind encoding;
  int density_hidden_layers, color_hidden_layers;
  int appearance = 0;
};

class HashFieldGradient : public ::testing::TestWithParam<FieldShape> {};

TEST_P(HashFieldGradient, EveryParameterMatchesFiniteDifferencesInDouble) {
  FieldConfig config = SmallConfig(GetParam().color_hidden_layers);
  config.encoding = GetParam().encoding;
  config.density_hidden_layers = GetParam().density_hidden_layers;
  config.appearance = GetParam().appearance;
  const HashField field(config);
  base::Random random(19);
  Parameters parameters;
  parameters.Allocate(field);
  OptimizerState state;
  state.Allocate(field);
  field.Initialize(random, parameters.grid, parameters.networks);
  for (float& value : parameters.grid) value = random.Uniform() - 0.5F;  // large enough to matter

  const int64_t n = 5;
  const auto stride = static_cast<size_t>(kernel::Padded(n));
  std::vector<float> x(stride, 0.0F), y(stride, 0.0F), z(stride, 0.0F), direction(3 * stride, 0.0F);
  std::vector<float> color_gradient(4 * stride, 0.0F), density_gradient(stride, 0.0F);
  for (size_t s = 0; s < static_cast<size_t>(n); ++s) {
    x[s] = random.Uniform();
    y[s] = random.Uniform();
    z[s] = 0.4F * random.Uniform();
    const Eigen::Vector3d d = Eigen::Vector3d{random.Normal(), random.Normal(), random.Normal()}.normalized();
    for (size_t axis = 0; axis < 3; ++axis) direction[axis * stride + s] = static_cast<float>(d[static_cast<int>(axis)]);
    for (size_t c = 0; c < 3; ++c) color_gradient[c * stride + s] = random.Uniform() - 0.5F;
    density_gradient[s] = random.Uniform() - 0.5F;
  }
  // The first three samples are of one photo, the others of another.
  const size_t photo_of[] = {0, 0, 0, 1, 1};
  const auto numbers = static_cast<size_t>(config.appearance);
  std::vector<float> codes(2 * numbers);
  for (float& number : codes) number = random.Uniform() - 0.5F;
  const auto rows = static_cast<size_t>(field.FeatureRows());
  std::vector<float> features(rows * stride, 0.0F);
  field.EncodeSerial(parameters.grid, {x.data(), y.data(), z.data()}, n, features.data(), stride);
  const NetworkWeights weights = field.Prepare(parameters.networks);
  Activations a;
  a.Reserve(field, n);
  const auto padded = static_cast<int64_t>(stride);
  field.Density(weights, features.data(), stride, padded, a.density_hidden, a.stride, a.geometry(), a.stride);
  for (size_t s = 0; s < stride; ++s) {
    const float d[3] = {direction[s], direction[stride + s], direction[2 * stride + s]};
    float* const after_geometry = a.color_in + static_cast<size_t>(kGeometryRows) * a.stride + s;
    field.EncodeDirection(d, 1, after_geometry, a.stride);
    if (s < static_cast<size_t>(n)) field.EncodeAppearance(codes.data() + photo_of[s] * numbers, 1, after_geometry, a.stride);
    a.log_density_gradient[s] = density_gradient[s];
    for (size_t c = 0; c < 4; ++c) a.color_gradient[c * a.stride + s] = color_gradient[c * stride + s];
  }
  field.Color(weights, a.color_in, a.stride, padded, a.color_hidden, a.stride, a.color_raw, a.stride);
  field.Backward(weights, a, features.data(), stride, padded, state.network_gradient.data());
  std::vector<float> code_gradient(codes.size(), 0.0F);
  for (size_t s = 0; s < static_cast<size_t>(n); ++s) {
    for (size_t k = 0; k < numbers; ++k) code_gradient[photo_of[s] * numbers + k] += a.appearance_gradient[k * a.stride + s];
  }
  // Two segments, as from two packets.
  const FeatureGradient segments[2] = {{0, 2, features.data(), stride}, {2, n - 2, features.data() + 2, stride}};
  std::vector<float> grid_gradient(parameters.grid.size(), 0.0F);
  std::vector<uint8_t> touched(parameters.grid.size() / kernel::kLineFloats, 0);
  for (int part = 0; part < field.encoding().parts(); ++part) {
    const int64_t offset = field.encoding().Offset(part);
    AddPartGradient(field, part, parameters.grid.data() + offset, {x.data(), y.data(), z.data()}, segments, grid_gradient.data() + offset,
                    touched.data() + offset / kernel::kLineFloats);
  }

  std::vector<double> grid(parameters.grid.begin(), parameters.grid.end()), networks(parameters.networks.begin(), parameters.networks.end());
  std::vector<double> exact_codes(codes.begin(), codes.end());
  const Reference reference{field};
  const auto loss = [&] {
    double sum = 0.0;
    for (size_t s = 0; s < static_cast<size_t>(n); ++s) {
      const double position[3] = {static_cast<double>(x[s]), static_cast<double>(y[s]), static_cast<double>(z[s])};
      const double d[3] = {static_cast<double>(direction[s]), static_cast<double>(direction[stride + s]),
                           static_cast<double>(direction[2 * stride + s])};
      const auto code = exact_codes.begin() + static_cast<std::ptrdiff_t>(photo_of[s] * numbers);
      const auto out = reference.Forward(grid, networks, position, d, {code, code + static_cast<std::ptrdiff_t>(numbers)});
      for (size_t c = 0; c < 3; ++c) sum += static_cast<double>(color_gradient[c * stride + s]) * out[c];
      sum += static_cast<double>(density_gradient[s]) * out[3];
    }
    return sum;
  };
  const auto check = [&](std::vector<double>& values, const std::vector<float>& gradient, const char* name, size_t skip_from) {
    size_t nonzero = 0;
    for (size_t i = 0; i < std::min(values.size(), skip_from); ++i) {
      const double keep = values[i];
      double best = 1e300, numeric = 0.0;
      for (const double h : {1e-4, 1e-6}) {  // the smaller one where a ReLU turns on within the larger
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
      nonzero += numeric != 0.0 ? 1U : 0U;
      // Float arithmetic of a few dozen terms of size one.
      EXPECT_NEAR(static_cast<double>(gradient[i]), numeric, 2e-5 * std::max(1.0, std::abs(numeric))) << name << " " << i;
    }
    if (!values.empty()) {
      EXPECT_GT(nonzero, std::min<size_t>(20, values.size() - 1)) << name;
    }
  };
  check(grid, grid_gradient, "grid", grid.size());
  check(exact_codes, code_gradient, "codes", codes.size());
  // The last row of the last layer is padding.
  check(networks, state.network_gradient, "networks", networks.size() - static_cast<size_t>(field.config().hidden));
}

INSTANTIATE_TEST_SUITE_P(Shapes, HashFieldGradient,
                         ::testing::Values(FieldShape{encoding::Kind::kHash, 1, 1}, FieldShape{encoding::Kind::kHash, 1, 2},
                                           FieldShape{encoding::Kind::kHash, 2, 3}, FieldShape{encoding::Kind::kHash, 3, 1},
                                           FieldShape{encoding::Kind::kHash, 1, 1, 5}, FieldShape{encoding::Kind::kHash, 1, 2, 8},
                                           FieldShape{encoding::Kind::kFrequency, 1, 3, 1}, FieldShape{encoding::Kind::kVoxels, 1, 1},
                                           FieldShape{encoding::Kind::kPlanes, 2, 1}, FieldShape{encoding::Kind::kFrequency, 4, 2}),
                         [](const auto& of) {
                           return encoding::Name(of.param.encoding) + std::to_string(of.param.density_hidden_layers) +
                                  std::to_string(of.param.color_hidden_layers) +
                                  (of.param.appearance > 0 ? "_with_" + std::to_string(of.param.appearance) : "");
                         });

// Eight layers, as in the NeRF paper, for the frequency encoding.
TEST(HashField, DeepNetworksHaveAllTheirParametersAndOperations) {
  FieldConfig config = SmallConfig(1);
  config.encoding = encoding::Kind::kFrequency;
  config.density_hidden_layers = 8;
  config.hidden = 256;
  const HashField deep(config);
  config.density_hidden_layers = 1;
  const HashField shallow(config);
  EXPECT_EQ(deep.NetworkParameters() - shallow.NetworkParameters(), 7 * 256 * 256);
  EXPECT_EQ(deep.ForwardFlops() - shallow.ForwardFlops(), 2.0 * 7 * 256 * 256);
  EXPECT_EQ(deep.DensityHiddenRows(), 8 * 256);
  Activations a;
  a.Reserve(deep, 100);
  EXPECT_EQ(a.geometry(), a.density_hidden + static_cast<size_t>(deep.DensityHiddenRows()) * a.stride)
      << "must be consecutive, because samples are dropped from both at once";
  EXPECT_EQ(a.kept_rows, deep.DensityHiddenRows() + kGeometryRows);
}

// Whatever is in the buffer: renderings never set a code.
TEST(HashField, ADirectionComesWithTheCodeOfTheMeanLook) {
  for (const int numbers : {1, 4, 5, 32}) {
    FieldConfig config = SmallConfig(1);
    config.appearance = numbers;
    const HashField field(config);
    EXPECT_EQ(field.AppearanceRows(), kernel::PaddedRows(numbers));
    EXPECT_EQ(field.ColorInputRows(), HashField(SmallConfig(1)).ColorInputRows() + kernel::PaddedRows(numbers));
    const auto rows = static_cast<size_t>(field.ColorInputRows() - kGeometryRows);
    std::vector<float> in(rows * 3, 7.0F);
    const float d[3] = {0.0F, 0.6F, 0.8F};
    field.EncodeDirection(d, 3, in.data(), 3);
    for (size_t i = 3 * static_cast<size_t>(field.AppearanceRow() - kGeometryRows); i < in.size(); ++i) EXPECT_EQ(in[i], 0.0F) << i;
    const std::vector<float> code(static_cast<size_t>(numbers), 2.0F);
    field.EncodeAppearance(code.data(), 2, in.data(), 3);
    EXPECT_EQ(std::count(in.begin(), in.end(), 2.0F), 2 * numbers) << "two of three samples";
  }
}

// For any direction: the first harmonic is the same for all.
TEST(HashField, AFoldedCodeGivesTheColoursOfThatCode) {
  for (const int degree : {1, 3}) {
    FieldConfig config = SmallConfig(1);
    config.appearance = 5;
    config.sh_degree = degree;
    const HashField field(config);
    base::Random random(7);
    std::vector<float> grid(static_cast<size_t>(field.GridParameters())), networks(static_cast<size_t>(field.NetworkParameters()));
    field.Initialize(random, grid, networks);
    std::vector<float> folded = networks;
    const std::vector<float> code = {0.5F, -1.0F, 0.0F, 2.0F, -0.25F};
    field.FoldAppearance(code, folded);
    const auto colors = [&](std::span<const float> parameters, bool coded, const float* direction) {
      Activations a;
      a.Reserve(field, kernel::kPad);
      float* rows = a.color_in + static_cast<size_t>(kGeometryRows) * a.stride;
      for (int k = 0; k < kGeometryRows; ++k) a.color_in[static_cast<size_t>(k) * a.stride] = 0.1F * static_cast<float>(k) - 0.7F;
      field.EncodeDirection(direction, 1, rows, a.stride);
      if (coded) field.EncodeAppearance(code.data(), 1, rows, a.stride);
      field.Color(field.Prepare(parameters), a.color_in, a.stride, kernel::kPad, a.color_hidden, a.stride, a.color_raw, a.stride);
      return std::array{a.color_raw[0], a.color_raw[a.stride], a.color_raw[2 * a.stride]};
    };
    for (const std::array<float, 3>& direction : {std::array{0.0F, 0.6F, 0.8F}, std::array{-1.0F, 0.0F, 0.0F}}) {
      const auto expected = colors(networks, true, direction.data()), got = colors(folded, false, direction.data());
      const auto plain = colors(networks, false, direction.data());
      for (size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(got[c], expected[c], 1e-5F) << c;
        EXPECT_NE(plain[c], expected[c]) << c;
      }
    }
    EXPECT_THROW(field.FoldAppearance(std::vector<float>(4), folded), std::invalid_argument);
  }
}

TEST(HashField, RefusesImpossibleSettings) {
  FieldConfig config = SmallConfig(1);
  config.hidden = 6;
  EXPECT_THROW(HashField{config}, std::invalid_argument);
  config = SmallConfig(4);
  EXPECT_THROW(HashField{config}, std::invalid_argument);
  config = SmallConfig(1);
  config.grid.log2_table_size = 25;
  EXPECT_THROW(HashField{config}, std::invalid_argument);
  config = SmallConfig(1);
  config.density_hidden_layers = 9;
  EXPECT_THROW(HashField{config}, std::invalid_argument);
  config.density_hidden_layers = 0;
  EXPECT_THROW(HashField{config}, std::invalid_argument);
  for (const int numbers : {-1, 33}) {
    config = SmallConfig(1);
    config.appearance = numbers;
    EXPECT_THROW(HashField{config}, std::invalid_argument);
  }
}

// The first step of Adam moves every parameter with a gradient by the learning rate, whatever the number of threads.
TEST(Optimizer, MovesWhatSamplesTouchedOnAnyNumberOfThreads) {
  const HashField field(SmallConfig(1));
  std::vector<std::vector<float>> moved;
  for (const int n_threads : {1, 3}) {
    base::ThreadPool threads(n_threads);
    Parameters parameters;
    parameters.Allocate(field);
    OptimizerState state;
    state.Allocate(field);
    Optimizer optimizer(field, threads);
    const float x[2] = {0.1F, 0.6F}, y[2] = {0.2F, 0.7F}, z[2] = {0.05F, 0.3F};
    std::vector<float> gradient(static_cast<size_t>(field.FeatureRows()) * 2, 0.0F);
    for (size_t row = 0; row < static_cast<size_t>(field.FeatureRows()); ++row) gradient[2 * row] = 1.0F;  // the second sample has none
    state.network_gradient[5] = 1.0F;
    const FeatureGradient segment{0, 2, gradient.data(), 2};
    optimizer.Update({x, y, z}, {&segment, 1}, 0.01, 0.0, parameters, state);
    EXPECT_EQ(state.step, 1);
    EXPECT_NEAR(parameters.networks[5], -0.01F, 1e-6F);
    EXPECT_EQ(state.network_gradient[5], 0.0F);
    int n_moved = 0;
    for (const float value : parameters.grid) {
      if (value == 0.0F) continue;
      EXPECT_NEAR(value, -0.01F, 1e-6F);
      ++n_moved;
    }
    // Eight corners of at most four features in three levels; some corners may share an entry.
    EXPECT_GT(n_moved, 48);
    EXPECT_LE(n_moved, 96);
    optimizer.Update({x, y, z}, {}, 0.01, 0.0, parameters, state);
    moved.push_back(parameters.grid);
  }
  EXPECT_EQ(moved[0], moved[1]);
}

TEST(Optimizer, TrainsNetworksWhereTheEncodingHasNoParameters) {
  FieldConfig config = SmallConfig(1);
  config.encoding = encoding::Kind::kFrequency;
  const HashField field(config);
  base::ThreadPool threads(2);
  Parameters parameters;
  parameters.Allocate(field);
  OptimizerState state;
  state.Allocate(field);
  EXPECT_TRUE(parameters.grid.empty());
  state.network_gradient[5] = 1.0F;
  const float x[2] = {0.1F, 0.6F};
  const std::vector<float> gradient(static_cast<size_t>(field.FeatureRows()) * 2, 1.0F);
  const FeatureGradient segment{0, 2, gradient.data(), 2};
  Optimizer(field, threads).Update({x, x, x}, {&segment, 1}, 0.01, 0.0, parameters, state);
  EXPECT_NEAR(parameters.networks[5], -0.01F, 1e-6F);
}

}  // namespace
}  // namespace skyquilt::field
