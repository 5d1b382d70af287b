// From the density network's output to optical depth, and its slope.
#include "core/field/density_activation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/field/hash_field.h"

namespace skyquilt::field {
namespace {

constexpr DensityActivation kAll[] = {DensityActivation::kExp, DensityActivation::kSoftplus, DensityActivation::kRelu};

HashField FieldWith(DensityActivation activation, double density_bias) {
  FieldConfig config;
  config.grid.levels = 2;
  config.grid.features = 4;
  config.grid.log2_table_size = 4;
  config.hidden = 4;
  config.density_activation = activation;
  config.density_bias = density_bias;
  return HashField(config);
}

// Optical depths of one step from these raw outputs.
std::vector<float> TausOf(const HashField& field, std::vector<float> raw, float max_log_tau = 15.0F) {
  const size_t n = raw.size();
  raw.resize(static_cast<size_t>(kernel::Padded(static_cast<int64_t>(n))), 0.0F);
  field.StepTau(raw.data(), static_cast<int64_t>(raw.size()), max_log_tau, raw.data());
  raw.resize(n);
  return raw;
}

// The formulas of the header, in double.
double Exact(DensityActivation activation, double raw, double start) {
  switch (activation) {
    case DensityActivation::kSoftplus:
      return std::log1p(std::exp(raw + std::log(std::expm1(start))));
    case DensityActivation::kRelu:
      return std::max(0.0, raw + start);
    default:
      return std::exp(raw + std::log(start));
  }
}

TEST(DensityActivation, HasANameThatIsRead) {
  for (const DensityActivation activation : kAll) EXPECT_EQ(DensityActivationNamed(Name(activation)), activation);
  EXPECT_EQ(Name(DensityActivation::kSoftplus), "softplus");
  try {
    DensityActivationNamed("square");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "density_activation must be one of \"exp\", \"softplus\", \"relu\", got \"square\"");
  }
}

TEST(DensityActivation, StartsWithTheSameDensity) {
  for (const DensityActivation activation : kAll) {
    for (const double density_bias : {-12.0, -5.0, -1.0, 0.0, 1.0, 6.0, 10.0}) {
      const float start = TausOf(FieldWith(activation, density_bias), {0.0F})[0];
      // The shift is rounded to a float.
      EXPECT_NEAR(static_cast<double>(start) / std::exp(density_bias), 1.0, 2e-6) << Name(activation) << " " << density_bias;
    }
  }
}

TEST(DensityActivation, FollowsItsFormula) {
  for (const DensityActivation activation : kAll) {
    const double start = 0.02;
    const HashField field = FieldWith(activation, std::log(start));
    std::vector<float> raw;
    for (int i = -60; i <= 60; ++i) raw.push_back(0.2F * static_cast<float>(i));
    const std::vector<float> taus = TausOf(field, raw);
    for (size_t i = 0; i < raw.size(); ++i) {
      const double exact = Exact(activation, static_cast<double>(raw[i]), start);
      EXPECT_NEAR(static_cast<double>(taus[i]), exact, 3e-6 * exact) << Name(activation) << " " << raw[i];
    }
  }
}

// An untrained output is around 0: it must have a slope in both directions.
TEST(DensityActivation, SlopeIsThatOfTheFormula) {
  for (const DensityActivation activation : kAll) {
    const double start = std::exp(-5.0), h = 1e-6;
    for (const double raw : {-9.0, -0.5, -0.01, -0.003, 0.0, 0.003, 0.01, 0.5, 2.0, 7.0}) {
      const double numeric = (Exact(activation, raw + h, start) - Exact(activation, raw - h, start)) / (2.0 * h);
      const auto tau = static_cast<float>(Exact(activation, raw, start));
      EXPECT_NEAR(static_cast<double>(TauSlope(activation, tau)), numeric, 1e-6 * std::max(1.0, numeric)) << Name(activation) << " " << raw;
    }
    EXPECT_GT(TauSlope(activation, static_cast<float>(Exact(activation, -0.003, start))), 1e-3F) << Name(activation);
  }
}

TEST(DensityActivation, IsCutAtTheLargestOpticalDepth) {
  for (const DensityActivation activation : kAll) {
    const HashField field = FieldWith(activation, -5.0);
    for (const float limit : {2.0F, 15.0F, 30.0F}) {
      const std::vector<float> taus = TausOf(field, {-3e38F, 1e20F, 3e38F}, limit);
      EXPECT_EQ(taus[0], 0.0F);
      EXPECT_NEAR(taus[1], std::exp(limit), 1e-6F * std::exp(limit));
      EXPECT_NEAR(taus[2], std::exp(limit), 1e-6F * std::exp(limit));
    }
  }
}

}  // namespace
}  // namespace skyquilt::field
