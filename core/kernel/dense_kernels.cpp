#include <string>
#include <type_traits>

#include "core/base/errors.h"
#include "core/kernel/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernel/dense_kernels.cpp"
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
static_assert(HWY_HAVE_SCALABLE || kPad % hn::MaxLanes(FloatTag()) == 0, "a padded batch is a whole number of vectors");

// Vectors of samples per register tile: 4 x 4 accumulators need 32 registers, 4 x 3 with their operands fill 16.
constexpr int kTileVectors = (HWY_TARGET <= HWY_AVX3) ? 4 : 3;

// What becomes of a sum before it is stored: as it is, cut at zero, or kept where `gate` is positive (the backward of cutting at zero).
struct Store {
  bool relu;
  const float* gate;
  size_t gate_stride;
};

template <int kVectors>
HWY_INLINE void DenseTile(const float* HWY_RESTRICT weights, int n_in, const float* HWY_RESTRICT in, size_t in_stride, const Store& store,
                          const float* gate, float* HWY_RESTRICT out, size_t out_stride) {
  const FloatTag d;
  const size_t lanes = hn::Lanes(d);
  FloatVector sum[4][kVectors];
  for (auto& row : sum) {
    for (auto& vector : row) vector = hn::Zero(d);
  }
  for (int i = 0; i < n_in; ++i) {
    FloatVector value[kVectors];
    for (int v = 0; v < kVectors; ++v) value[v] = hn::LoadU(d, in + static_cast<size_t>(i) * in_stride + static_cast<size_t>(v) * lanes);
    for (int o = 0; o < 4; ++o) {
      const FloatVector weight = hn::Set(d, weights[o * n_in + i]);
      for (int v = 0; v < kVectors; ++v) sum[o][v] = hn::MulAdd(weight, value[v], sum[o][v]);
    }
  }
  const FloatVector zero = hn::Zero(d);
  for (int o = 0; o < 4; ++o) {
    for (int v = 0; v < kVectors; ++v) {
      const size_t column = static_cast<size_t>(v) * lanes;
      FloatVector result = store.relu ? hn::Max(sum[o][v], zero) : sum[o][v];
      if (gate != nullptr) {
        result = hn::IfThenElseZero(hn::Gt(hn::LoadU(d, gate + static_cast<size_t>(o) * store.gate_stride + column), zero), result);
      }
      hn::StoreU(result, d, out + static_cast<size_t>(o) * out_stride + column);
    }
  }
}

template <int kVectors>
HWY_INLINE void DenseColumns(const float* weights, int n_out, int n_in, const float* in, size_t in_stride, const Store& store, int64_t s, float* out,
                             size_t out_stride) {
  for (int o = 0; o < n_out; o += 4) {
    const float* gate = store.gate != nullptr ? store.gate + static_cast<size_t>(o) * store.gate_stride + s : nullptr;
    DenseTile<kVectors>(weights + static_cast<ptrdiff_t>(o) * n_in, n_in, in + s, in_stride, store, gate,
                        out + static_cast<size_t>(o) * out_stride + s, out_stride);
  }
}

void DenseImpl(const float* weights, int n_out, int n_in, const float* in, size_t in_stride, int64_t n, bool relu, const float* gate,
               size_t gate_stride, float* out, size_t out_stride) {
  const FloatTag d;
  const auto lanes = static_cast<int64_t>(hn::Lanes(d));
  const Store store{relu, gate, gate_stride};
  int64_t s = 0;
  for (; s + lanes * kTileVectors <= n; s += lanes * kTileVectors) {
    DenseColumns<kTileVectors>(weights, n_out, n_in, in, in_stride, store, s, out, out_stride);
  }
  if (kTileVectors > 2 && s + 2 * lanes <= n) {
    DenseColumns<2>(weights, n_out, n_in, in, in_stride, store, s, out, out_stride);
    s += 2 * lanes;
  }
  for (; s < n; s += lanes) DenseColumns<1>(weights, n_out, n_in, in, in_stride, store, s, out, out_stride);
}

#if HWY_TARGET <= HWY_AVX3
constexpr int kColumns = 4;
// Sums of the lanes of four vectors as one vector of four: half the shuffles of four separate sums.
HWY_INLINE void AddLaneSums(const FloatVector* v, float* to) {
  const FloatTag d;
  const hn::Repartition<double, FloatTag> d64;
  const FloatVector ab = hn::Add(hn::InterleaveLower(d, v[0], v[1]), hn::InterleaveUpper(d, v[0], v[1]));
  const FloatVector cd = hn::Add(hn::InterleaveLower(d, v[2], v[3]), hn::InterleaveUpper(d, v[2], v[3]));
  const auto ab64 = hn::BitCast(d64, ab);
  const auto cd64 = hn::BitCast(d64, cd);
  const FloatVector blocks = hn::Add(hn::BitCast(d, hn::InterleaveLower(d64, ab64, cd64)), hn::BitCast(d, hn::InterleaveUpper(d64, ab64, cd64)));
  const hn::Half<FloatTag> half;
  const hn::Half<decltype(half)> quarter;
  const auto folded = hn::Add(hn::LowerHalf(half, blocks), hn::UpperHalf(half, blocks));
  const auto sums = hn::Add(hn::LowerHalf(quarter, folded), hn::UpperHalf(quarter, folded));
  hn::StoreU(hn::Add(hn::LoadU(quarter, to), sums), quarter, to);
}
#else
constexpr int kColumns = 3;  // 4 x 3 sums and their operands fill 16 registers
#endif

template <int kCount>
HWY_INLINE void AddSums(const FloatVector* v, float* to) {
#if HWY_TARGET <= HWY_AVX3
  if constexpr (kCount == 4) {
    AddLaneSums(v, to);
    return;
  }
#endif
  const FloatTag d;
  for (int c = 0; c < kCount; ++c) to[c] += hn::GetLane(hn::SumOfLanes(d, v[c]));
}

template <int kCount>
HWY_INLINE void WeightTile(const float* HWY_RESTRICT out_gradient, size_t out_stride, const float* HWY_RESTRICT in, size_t in_stride, int64_t n,
                           float* HWY_RESTRICT weight_gradient, int n_in) {
  const FloatTag d;
  const auto lanes = static_cast<int64_t>(hn::Lanes(d));
  FloatVector sum[4][kCount];
  for (auto& row : sum) {
    for (auto& vector : row) vector = hn::Zero(d);
  }
  for (int64_t s = 0; s < n; s += lanes) {
    FloatVector value[kCount];
    for (int c = 0; c < kCount; ++c) value[c] = hn::LoadU(d, in + static_cast<size_t>(c) * in_stride + s);
    for (int r = 0; r < 4; ++r) {
      const FloatVector gradient = hn::LoadU(d, out_gradient + static_cast<size_t>(r) * out_stride + s);
      for (int c = 0; c < kCount; ++c) sum[r][c] = hn::MulAdd(gradient, value[c], sum[r][c]);
    }
  }
  for (int r = 0; r < 4; ++r) AddSums<kCount>(sum[r], weight_gradient + static_cast<ptrdiff_t>(r) * n_in);
}

void DenseWeightGradientImpl(const float* out_gradient, size_t out_stride, int n_out, const float* in, size_t in_stride, int n_in, int64_t n,
                             float* weight_gradient) {
  // A few input rows stay in the first-level cache while all output rows pass.
  const auto columns = [&](auto count, int i) {
    for (int o = 0; o < n_out; o += 4) {
      WeightTile<decltype(count)::value>(out_gradient + static_cast<size_t>(o) * out_stride, out_stride, in + static_cast<size_t>(i) * in_stride,
                                         in_stride, n, weight_gradient + static_cast<ptrdiff_t>(o) * n_in + i, n_in);
    }
  };
  int i = 0;
  for (; i + kColumns <= n_in; i += kColumns) columns(std::integral_constant<int, kColumns>(), i);
  for (; i < n_in; ++i) columns(std::integral_constant<int, 1>(), i);
}

}  // namespace
}  // namespace skyquilt::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace skyquilt::kernel {

HWY_EXPORT(DenseImpl);
HWY_EXPORT(DenseWeightGradientImpl);

namespace {

// The loops above load and store whole vectors and groups of rows, and would go past the end of anything else.
void CheckPadded(int rows, int64_t n) {
  SKYQUILT_CHECK(rows >= 0 && rows % kRowPad == 0 && n >= 0 && n % kPad == 0, std::to_string(rows) + " rows, " + std::to_string(n) + " samples");
}

void CheckStride(int rows, size_t stride, int64_t n) {
  SKYQUILT_CHECK(rows <= 1 || stride >= static_cast<size_t>(n), "stride " + std::to_string(stride) + ", " + std::to_string(n) + " samples");
}

}  // namespace

void Dense(const float* weights, int n_out, int n_in, const float* in, size_t in_stride, int64_t n, bool relu, float* out, size_t out_stride) {
  CheckPadded(n_out, n);
  CheckStride(n_in, in_stride, n);
  CheckStride(n_out, out_stride, n);
  HWY_DYNAMIC_DISPATCH(DenseImpl)(weights, n_out, n_in, in, in_stride, n, relu, nullptr, 0, out, out_stride);
}

void DenseGated(const float* weights, int n_out, int n_in, const float* in, size_t in_stride, int64_t n, const float* gate, size_t gate_stride,
                float* out, size_t out_stride) {
  CheckPadded(n_out, n);
  CheckStride(n_in, in_stride, n);
  CheckStride(n_out, gate_stride, n);
  CheckStride(n_out, out_stride, n);
  HWY_DYNAMIC_DISPATCH(DenseImpl)(weights, n_out, n_in, in, in_stride, n, false, gate, gate_stride, out, out_stride);
}

void DenseWeightGradient(const float* out_gradient, size_t out_stride, int n_out, const float* in, size_t in_stride, int n_in, int64_t n,
                         float* weight_gradient) {
  CheckPadded(n_out, n);
  CheckPadded(n_in, n);
  CheckStride(n_out, out_stride, n);
  CheckStride(n_in, in_stride, n);
  HWY_DYNAMIC_DISPATCH(DenseWeightGradientImpl)(out_gradient, out_stride, n_out, in, in_stride, n_in, n, weight_gradient);
}

}  // namespace skyquilt::kernel
#endif  // HWY_ONCE
