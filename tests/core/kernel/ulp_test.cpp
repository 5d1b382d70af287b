// How far the approximated functions are off, on every instruction set and in their scalar twins.
#include "tests/support/ulp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "core/kernel/kernels.h"
#include "core/kernel/reference.h"
#include "tests/support/each_instruction_set.h"
#include "tests/support/not_finite.h"

namespace skyquilt::kernel {
namespace {

using testing::Batch;
using testing::UlpBound;
using Limits = std::numeric_limits<float>;

constexpr float kLargest = Limits::max();
constexpr float kTiny = Limits::denorm_min();
constexpr float kRange = 1.5F;

Batch Exp(float bias, float limit) {
  return [=](const float* x, int64_t n, float* out) { ExpShifted(x, n, bias, limit, out); };
}
Batch Softplus(float bias, float most = kLargest) {
  return [=](const float* x, int64_t n, float* out) { SoftplusShifted(x, n, bias, most, out); };
}
Batch Relu(float shift, float most = kLargest) {
  return [=](const float* x, int64_t n, float* out) { ReluShifted(x, n, shift, most, out); };
}
Batch ScaledSigmoid(float range) {
  return [=](const float* x, int64_t n, float* out) { Sigmoid(x, n, range, out); };
}
void Sine(const float* turns, int64_t n, float* out) {
  std::vector<float> cosine(static_cast<size_t>(n));
  SineCosine(turns, n, out, cosine.data());
}
void Cosine(const float* turns, int64_t n, float* out) {
  std::vector<float> sine(static_cast<size_t>(n));
  SineCosine(turns, n, sine.data(), out);
}

// What a step of Adam adds to a parameter of zero, by its gradient.
struct AdamState {
  AdamStep step;
  float moments = 0.0F;
};
AdamState Adam(int t, float moments) {
  AdamState state = {.step = {}, .moments = moments};
  state.step.correction1 = static_cast<float>(1.0 - std::pow(static_cast<double>(state.step.beta1), t));
  state.step.correction2 = static_cast<float>(1.0 - std::pow(static_cast<double>(state.step.beta2), t));
  return state;
}
const AdamState kFirst = Adam(1, 0.0F);
const AdamState kLater = Adam(100, 1.0F);
Batch DenseStep(const AdamState& state) {
  return [=](const float* gradient, int64_t n, float* out) {
    std::vector<float> g(gradient, gradient + n), m(g.size(), state.moments), v(g.size(), state.moments);
    std::fill_n(out, n, 0.0F);
    AdamDense(state.step, 0.0F, n, out, g.data(), m.data(), v.data());
  };
}
Batch TouchedStep(const AdamState& state) {
  return [=](const float* gradient, int64_t n, float* out) {
    std::vector<float> g(gradient, gradient + n), m(g.size(), state.moments), v(g.size(), state.moments);
    std::vector<uint8_t> touched(g.size() / kLineFloats, 1);
    std::fill_n(out, n, 0.0F);
    AdamTouched(state.step, n / kLineFloats, touched.data(), out, g.data(), m.data(), v.data());
  };
}
template <typename T>
T TwinStep(const AdamState& state, T gradient) {
  T parameter = T(0), m = static_cast<T>(state.moments), v = m;
  reference::Adam(state.step, gradient, &parameter, &m, &v);
  return parameter;
}

// The twins, in float as themselves, in double as the exact result.
constexpr auto kExp = [](auto x) { return reference::ExpShifted(x, decltype(x)(0), decltype(x)(kMaxExpLimit)); };
constexpr auto kShiftedExp = [](auto x) { return reference::ExpShifted(x, decltype(x)(-5), decltype(x)(kMaxExpLimit)); };
constexpr auto kSoftplus = [](auto x) { return reference::SoftplusShifted(x, decltype(x)(0), decltype(x)(kLargest)); };
constexpr auto kShiftedRelu = [](auto x) { return reference::ReluShifted(x, decltype(x)(0.5), decltype(x)(kLargest)); };
constexpr auto kSigmoid = [](auto x) { return reference::Sigmoid(x, decltype(x)(1)); };
constexpr auto kScaledSigmoid = [](auto x) { return reference::Sigmoid(x, decltype(x)(kRange)); };
constexpr auto kSine = [](auto turns) {
  decltype(turns) sine, cosine;
  reference::SineCosine(turns, &sine, &cosine);
  return sine;
};
constexpr auto kCosine = [](auto turns) {
  decltype(turns) sine, cosine;
  reference::SineCosine(turns, &sine, &cosine);
  return cosine;
};
constexpr auto kFirstStep = [](auto gradient) { return TwinStep(kFirst, gradient); };
constexpr auto kLaterStep = [](auto gradient) { return TwinStep(kLater, gradient); };

struct Row {
  UlpBound bound;
  Batch kernel;
  float (*twin)(float);
};

template <typename Twin>
Row MakeRow(const char* name, const Batch& kernel, Twin twin, float min, float max, double max_ulp, double absolute = 0.0) {
  return {{name, twin, min, max, max_ulp, absolute}, kernel, twin};
}

// After each row: the worst seen with multiply and add in one rounding (avx2, avx3), without (sse4, ssse3, scalar), and in the twin with the GNU C
// library 2.36, over at least 32 million floats of the row's range.
std::vector<Row> Table() {
  // Below -80 the kernel stays at its result for -80, which no sum of colours notices: digits do not count there.
  constexpr double kSigmoidEnd = 1.81e-35;
  return {
      MakeRow("exp", Exp(0.0F, kMaxExpLimit), kExp, -kLargest, kMaxExpLimit, 1.1),                       // 1.04  0.99  0.51
      MakeRow("exp(x - 5)", Exp(-5.0F, kMaxExpLimit), kShiftedExp, -11.0F, 21.0F, 8.6),                  // 8.50  8.50  8.50
      MakeRow("softplus", Softplus(0.0F), kSoftplus, -kLargest, kLargest, 2.9),                          // 2.73  2.73  1.48
      MakeRow("relu(x + 0.5)", Relu(0.5F), kShiftedRelu, -kLargest, kLargest, 0.5),                      // 0.50  0.50  0.50
      MakeRow("sigmoid", ScaledSigmoid(1.0F), kSigmoid, -80.0F, kLargest, 2.6),                          // 2.49  2.49  2.49
      MakeRow("1.5 sigmoid", ScaledSigmoid(kRange), kScaledSigmoid, -80.0F, kLargest, 2.0),              // 1.95  1.95  1.95
      MakeRow("sigmoid below -80", ScaledSigmoid(1.0F), kSigmoid, -kLargest, -80.0F, 0.0, kSigmoidEnd),  // absolute: 1.81e-35 on all
      MakeRow("sine", Sine, kSine, -kLargest, kLargest, 3.1),                                            // 2.49  2.94  1.98
      MakeRow("cosine", Cosine, kCosine, -kLargest, kLargest, 3.1),                                      // 2.61  3.00  1.97
      MakeRow("first step of AdamDense", DenseStep(kFirst), kFirstStep, 1e-30F, 1e18F, 4.8),             // 4.62  4.62  4.62
      MakeRow("first step of AdamTouched", TouchedStep(kFirst), kFirstStep, 1e-30F, 1e18F, 4.8),         // 4.62  4.62  4.62
      MakeRow("later step of AdamDense", DenseStep(kLater), kLaterStep, 1e-30F, 1e18F, 3.8),             // 3.71  3.71  3.52
      MakeRow("later step of AdamTouched", TouchedStep(kLater), kLaterStep, 1e-30F, 1e18F, 3.8),         // 3.71  3.71  3.52
  };
}

using UlpTable = testing::EachInstructionSet;
SKYQUILT_EACH_INSTRUCTION_SET(UlpTable);

TEST_P(UlpTable, HoldsForEveryKernel) {
  for (const Row& row : Table()) testing::ExpectWithinUlp(row.bound, GetParam(), row.kernel);
}

TEST(UlpTable, HoldsForEveryTwin) {
  for (const Row& row : Table()) testing::ExpectWithinUlp(row.bound, "the scalar twin", testing::EachValue(row.twin));
}

float At(const Batch& kernel, float x) {
  const std::vector<float> in(kPad, x);
  std::vector<float> out(kPad);
  kernel(in.data(), kPad, out.data());
  return out[0];
}

using SpecialValues = testing::EachInstructionSet;
SKYQUILT_EACH_INSTRUCTION_SET(SpecialValues);

TEST_P(SpecialValues, AreExact) {
  struct Case {
    const char* name;
    Batch kernel;
    float x, expected;
  };
  const Batch exp = Exp(0.0F, 15.0F), exp_to_its_limit = Exp(0.0F, kMaxExpLimit), sigmoid = ScaledSigmoid(kRange);
  const float top = At(exp, 15.0F), most = At(exp_to_its_limit, kMaxExpLimit), least = At(sigmoid, -80.0F);
  EXPECT_TRUE(std::isfinite(most));
  EXPECT_GT(least, 0.0F);
  std::vector<Case> cases;
  for (const float x : {0.0F, -0.0F, kTiny, -kTiny}) {
    cases.push_back({"exp", exp, x, 1.0F});
    cases.push_back({"sigmoid", sigmoid, x, 0.5F * kRange});
    cases.push_back({"cosine", Cosine, x, 1.0F});
  }
  for (const float x : {kInfinityFloat, kLargest, 16.0F}) cases.push_back({"exp", exp, x, top});
  for (const float x : {kInfinityFloat, kLargest, 89.0F}) cases.push_back({"exp", exp_to_its_limit, x, most});
  for (const float x : {-kInfinityFloat, -kLargest, -104.1F}) cases.push_back({"exp", exp, x, 0.0F});
  for (const float x : {kInfinityFloat, kLargest, 30.0F}) cases.push_back({"sigmoid", sigmoid, x, kRange});
  for (const float x : {-kInfinityFloat, -kLargest, -81.0F}) cases.push_back({"sigmoid", sigmoid, x, least});
  for (const float x : {3.0F, kLargest, kInfinityFloat}) {
    cases.push_back({"softplus", Softplus(0.0F, 2.5F), x, 2.5F});
    cases.push_back({"relu", Relu(0.0F, 2.5F), x, 2.5F});
    cases.push_back({"relu", Relu(0.5F, kLargest), -x, 0.0F});
  }
  for (const float x : {-104.1F, -kLargest, -kInfinityFloat}) cases.push_back({"softplus", Softplus(0.0F), x, 0.0F});
  for (const float x : {20.0F, 1e6F, kLargest}) cases.push_back({"softplus", Softplus(0.0F), x, x});
  for (const float whole : {0.0F, -0.0F, 1.0F, -7.0F, 0x1p22F, -0x1p24F}) cases.push_back({"sine", Sine, whole, 0.0F});
  for (const float half : {0.5F, -0.5F, 1000.5F}) cases.push_back({"sine", Sine, half, 0.0F});
  for (const float quarter : {0.25F, -0.25F, 0.75F, -1000.75F}) cases.push_back({"cosine", Cosine, quarter, 0.0F});
  for (const Case& c : cases) EXPECT_EQ(At(c.kernel, c.x), c.expected) << c.name << " of " << c.x << " on " << GetParam();
}

TEST_P(SpecialValues, NanComesOutAsTheHeaderSays) {
  for (const float x : {Limits::quiet_NaN(), kInfinityFloat, -kInfinityFloat}) {
    EXPECT_TRUE(std::isnan(At(Sine, x)));
    EXPECT_TRUE(std::isnan(At(Cosine, x)));
  }
  EXPECT_TRUE(std::isfinite(At(Exp(0.0F, 15.0F), Limits::quiet_NaN())));
  EXPECT_TRUE(std::isfinite(At(ScaledSigmoid(kRange), Limits::quiet_NaN())));
  EXPECT_TRUE(std::isfinite(At(Softplus(0.0F, 15.0F), Limits::quiet_NaN())));
  EXPECT_TRUE(std::isfinite(At(Relu(0.0F, 15.0F), Limits::quiet_NaN())));
}

TEST_P(SpecialValues, SigmoidStaysInItsRange) {
  const std::vector<float> x = testing::FloatSweep(-kLargest, kLargest, 1 << 16);
  std::vector<float> out(x.size());
  for (const float range : {1.0F, 1.02F, kRange, 4.0F}) {
    Sigmoid(x.data(), static_cast<int64_t>(x.size()), range, out.data());
    const auto [least, most] = std::minmax_element(out.begin(), out.end());
    EXPECT_GE(*least, 0.0F);
    EXPECT_LE(*most, range);
  }
}

TEST(ExpShifted, RefusesALimitWhoseExpIsInfinite) {
  std::vector<float> x(kPad, 0.0F);
  EXPECT_THROW(ExpShifted(x.data(), kPad, 0.0F, 89.0F, x.data()), std::logic_error);
  EXPECT_THROW(ExpShifted(x.data(), kPad, 0.0F, Limits::quiet_NaN(), x.data()), std::logic_error);
}

}  // namespace
}  // namespace skyquilt::kernel
