// Errors of approximated functions in units in the last place (ulp): one ulp is the distance between neighbouring floats at the exact result.
// A correctly rounded result is off by at most half an ulp.
//   const UlpBound kExp = {"exp", [](double x) { return std::exp(x); }, -87.0F, 88.0F, 1.5};
//   ExpectWithinUlp(kExp, "libm", EachValue([](float x) { return std::exp(x); }));
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace skyquilt::testing {

struct UlpBound {
  const char* name;
  double (*exact)(double);
  float min, max;         // the range that holds it, ends included
  double max_ulp;         // largest error allowed
  double absolute = 0.0;  // errors up to this are allowed too, where results near zero have no digits to count
};

// Evaluates a function at x[0..n) into out. n is a multiple of kSweepPad.
using Batch = std::function<void(const float* x, int64_t n, float* out)>;
constexpr size_t kSweepPad = 64;

// A batch of a function of one value.
inline Batch EachValue(float (*function)(float)) {
  return [function](const float* x, int64_t n, float* out) { std::transform(x, x + n, out, function); };
}

// Distance between the floats on either side of a value; constant among the subnormals.
inline double UlpAt(double exact) {
  constexpr double kSmallest = 0x1p-149;
  return exact == 0.0 ? kSmallest : std::max(kSmallest, std::ldexp(1.0, std::ilogb(exact) - 23));
}

inline double UlpError(float got, double exact) {
  if (!std::isfinite(got)) return std::numeric_limits<double>::infinity();
  return std::abs(static_cast<double>(got) - exact) / UlpAt(exact);
}

// About `points` floats from min to max, both included, evenly over the bit patterns: as many in [1, 2) as in [2, 4). Ends in copies of max up to a
// multiple of kSweepPad.
inline std::vector<float> FloatSweep(float min, float max, int64_t points) {
  // Patterns as whole numbers in the order of their values: neighbouring floats differ by one, both zeros are 0.
  const auto place = [](float x) {
    const auto size = static_cast<int64_t>(std::bit_cast<uint32_t>(x) & 0x7FFFFFFFU);
    return std::signbit(x) ? -size : size;
  };
  const auto value = [](int64_t at) { return std::bit_cast<float>(static_cast<uint32_t>(std::abs(at)) | (at < 0 ? 0x80000000U : 0U)); };
  const int64_t first = place(min), last = place(max);
  const int64_t step = std::max<int64_t>(1, (last - first) / points) | 1;  // odd: the low bits take all values
  std::vector<float> sweep;
  for (int64_t at = first; at < last; at += step) sweep.push_back(value(at));
  do {
    sweep.push_back(max);
  } while (sweep.size() % kSweepPad != 0);
  return sweep;
}

struct WorstError {
  float x = 0.0F, got = 0.0F;
  double exact = 0.0, ulp = 0.0;
};

inline WorstError FindWorstError(const UlpBound& bound, const Batch& batch, int64_t points) {
  const std::vector<float> x = FloatSweep(bound.min, bound.max, points);
  std::vector<float> got(x.size());
  batch(x.data(), static_cast<int64_t>(x.size()), got.data());
  WorstError worst;
  for (size_t i = 0; i < x.size(); ++i) {
    const double exact = bound.exact(static_cast<double>(x[i]));
    if (std::abs(static_cast<double>(got[i]) - exact) <= bound.absolute) continue;
    const double ulp = UlpError(got[i], exact);
    if (ulp > worst.ulp) worst = {x[i], got[i], exact, ulp};
  }
  return worst;
}

inline void ExpectWithinUlp(const UlpBound& bound, const std::string& target, const Batch& batch) {
  constexpr int64_t kPoints = 1 << 20;
  const WorstError worst = FindWorstError(bound, batch, kPoints);
  EXPECT_LE(worst.ulp, bound.max_ulp) << bound.name << " on " << target << ": x = " << worst.x << ", got " << worst.got << ", expected "
                                      << worst.exact << ", off by " << worst.ulp << " ulp";
}

}  // namespace skyquilt::testing
