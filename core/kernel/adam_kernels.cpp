#include <cstring>

#include "core/kernel/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernel/adam_kernels.cpp"
#include <hwy/foreach_target.h>  // re-includes this file once per instruction set
// clang-format off
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace skyquilt::kernel::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::ScalableTag<float>;
using FloatVector = hn::Vec<FloatTag>;

template <class D>
HWY_INLINE hn::Vec<D> AdamMoments(D d, const AdamStep& step, hn::Vec<D> gradient, hn::Vec<D>& m, hn::Vec<D>& v) {
  m = hn::MulAdd(hn::Set(d, 1.0F - step.beta1), gradient, hn::Mul(hn::Set(d, step.beta1), m));
  v = hn::MulAdd(hn::Set(d, 1.0F - step.beta2), hn::Mul(gradient, gradient), hn::Mul(hn::Set(d, step.beta2), v));
  const auto denominator = hn::Add(hn::Sqrt(hn::Mul(v, hn::Set(d, 1.0F / step.correction2))), hn::Set(d, step.epsilon));
  return hn::Div(hn::Mul(m, hn::Set(d, step.learning_rate / step.correction1)), denominator);
}

template <class D>
HWY_INLINE void AdamVector(D d, const AdamStep& step, float* parameter, hn::Vec<D> gradient, float* moment1, float* moment2) {
  auto m = hn::LoadU(d, moment1);
  auto v = hn::LoadU(d, moment2);
  const auto update = AdamMoments(d, step, gradient, m, v);
  hn::StoreU(m, d, moment1);
  hn::StoreU(v, d, moment2);
  hn::StoreU(hn::Sub(hn::LoadU(d, parameter), update), d, parameter);
}

void AdamTouchedImpl(const AdamStep& step, int64_t lines, uint8_t* touched, float* table, float* table_gradient, float* moment1, float* moment2) {
  const hn::CappedTag<float, kLineFloats> d;
  const auto lanes = static_cast<int64_t>(hn::Lanes(d));
  const auto zero = hn::Zero(d);
  for (int64_t line = 0; line < lines; ++line) {
    // Check eight lines at once: most lines of a fine level are not touched.
    if (line % 8 == 0 && line + 8 <= lines) {
      uint64_t marks = 0;
      std::memcpy(&marks, touched + line, sizeof(marks));
      if (marks == 0) {
        line += 7;
        continue;
      }
    }
    if (touched[line] == 0) continue;
    touched[line] = 0;
    for (int64_t i = line * kLineFloats; i < (line + 1) * kLineFloats; i += lanes) {
      const auto gradient = hn::LoadU(d, table_gradient + i);
      const auto moved = hn::Ne(gradient, zero);
      const auto old_m = hn::LoadU(d, moment1 + i);
      const auto old_v = hn::LoadU(d, moment2 + i);
      auto m = old_m;
      auto v = old_v;
      const auto update = AdamMoments(d, step, gradient, m, v);
      hn::StoreU(hn::IfThenElse(moved, m, old_m), d, moment1 + i);
      hn::StoreU(hn::IfThenElse(moved, v, old_v), d, moment2 + i);
      hn::StoreU(hn::Sub(hn::LoadU(d, table + i), hn::IfThenElseZero(moved, update)), d, table + i);
      hn::StoreU(zero, d, table_gradient + i);
    }
  }
}

void AdamDenseImpl(const AdamStep& step, float l2, int64_t n, float* parameters, float* gradient, float* moment1, float* moment2) {
  const FloatTag d;
  const auto lanes = static_cast<int64_t>(hn::Lanes(d));
  int64_t i = 0;
  for (; i + lanes <= n; i += lanes) {
    AdamVector(d, step, parameters + i, hn::MulAdd(hn::Set(d, l2), hn::LoadU(d, parameters + i), hn::LoadU(d, gradient + i)), moment1 + i,
               moment2 + i);
    hn::StoreU(hn::Zero(d), d, gradient + i);
  }
  const hn::CappedTag<float, 1> d1;
  for (; i < n; ++i) {
    AdamVector(d1, step, parameters + i, hn::Set(d1, gradient[i] + l2 * parameters[i]), moment1 + i, moment2 + i);
    gradient[i] = 0.0F;
  }
}

}  // namespace
}  // namespace skyquilt::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace skyquilt::kernel {

HWY_EXPORT(AdamTouchedImpl);
HWY_EXPORT(AdamDenseImpl);

void AdamTouched(const AdamStep& step, int64_t lines, uint8_t* touched, float* table, float* table_gradient, float* moment1, float* moment2) {
  HWY_DYNAMIC_DISPATCH(AdamTouchedImpl)(step, lines, touched, table, table_gradient, moment1, moment2);
}

void AdamDense(const AdamStep& step, float l2, int64_t n, float* parameters, float* gradient, float* moment1, float* moment2) {
  HWY_DYNAMIC_DISPATCH(AdamDenseImpl)(step, l2, n, parameters, gradient, moment1, moment2);
}

}  // namespace skyquilt::kernel
#endif  // HWY_ONCE
