// The rows that tell the density network how much of each level a footprint hides.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/base/random.h"
#include "core/field/hash_field.h"

namespace skyquilt::field {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr int64_t kFootprints = 6;
constexpr size_t kStride = 16;

FieldConfig Config(int levels, int multisample, bool scale_features, encoding::Kind encoding = encoding::Kind::kHash) {
  FieldConfig config;
  config.encoding = encoding;
  config.grid.levels = levels;
  config.grid.features = 4;
  config.grid.log2_table_size = 6;
  config.grid.base_resolution = 2;
  config.grid.finest_resolution = 40;
  config.hidden = 8;
  config.multisample = multisample;
  config.scale_features = scale_features;
  return config;
}

// Samples with several positions each.
struct Samples {
  explicit Samples(int n_points) : points(n_points) {
    base::Random random(5);
    for (auto* v : {&x, &y, &z}) {
      v->resize(static_cast<size_t>(kFootprints) * static_cast<size_t>(points));
      for (float& value : *v) value = random.Uniform();
    }
  }
  kernel::Positions At(bool cones) const {
    return {x.data(), y.data(), z.data(), cones ? sharpness : nullptr, points, static_cast<size_t>(kFootprints)};
  }
  int points;
  std::vector<float> x, y, z;
  float sharpness[kFootprints] = {0.0F, 0.3F, 3.0F, 30.0F, kInfinity, kNan};
};

std::vector<float> Encoded(const HashField& field, const kernel::Positions& at) {
  base::Random random(7);
  std::vector<float> grid(static_cast<size_t>(field.GridParameters())), features(static_cast<size_t>(field.FeatureRows()) * kStride, -9.0F);
  for (float& value : grid) value = random.Uniform() - 0.5F;
  field.EncodeSerial(grid, at, kFootprints, features.data(), kStride);
  return features;
}

TEST(ScaleFeatures, AreRowsOfTheDensityNetworkOnly) {
  for (const int levels : {1, 3, 4, 5, 16}) {
    const HashField without(Config(levels, 1, false)), with(Config(levels, 1, true));
    EXPECT_EQ(without.ScaleRows(), 0);
    const int rows = kernel::PaddedRows((levels + 1) / 2);
    EXPECT_EQ(with.ScaleRows(), rows);
    EXPECT_EQ(with.FeatureRows(), without.FeatureRows() + rows);
    EXPECT_EQ(with.FeatureRows(), with.encoding().OutputRows() + with.ScaleRows());
    EXPECT_EQ(with.GridParameters(), without.GridParameters());
    EXPECT_EQ(with.NetworkParameters() - without.NetworkParameters(), 8 * rows) << "inputs of the first layer";
    EXPECT_EQ(with.ColorInputRows(), without.ColorInputRows());
    EXPECT_EQ(with.DensityHiddenRows(), without.DensityHiddenRows());
  }
}

TEST(ScaleFeatures, FollowWithEveryEncoding) {
  for (const auto kind : {encoding::Kind::kHash, encoding::Kind::kVoxels, encoding::Kind::kPlanes, encoding::Kind::kFrequency}) {
    const HashField field(Config(5, 1, true, kind));
    EXPECT_EQ(field.FeatureRows(), field.encoding().OutputRows() + 4);
    const Samples samples(1);
    const std::vector<float> features = Encoded(field, samples.At(true));
    const float* const first = features.data() + static_cast<size_t>(field.encoding().OutputRows()) * kStride;
    EXPECT_EQ(first[0], 1.0F) << encoding::Name(kind);
    EXPECT_EQ(first[4], 0.0F) << encoding::Name(kind);
  }
}

TEST(ScaleFeatures, AreWhatTheFootprintHidesOfEverySecondLevel) {
  for (const auto& [points, levels] : {std::pair{1, 5}, {4, 6}, {6, 5}, {1, 9}}) {
    const FieldConfig config = Config(levels, points, true);
    const HashField field(config);
    const Samples samples(points);
    const std::vector<float> features = Encoded(field, samples.At(true));
    const auto scale = [&](int row, size_t s) { return features[static_cast<size_t>(field.encoding().OutputRows() + row) * kStride + s]; };
    for (size_t s = 0; s < static_cast<size_t>(kFootprints); ++s) {
      for (int row = 0; row < (levels + 1) / 2; ++row) {
        const int level = levels % 2 == 1 ? 2 * row : 2 * row + 1;
        const double cells = 2.0 * std::pow(20.0, level / (levels - 1.0));
        EXPECT_NEAR(encoding::LevelResolution(config.grid, level), cells, 1e-9);
        EXPECT_EQ(scale(row, s), 1.0F - kernel::FootprintWeight(samples.sharpness[s], static_cast<float>(cells))) << level << " " << s;
        const auto sharpness = static_cast<double>(samples.sharpness[s]);
        const double hidden = std::isnan(sharpness) ? 0.0 : std::erfc(sharpness / cells);
        EXPECT_NEAR(static_cast<double>(scale(row, s)), hidden, 3e-6) << level << " " << s;
      }
      for (int row = (levels + 1) / 2; row < field.ScaleRows(); ++row) EXPECT_EQ(scale(row, s), 0.0F) << "padding";
    }
    EXPECT_EQ(field.ScaleRows(), levels == 9 ? 8 : 4);
    EXPECT_LT(scale(0, 2), scale((levels - 1) / 2, 2)) << "finer levels fade first";
  }
}

// Places of the occupancy grid are asked for as points.
TEST(ScaleFeatures, OfPointsAreZero) {
  const HashField field(Config(3, 4, true));
  const std::vector<float> features = Encoded(field, Samples(1).At(false));
  for (int row = 0; row < field.FeatureRows(); ++row) {
    for (size_t s = 0; s < kStride; ++s) {
      const float value = features[static_cast<size_t>(row) * kStride + s];
      if (s >= static_cast<size_t>(kFootprints)) {
        EXPECT_EQ(value, -9.0F) << "not a sample";
      } else if (row >= field.encoding().OutputRows()) {
        EXPECT_EQ(value, 0.0F);
      }
    }
  }
}

TEST(ScaleFeatures, LeaveTheEncodingsRowsAsTheyAre) {
  const Samples samples(4);
  const HashField without(Config(3, 4, false)), with(Config(3, 4, true));
  const std::vector<float> plain = Encoded(without, samples.At(true)), extended = Encoded(with, samples.At(true));
  EXPECT_TRUE(std::equal(plain.begin(), plain.end(), extended.begin()));
}

// The taps of the luminance are the last parameters, with scale rows too.
TEST(ScaleFeatures, LeaveTheLuminanceItsPlace) {
  FieldConfig config = Config(3, 1, true);
  config.luminance = true;
  const HashField field(config);
  EXPECT_EQ(field.NetworkParameters(), field.LuminanceOffset() + kLuminanceTaps + 1);
  base::Random random(3);
  std::vector<float> grid(static_cast<size_t>(field.GridParameters())), networks(static_cast<size_t>(field.NetworkParameters()));
  field.Initialize(random, grid, networks);
  const NetworkWeights weights = field.Prepare(networks);
  for (size_t tap = 0; tap < static_cast<size_t>(kLuminanceTaps); ++tap) EXPECT_EQ(weights.luminance[tap], 1.0F / kLuminanceTaps);
  EXPECT_EQ(weights.luminance.back(), 0.0F);
  EXPECT_EQ(weights.layer[0].size(), static_cast<size_t>(8 * field.FeatureRows()));
}

TEST(ScaleFeatures, NeedFootprintsAndPositionsThatExist) {
  EXPECT_THROW(HashField{Config(3, 0, true)}, std::invalid_argument);
  for (const int points : {-1, 2, 3, 5, 7}) EXPECT_THROW(HashField{Config(3, points, false)}, std::invalid_argument) << points;
  for (const int points : {0, 1, 4, 6}) EXPECT_NO_THROW(HashField{Config(3, points, false)}) << points;
}

}  // namespace
}  // namespace skyquilt::field
