#include "core/base/errors.h"
#include "core/kernel/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernel/elementwise_kernels.cpp"
#include <hwy/foreach_target.h>  // re-includes this file once per instruction set
// clang-format off
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace skyquilt::kernel::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::ScalableTag<float>;
using FloatVector = hn::Vec<FloatTag>;
static_assert(HWY_HAVE_SCALABLE || kPad % hn::MaxLanes(FloatTag()) == 0, "a padded batch is a whole number of vectors");

// exp(min(limit, x + bias)) for whole vectors.
void ExpShiftedImpl(const float* x, int64_t n, float bias, float limit, float* out) {
  const FloatTag d;
  const auto lanes = static_cast<int64_t>(hn::Lanes(d));
  for (int64_t s = 0; s < n; s += lanes) {
    hn::StoreU(hn::Exp(d, hn::Min(hn::Set(d, limit), hn::Add(hn::LoadU(d, x + s), hn::Set(d, bias)))), d, out + s);
  }
}

// log(1 + exp(t)) as max(0, t) + log(1 + exp(-|t|)), which neither overflows nor loses digits where exp(t) is small. Of a NaN and a number Min and
// Max give their second argument.
void SoftplusShiftedImpl(const float* x, int64_t n, float bias, float most, float* out) {
  const FloatTag d;
  const auto lanes = static_cast<int64_t>(hn::Lanes(d));
  const auto zero = hn::Zero(d);
  for (int64_t s = 0; s < n; s += lanes) {
    const auto t = hn::Add(hn::LoadU(d, x + s), hn::Set(d, bias));
    const auto bend = hn::Log1p(d, hn::Exp(d, hn::Neg(hn::Abs(t))));
    hn::StoreU(hn::Min(hn::Add(hn::Max(t, zero), bend), hn::Set(d, most)), d, out + s);
  }
}

void ReluShiftedImpl(const float* x, int64_t n, float shift, float most, float* out) {
  const FloatTag d;
  const auto lanes = static_cast<int64_t>(hn::Lanes(d));
  for (int64_t s = 0; s < n; s += lanes) {
    const auto t = hn::Add(hn::LoadU(d, x + s), hn::Set(d, shift));
    hn::StoreU(hn::Min(hn::Max(t, hn::Zero(d)), hn::Set(d, most)), d, out + s);
  }
}

void SigmoidImpl(const float* x, int64_t n, float range, float* out) {
  const FloatTag d;
  const auto lanes = static_cast<int64_t>(hn::Lanes(d));
  const auto one = hn::Set(d, 1.0F);
  for (int64_t s = 0; s < n; s += lanes) {
    // exp(80) is finite in float, and 1 / (1 + exp(80)) is zero for any colour.
    const auto exponent = hn::Min(hn::Set(d, 80.0F), hn::Neg(hn::LoadU(d, x + s)));
    hn::StoreU(hn::Div(hn::Set(d, range), hn::Add(one, hn::Exp(d, exponent))), d, out + s);
  }
}

// sin(2 pi t) for |t| <= 1/4: the Taylor series to t^11, whose next term is below 6e-8.
HWY_INLINE FloatVector SineOfQuarter(FloatTag d, FloatVector t) {
  const auto t2 = hn::Mul(t, t);
  auto sum = hn::Set(d, -15.0946426F);
  for (const float coefficient : {42.0586939F, -76.7058598F, 81.6052493F, -41.3417022F, 6.28318531F}) {
    sum = hn::MulAdd(sum, t2, hn::Set(d, coefficient));
  }
  return hn::Mul(sum, t);
}

void SineCosineImpl(const float* turns, int64_t n, float* sine, float* cosine) {
  const FloatTag d;
  const auto lanes = static_cast<int64_t>(hn::Lanes(d));
  for (int64_t s = 0; s < n; s += lanes) {
    const auto turn = hn::LoadU(d, turns + s);
    const auto t = hn::Sub(turn, hn::Round(turn));  // exact, in [-1/2, 1/2]
    const auto size = hn::Abs(t);
    // The sine is symmetric about a quarter turn.
    const auto near_zero = hn::Min(size, hn::Sub(hn::Set(d, 0.5F), size));
    hn::StoreU(SineOfQuarter(d, hn::CopySignToAbs(near_zero, t)), d, sine + s);
    hn::StoreU(SineOfQuarter(d, hn::Sub(hn::Set(d, 0.25F), size)), d, cosine + s);
  }
}

bool AllFiniteImpl(const float* values, int64_t n) {
  const FloatTag d;
  const auto lanes = static_cast<int64_t>(hn::Lanes(d));
  // x - x is 0 for finite x and NaN otherwise, and a NaN makes the sum NaN.
  auto sum = hn::Zero(d);
  int64_t i = 0;
  for (; i + lanes <= n; i += lanes) {
    const auto value = hn::LoadU(d, values + i);
    sum = hn::Add(sum, hn::Sub(value, value));
  }
  float rest = hn::GetLane(hn::SumOfLanes(d, sum));
  for (; i < n; ++i) rest += values[i] - values[i];
  return rest == 0.0F;
}

int64_t CompactImpl(const float* keep, int64_t n, int rows, const float* in, size_t in_stride, float* out, size_t out_stride) {
  const FloatTag d;
  const auto lanes = static_cast<int64_t>(hn::Lanes(d));
  int64_t kept = 0;
  for (int64_t s = 0; s < n; s += lanes) {
    const auto mask = hn::Gt(hn::LoadU(d, keep + s), hn::Zero(d));
    const auto count = static_cast<int64_t>(hn::CountTrue(d, mask));
    if (count == 0) continue;
    for (int row = 0; row < rows; ++row) {
      const auto value = hn::LoadU(d, in + static_cast<size_t>(row) * in_stride + s);
      hn::StoreU(hn::Compress(value, mask), d, out + static_cast<size_t>(row) * out_stride + kept);
    }
    kept += count;
  }
  return kept;
}

}  // namespace
}  // namespace skyquilt::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace skyquilt::kernel {

HWY_EXPORT(ExpShiftedImpl);
HWY_EXPORT(SoftplusShiftedImpl);
HWY_EXPORT(ReluShiftedImpl);
HWY_EXPORT(SigmoidImpl);
HWY_EXPORT(SineCosineImpl);
HWY_EXPORT(AllFiniteImpl);
HWY_EXPORT(CompactImpl);

namespace {

// The loops above load and store whole vectors; for other lengths they would go past the end of the buffers.
void CheckWholeVectors(int64_t n) {
  SKYQUILT_CHECK(n >= 0 && n % kPad == 0, std::to_string(n) + " samples");
}

}  // namespace

void ExpShifted(const float* x, int64_t n, float bias, float limit, float* out) {
  CheckWholeVectors(n);
  SKYQUILT_CHECK(limit <= kMaxExpLimit, std::to_string(limit));
  HWY_DYNAMIC_DISPATCH(ExpShiftedImpl)(x, n, bias, limit, out);
}

void SoftplusShifted(const float* x, int64_t n, float bias, float most, float* out) {
  CheckWholeVectors(n);
  HWY_DYNAMIC_DISPATCH(SoftplusShiftedImpl)(x, n, bias, most, out);
}

void ReluShifted(const float* x, int64_t n, float shift, float most, float* out) {
  CheckWholeVectors(n);
  HWY_DYNAMIC_DISPATCH(ReluShiftedImpl)(x, n, shift, most, out);
}

void Sigmoid(const float* x, int64_t n, float range, float* out) {
  CheckWholeVectors(n);
  HWY_DYNAMIC_DISPATCH(SigmoidImpl)(x, n, range, out);
}

void SineCosine(const float* turns, int64_t n, float* sine, float* cosine) {
  CheckWholeVectors(n);
  HWY_DYNAMIC_DISPATCH(SineCosineImpl)(turns, n, sine, cosine);
}

bool AllFinite(const float* values, int64_t n) {
  return HWY_DYNAMIC_DISPATCH(AllFiniteImpl)(values, n);
}

int64_t Compact(const float* keep, int64_t n, int rows, const float* in, size_t in_stride, float* out, size_t out_stride) {
  CheckWholeVectors(n);
  const auto columns = static_cast<size_t>(n);
  SKYQUILT_CHECK(rows <= 1 || (in_stride >= columns && out_stride >= columns), std::to_string(in_stride) + ", " + std::to_string(out_stride));
  return HWY_DYNAMIC_DISPATCH(CompactImpl)(keep, n, rows, in, in_stride, out, out_stride);
}

}  // namespace skyquilt::kernel
#endif  // HWY_ONCE
