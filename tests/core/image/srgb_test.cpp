// How far the transfer curves are off. They are one scalar code for all instruction sets.
#include "core/image/srgb.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/ulp.h"

namespace skyquilt::image {
namespace {

using testing::EachValue;

// The curves of IEC 61966-2-1 in double. They change from line to power law where the float code does: the standard's two pieces miss each other by
// up to 3e-8 there.
constexpr auto kLinearEnd = static_cast<double>(0.0031308F), kSrgbEnd = static_cast<double>(0.04045F);
double Decoded(double srgb, bool line) {
  return line ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}
double Encoded(double linear, bool line) {
  return line ? linear * 12.92 : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}
// Central differences, right to nine digits, so that the slopes are compared with the curves and not with their own formula.
template <typename Curve>
double Slope(const Curve& curve, double x, bool line) {
  const double h = 1e-5 * std::abs(x) + 1e-9;
  return (curve(x + h, line) - curve(x - h, line)) / (2.0 * h);
}

double ExactLinear(double srgb) {
  return Decoded(srgb, srgb <= kSrgbEnd);
}
double ExactSrgb(double linear) {
  return Encoded(linear, linear <= kLinearEnd);
}
double ExactLinearSlope(double srgb) {
  return Slope(Decoded, srgb, srgb <= kSrgbEnd);
}
double ExactSrgbSlope(double linear) {
  return Slope(Encoded, linear, linear <= kLinearEnd);
}

TEST(Srgb, StaysWithinItsErrors) {
  struct Row {
    testing::UlpBound bound;
    float (*function)(float);
  };
  // After each row: the worst seen over 16 million floats with the GNU C library 2.36.
  const Row table[] = {
      {{"LinearFromSrgb", ExactLinear, -1.0F, 1.0F, 6.5}, LinearFromSrgb},         // 6.22
      {{"LinearFromSrgb past 1", ExactLinear, 1.0F, 16.0F, 9.5}, LinearFromSrgb},  // 9.21
      {{"SrgbFromLinear", ExactSrgb, -1.0F, 1.0F, 3.1}, SrgbFromLinear},           // 2.94
      {{"SrgbFromLinear past 1", ExactSrgb, 1.0F, 1000.0F, 4.0}, SrgbFromLinear},  // 3.76
      {{"LinearSlope", ExactLinearSlope, 0.0F, 1.0F, 6.1}, LinearSlope},           // 5.86
      {{"LinearSlope past 1", ExactLinearSlope, 1.0F, 16.0F, 4.4}, LinearSlope},   // 4.19
      {{"SrgbSlope", ExactSrgbSlope, 0.0F, 1.0F, 3.6}, SrgbSlope},                 // 3.44
      {{"SrgbSlope past 1", ExactSrgbSlope, 1.0F, 1000.0F, 6.6}, SrgbSlope},       // 6.39
  };
  for (const Row& row : table) testing::ExpectWithinUlp(row.bound, "the C library", EachValue(row.function));
}

TEST(Srgb, HasTheStandardsValues) {
  EXPECT_EQ(LinearFromSrgb(0.0F), 0.0F);
  EXPECT_EQ(SrgbFromLinear(0.0F), 0.0F);
  EXPECT_FLOAT_EQ(LinearFromSrgb(1.0F), 1.0F);
  EXPECT_FLOAT_EQ(SrgbFromLinear(1.0F), 1.0F);
  EXPECT_NEAR(LinearFromSrgb(0.5F), 0.21404114, 1e-7);  // closed form, IEC 61966-2-1
  EXPECT_NEAR(SrgbFromLinear(0.21404114F), 0.5, 1e-7);
}

}  // namespace
}  // namespace skyquilt::image
