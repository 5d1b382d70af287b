// Tests that every encoding must pass, and tests of the baselines' own properties.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/encoding/encoding.h"
#include "tests/support/encoding_reference.h"
#include "tests/support/error_of.h"
#include "tests/support/gradient_check.h"

namespace skyquilt::encoding {
namespace {

HashGridConfig SmallConfig() {
  HashGridConfig config;
  config.levels = 6;
  config.features = 4;
  config.log2_table_size = 7;
  config.base_resolution = 2;
  config.finest_resolution = 24;
  config.extent[1] = 0.8;
  config.extent[2] = 0.3;
  return config;
}

std::string NameOf(const ::testing::TestParamInfo<Kind>& of) {
  return Name(of.param);
}

class EveryEncoding : public ::testing::TestWithParam<Kind> {
 protected:
  void SetUp() override {
    encoding_ = MakeEncoding(GetParam(), config_);
    parameters_.resize(static_cast<size_t>(encoding_->ParameterCount()));
    base::Random random(3);
    for (float& value : parameters_) value = random.Uniform() - 0.5F;
  }
  // n positions, some slightly outside the box.
  void Place(int64_t n) {
    base::Random random(5);
    for (auto* axis : {&x_, &y_, &z_}) axis->clear();
    for (int64_t i = 0; i < n; ++i) {
      x_.push_back(1.1F * random.Uniform() - 0.05F);
      y_.push_back(0.9F * random.Uniform() - 0.05F);
      z_.push_back(0.4F * random.Uniform() - 0.05F);
    }
  }
  std::vector<double> Reference(const std::vector<double>& parameters, size_t s) const {
    const double x[3] = {static_cast<double>(x_[s]), static_cast<double>(y_[s]), static_cast<double>(z_[s])};
    return testing::EncodeInDouble(*encoding_, config_, parameters, x);
  }
  std::vector<float> Features(size_t stride) const {
    std::vector<float> out(static_cast<size_t>(encoding_->OutputRows()) * stride, 9.0F);
    for (int part = 0; part < encoding_->parts(); ++part) {
      encoding_->Forward(part, parameters_.data() + encoding_->Offset(part), {x_.data(), y_.data(), z_.data()}, static_cast<int64_t>(x_.size()),
                         out.data() + static_cast<size_t>(encoding_->FirstRow(part)) * stride, stride);
    }
    return out;
  }

  const HashGridConfig config_ = SmallConfig();
  std::unique_ptr<const Encoding> encoding_;
  std::vector<float> parameters_, x_, y_, z_;
};

TEST_P(EveryEncoding, ForwardAgreesWithDoubleAtEveryLength) {
  const std::vector<double> parameters(parameters_.begin(), parameters_.end());
  for (const int64_t n : {0, 1, 7, 17, 255, 256, 257, 300}) {
    Place(n);
    const size_t stride = 320;
    const std::vector<float> out = Features(stride);
    for (size_t s = 0; s < static_cast<size_t>(n); ++s) {
      const std::vector<double> expected = Reference(parameters, s);
      ASSERT_EQ(static_cast<int>(expected.size()), encoding_->OutputRows());
      for (size_t row = 0; row < expected.size(); ++row) {
        // Positions and weights in float: a rounding of 1e-7 in a cell of 1/24, or in 1/12 of a turn.
        EXPECT_NEAR(static_cast<double>(out[row * stride + s]), expected[row], 1e-5) << "row " << row << " of sample " << s;
      }
    }
    for (size_t row = 0; row < static_cast<size_t>(encoding_->OutputRows()); ++row) EXPECT_EQ(out[row * stride + static_cast<size_t>(n)], 9.0F);
  }
}

TEST_P(EveryEncoding, NanCountsAsZero) {
  x_ = y_ = z_ = {std::numeric_limits<float>::quiet_NaN(), 0.0F};
  const std::vector<float> out = Features(2);
  for (size_t row = 0; row < static_cast<size_t>(encoding_->OutputRows()); ++row) EXPECT_EQ(out[2 * row], out[2 * row + 1]) << row;
}

TEST_P(EveryEncoding, GradientMatchesFiniteDifferencesAndMarksExactlyTheLinesItWrote) {
  const size_t n = 4, resting = 2, stride = 16;  // few enough to leave lines untouched
  Place(n);
  const auto rows = static_cast<size_t>(encoding_->OutputRows());
  base::Random random(7);
  std::vector<float> out_gradient(rows * stride, 0.0F);
  for (size_t row = 0; row < rows; ++row) {
    for (size_t s = 0; s < n; ++s) out_gradient[row * stride + s] = s == resting ? 0.0F : random.Uniform() - 0.5F;
  }
  std::vector<float> gradient(parameters_.size(), 0.0F);
  std::vector<uint8_t> touched(parameters_.size() / kernel::kLineFloats, 0);
  for (int part = 0; part < encoding_->parts(); ++part) {
    const int64_t offset = encoding_->Offset(part);
    encoding_->Backward(part, parameters_.data() + offset, {x_.data(), y_.data(), z_.data()}, n,
                        out_gradient.data() + static_cast<size_t>(encoding_->FirstRow(part)) * stride, stride, gradient.data() + offset,
                        touched.data() + offset / kernel::kLineFloats);
  }
  testing::ExpectGradient(
      [&](const std::vector<double>& parameters) {
        double sum = 0.0;
        for (size_t s = 0; s < n; ++s) {
          const std::vector<double> features = Reference(parameters, s);
          for (size_t row = 0; row < rows; ++row) sum += static_cast<double>(out_gradient[row * stride + s]) * features[row];
        }
        return sum;
      },
      {parameters_.begin(), parameters_.end()}, {gradient.begin(), gradient.end()}, 5e-6);
  size_t written_lines = 0;
  for (size_t line = 0; line < touched.size(); ++line) {
    bool written = false;
    for (size_t i = line * kernel::kLineFloats; i < (line + 1) * kernel::kLineFloats; ++i) written = written || gradient[i] != 0.0F;
    written_lines += written ? 1U : 0U;
    EXPECT_TRUE(!written || touched[line] == 1) << line;
  }
  if (GetParam() == Kind::kFrequency) return;
  EXPECT_GT(written_lines, 10U);
  // A line is also marked when all its weights are zero, but there are never more than the samples' corners.
  size_t marked = 0;
  for (const uint8_t mark : touched) marked += mark;
  EXPECT_LE(marked, static_cast<size_t>(encoding_->parts()) * (n - 1) * 8);
  EXPECT_LT(marked, touched.size());
}

TEST_P(EveryEncoding, LaysOutPartsInWholeLinesAndRows) {
  EXPECT_EQ(encoding_->kind(), GetParam());
  EXPECT_EQ(encoding_->OutputRows() % kernel::kRowPad, 0);
  EXPECT_EQ(encoding_->FirstRow(0), 0);
  EXPECT_EQ(encoding_->Offset(0), 0);
  for (int part = 0; part < encoding_->parts(); ++part) {
    EXPECT_GT(encoding_->FirstRow(part + 1), encoding_->FirstRow(part));
    EXPECT_GE(encoding_->Offset(part + 1), encoding_->Offset(part));
    EXPECT_EQ(encoding_->Offset(part + 1) % kernel::kLineFloats, 0);
  }
  EXPECT_EQ(encoding_->FirstRow(encoding_->parts()), encoding_->OutputRows());
  EXPECT_EQ(encoding_->Offset(encoding_->parts()), encoding_->ParameterCount());
}

TEST_P(EveryEncoding, SmallestConfigurationIsLegalAndImpossibleOnesAreRefused) {
  HashGridConfig config;
  config.levels = 1;
  config.log2_table_size = 1;
  config.base_resolution = config.finest_resolution = 1;
  config.extent[2] = 1e-6;
  const std::unique_ptr<const Encoding> tiny = MakeEncoding(GetParam(), config);
  EXPECT_GT(tiny->OutputRows(), 0);
  EXPECT_LT(tiny->ParameterCount(), 100);
  config.log2_table_size = 25;
  EXPECT_THROW(MakeEncoding(GetParam(), config), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryEncoding, ::testing::Values(Kind::kHash, Kind::kVoxels, Kind::kPlanes, Kind::kFrequency), NameOf);

class TableEncoding : public ::testing::TestWithParam<Kind> {};

TEST_P(TableEncoding, HasAboutTheParametersOfAHashGridButNeverFinerCells) {
  HashGridConfig config;
  config.extent[2] = 0.2;
  for (const int log2_table_size : {10, 14, 17, 19}) {
    for (const int levels : {2, 5, 8}) {
      config.log2_table_size = log2_table_size;
      config.levels = levels;
      for (const double finest : {32.0, 4096.0}) {
        config.finest_resolution = finest;
        const auto budget = static_cast<double>(HashGrid(config).ParameterCount());
        const std::unique_ptr<const Encoding> encoding = MakeEncoding(GetParam(), config);
        const auto* voxels = dynamic_cast<const VoxelGrid*>(encoding.get());
        const kernel::GridLevel& lattice = voxels != nullptr ? voxels->lattice() : dynamic_cast<const PlaneFactors&>(*encoding).lattice();
        EXPECT_LE(static_cast<double>(lattice.cells_per_unit), finest);
        const double share = static_cast<double>(encoding->ParameterCount()) / budget;
        EXPECT_LE(share, 1.02) << "lines are padded";
        // With whole cells along three axes a part of a small budget stays unused.
        if (static_cast<double>(lattice.cells_per_unit) < finest) {
          EXPECT_GT(share, budget < 1e5 ? 0.7 : 0.9) << log2_table_size << " " << levels;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, TableEncoding, ::testing::Values(Kind::kVoxels, Kind::kPlanes), NameOf);

TEST(Kinds, HaveNamesAndOthersAreRefusedWithTheChoices) {
  for (const Kind kind : {Kind::kHash, Kind::kVoxels, Kind::kPlanes, Kind::kFrequency}) EXPECT_EQ(KindNamed(Name(kind)), kind);
  const std::string error = ErrorOf<std::invalid_argument>([&] { KindNamed("cubes"); });
  EXPECT_EQ(error, "encoding must be one of \"hash\", \"voxels\", \"planes\", \"frequency\", got \"cubes\"");
}

TEST(PlaneFactors, StartWithProductsThatPassGradients) {
  const std::unique_ptr<const Encoding> planes = MakeEncoding(Kind::kPlanes, SmallConfig());
  std::vector<float> parameters(static_cast<size_t>(planes->ParameterCount()));
  base::Random random(1);
  planes->Initialize(random, parameters);
  std::vector<float> gradient(parameters.size(), 0.0F);
  std::vector<uint8_t> touched(parameters.size() / kernel::kLineFloats, 0);
  const float position = 0.21F;
  const std::vector<float> ones(PlaneFactors::kGroup, 1.0F);
  for (int part = 0; part < planes->parts(); ++part) {
    const int64_t offset = planes->Offset(part);
    float feature[PlaneFactors::kGroup];
    planes->Forward(part, parameters.data() + offset, {&position, &position, &position}, 1, feature, 1);
    for (const float value : feature) EXPECT_TRUE(value != 0.0F && std::abs(value) <= 1e-4F) << value;
    planes->Backward(part, parameters.data() + offset, {&position, &position, &position}, 1, ones.data(), 1, gradient.data() + offset,
                     touched.data() + offset / kernel::kLineFloats);
    double to_planes = 0.0;
    for (int64_t i = offset; i < offset + dynamic_cast<const PlaneFactors&>(*planes).PlaneEntries(part) * PlaneFactors::kGroup; ++i) {
      to_planes += static_cast<double>(gradient[static_cast<size_t>(i)]);
    }
    EXPECT_NEAR(to_planes, PlaneFactors::kGroup, 1e-5) << "whole";
  }
}

TEST(Frequency, OctavesReachHalfTheFinestResolution) {
  HashGridConfig config;
  config.base_resolution = 1;
  for (const auto& [finest, octaves] : {std::pair{1.0, 1}, {2.0, 1}, {16.0, 4}, {512.0, 9}, {700.0, 9}, {800.0, 10}, {1e6, 16}}) {
    config.finest_resolution = finest;
    const Frequency frequency(config);
    EXPECT_EQ(frequency.octaves(), octaves) << finest;
    EXPECT_EQ(frequency.OutputRows(), kernel::PaddedRows(4 + 6 * octaves));
    EXPECT_EQ(frequency.ParameterCount(), 0);
  }
}

}  // namespace
}  // namespace skyquilt::encoding
