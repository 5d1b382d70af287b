#include "core/kernel/kernels.h"

#include <stdexcept>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernel/kernels.cpp"
#include <hwy/foreach_target.h>  // re-includes this file once per instruction set
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace skyquilt::kernel::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::ScalableTag<float>;
using FloatVector = hn::Vec<FloatTag>;

// Vectors of samples per register tile: 4 x 4 accumulators need 32 registers, 4 x 2 fit 16.
constexpr int kTileVectors = (HWY_TARGET <= HWY_AVX3) ? 4 : 2;

template <int kVectors>
HWY_INLINE void DenseTile(const float* HWY_RESTRICT weights, int n_in, const float* HWY_RESTRICT in, size_t in_stride, bool relu,
                          float* HWY_RESTRICT out, size_t out_stride) {
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
  for (int o = 0; o < 4; ++o) {
    for (int v = 0; v < kVectors; ++v) {
      const FloatVector result = relu ? hn::Max(sum[o][v], hn::Zero(d)) : sum[o][v];
      hn::StoreU(result, d, out + static_cast<size_t>(o) * out_stride + static_cast<size_t>(v) * lanes);
    }
  }
}

void DenseImpl(const float* weights, int n_out, int n_in, const float* in, size_t in_stride, int64_t n, bool relu, float* out, size_t out_stride) {
  const FloatTag d;
  const int64_t lanes = static_cast<int64_t>(hn::Lanes(d));
  for (int64_t s = 0; s < n; s += lanes * kTileVectors) {
    for (int o = 0; o < n_out; o += 4) {
      DenseTile<kTileVectors>(weights + static_cast<ptrdiff_t>(o) * n_in, n_in, in + s, in_stride, relu,
                              out + static_cast<size_t>(o) * out_stride + s, out_stride);
    }
  }
}

void DenseWeightGradientImpl(const float* out_gradient, size_t out_stride, int n_out, const float* in, size_t in_stride, int n_in, int64_t n,
                             float* weight_gradient) {
  const FloatTag d;
  const int64_t lanes = static_cast<int64_t>(hn::Lanes(d));
  constexpr int kColumns = (HWY_TARGET <= HWY_AVX3) ? 4 : 2;
  for (int o = 0; o < n_out; o += 4) {
    for (int i = 0; i < n_in; i += kColumns) {
      FloatVector sum[4][kColumns];
      for (auto& row : sum) {
        for (auto& vector : row) vector = hn::Zero(d);
      }
      for (int64_t s = 0; s < n; s += lanes) {
        FloatVector value[kColumns];
        for (int c = 0; c < kColumns; ++c) value[c] = hn::LoadU(d, in + static_cast<size_t>(i + c) * in_stride + s);
        for (int r = 0; r < 4; ++r) {
          const FloatVector gradient = hn::LoadU(d, out_gradient + static_cast<size_t>(o + r) * out_stride + s);
          for (int c = 0; c < kColumns; ++c) sum[r][c] = hn::MulAdd(gradient, value[c], sum[r][c]);
        }
      }
      for (int r = 0; r < 4; ++r) {
        for (int c = 0; c < kColumns; ++c) weight_gradient[(o + r) * n_in + i + c] += hn::GetLane(hn::SumOfLanes(d, sum[r][c]));
      }
    }
  }
}

void ReluBackwardImpl(const float* activation, size_t activation_stride, int rows, int64_t n, float* gradient, size_t gradient_stride) {
  const FloatTag d;
  const int64_t lanes = static_cast<int64_t>(hn::Lanes(d));
  const FloatVector zero = hn::Zero(d);
  for (int r = 0; r < rows; ++r) {
    const float* a = activation + static_cast<size_t>(r) * activation_stride;
    float* g = gradient + static_cast<size_t>(r) * gradient_stride;
    for (int64_t s = 0; s < n; s += lanes) {
      hn::StoreU(hn::IfThenElseZero(hn::Gt(hn::LoadU(d, a + s), zero), hn::LoadU(d, g + s)), d, g + s);
    }
  }
}

constexpr int kHashBlock = 256;

// Entries and weights of the eight corners for up to kHashBlock positions; corner c of position s at [c * kHashBlock + s].
struct Corners {
  HWY_ALIGN uint32_t index[8 * kHashBlock];
  HWY_ALIGN float weight[8 * kHashBlock];
};

// Lowest lattice coordinate and fraction along one axis. NaN compares false and lands at 0.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void SplitAxis(D d, V position, float cells_per_unit, int32_t size, hn::Vec<hn::Rebind<int32_t, D>>& cell, V& fraction) {
  const hn::Rebind<int32_t, D> di;
  const V top = hn::Set(d, static_cast<float>(size - 1));
  V scaled = hn::Mul(position, hn::Set(d, cells_per_unit));
  scaled = hn::IfThenElseZero(hn::Gt(scaled, hn::Zero(d)), scaled);
  scaled = hn::Min(scaled, top);
  cell = hn::Min(hn::ConvertTo(di, scaled), hn::Set(di, size - 2));
  fraction = hn::Sub(scaled, hn::ConvertTo(d, cell));
}

void FindCorners(const HashLevel& level, const float* x, const float* y, const float* z, int n, Corners& corners) {
  const FloatTag d;
  const hn::Rebind<int32_t, FloatTag> di;
  const hn::Rebind<uint32_t, FloatTag> du;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto mask = hn::Set(du, level.entries - 1U);
  HWY_ALIGN float tail[3][hn::MaxLanes(FloatTag())];
  for (int s = 0; s < n; s += lanes) {
    const float* px = x + s;
    const float* py = y + s;
    const float* pz = z + s;
    if (s + lanes > n) {
      for (int k = 0; k < lanes; ++k) {
        const int from = std::min(k, n - s - 1);
        tail[0][k] = px[from];
        tail[1][k] = py[from];
        tail[2][k] = pz[from];
      }
      px = tail[0];
      py = tail[1];
      pz = tail[2];
    }
    auto cx = hn::Zero(di);
    auto cy = hn::Zero(di);
    auto cz = hn::Zero(di);
    FloatVector fx, fy, fz;
    SplitAxis(d, hn::LoadU(d, px), level.cells_per_unit, level.size[0], cx, fx);
    SplitAxis(d, hn::LoadU(d, py), level.cells_per_unit, level.size[1], cy, fy);
    SplitAxis(d, hn::LoadU(d, pz), level.cells_per_unit, level.size[2], cz, fz);
    const FloatVector one = hn::Set(d, 1.0F);
    const FloatVector wx[2] = {hn::Sub(one, fx), fx};
    const FloatVector wy[2] = {hn::Sub(one, fy), fy};
    const FloatVector wz[2] = {hn::Sub(one, fz), fz};
    const auto ux = hn::BitCast(du, cx);
    const auto uy = hn::BitCast(du, cy);
    const auto uz = hn::BitCast(du, cz);
    const auto step = hn::Set(du, 1U);
    const auto stride_y = hn::Set(du, level.dense ? static_cast<uint32_t>(level.size[0]) : 2654435761U);
    const auto stride_z = hn::Set(du, level.dense ? static_cast<uint32_t>(level.size[0] * level.size[1]) : 805459861U);
    const decltype(ux) ix[2] = {ux, hn::Add(ux, step)};
    const auto iy0 = hn::Mul(uy, stride_y);
    const auto iz0 = hn::Mul(uz, stride_z);
    const decltype(ux) iy[2] = {iy0, hn::Add(iy0, stride_y)};
    const decltype(ux) iz[2] = {iz0, hn::Add(iz0, stride_z)};
    for (int c = 0; c < 8; ++c) {
      const int bx = c & 1;
      const int by = (c >> 1) & 1;
      const int bz = c >> 2;
      const auto index = level.dense ? hn::Add(hn::Add(ix[bx], iy[by]), iz[bz]) : hn::And(hn::Xor(hn::Xor(ix[bx], iy[by]), iz[bz]), mask);
      hn::Store(index, du, corners.index + c * kHashBlock + s);
      hn::Store(hn::Mul(hn::Mul(wx[bx], wy[by]), wz[bz]), d, corners.weight + c * kHashBlock + s);
    }
  }
}

// One table entry as one vector where the instruction set has that width, as single lanes on the scalar path.
template <int kFeatures>
using EntryTag = hn::CappedTag<float, kFeatures>;
template <int kFeatures>
constexpr int kEntryLanes = static_cast<int>(hn::MaxLanes(EntryTag<kFeatures>()));

template <int kFeatures>
void HashForwardFeatures(const HashLevel& level, const float* table, const float* x, const float* y, const float* z, int64_t n, float* out,
                         size_t out_stride) {
  const EntryTag<kFeatures> d;
  constexpr int kLanes = kEntryLanes<kFeatures>;
  Corners corners;
  for (int64_t begin = 0; begin < n; begin += kHashBlock) {
    const int count = static_cast<int>(std::min<int64_t>(kHashBlock, n - begin));
    FindCorners(level, x + begin, y + begin, z + begin, count, corners);
    for (int s = 0; s < count; ++s) {
      HWY_ALIGN float feature[kFeatures];
      for (int f = 0; f < kFeatures; f += kLanes) {
        auto even = hn::Zero(d);
        auto odd = hn::Zero(d);
        for (int c = 0; c < 8; c += 2) {
          const float* entry0 = table + static_cast<size_t>(corners.index[c * kHashBlock + s]) * kFeatures + f;
          const float* entry1 = table + static_cast<size_t>(corners.index[(c + 1) * kHashBlock + s]) * kFeatures + f;
          even = hn::MulAdd(hn::Set(d, corners.weight[c * kHashBlock + s]), hn::LoadU(d, entry0), even);
          odd = hn::MulAdd(hn::Set(d, corners.weight[(c + 1) * kHashBlock + s]), hn::LoadU(d, entry1), odd);
        }
        hn::StoreU(hn::Add(even, odd), d, feature + f);
      }
      for (int f = 0; f < kFeatures; ++f) out[static_cast<size_t>(f) * out_stride + static_cast<size_t>(begin + s)] = feature[f];
    }
  }
}

template <int kFeatures>
void HashBackwardFeatures(const HashLevel& level, const float* x, const float* y, const float* z, int64_t n, const float* out_gradient,
                          size_t out_stride, float* table_gradient, uint8_t* touched, uint32_t* list, uint32_t* count) {
  const EntryTag<kFeatures> d;
  constexpr int kLanes = kEntryLanes<kFeatures>;
  Corners corners;
  uint32_t listed = *count;
  for (int64_t begin = 0; begin < n; begin += kHashBlock) {
    const int samples = static_cast<int>(std::min<int64_t>(kHashBlock, n - begin));
    FindCorners(level, x + begin, y + begin, z + begin, samples, corners);
    for (int s = 0; s < samples; ++s) {
      HWY_ALIGN float feature[kFeatures];
      bool any = false;
      for (int f = 0; f < kFeatures; ++f) {
        feature[f] = out_gradient[static_cast<size_t>(f) * out_stride + static_cast<size_t>(begin + s)];
        any = any || feature[f] != 0.0F;
      }
      if (!any) continue;
      for (int c = 0; c < 8; ++c) {
        const uint32_t index = corners.index[c * kHashBlock + s];
        const auto weight = hn::Set(d, corners.weight[c * kHashBlock + s]);
        for (int f = 0; f < kFeatures; f += kLanes) {
          float* entry = table_gradient + static_cast<size_t>(index) * kFeatures + f;
          hn::StoreU(hn::MulAdd(weight, hn::LoadU(d, feature + f), hn::LoadU(d, entry)), d, entry);
        }
        if (touched[index] == 0) {
          touched[index] = 1;
          list[listed++] = index;
        }
      }
    }
  }
  *count = listed;
}

void HashForwardImpl(const HashLevel& level, int features, const float* table, const float* x, const float* y, const float* z, int64_t n, float* out,
                     size_t out_stride) {
  if (features == 4) {
    HashForwardFeatures<4>(level, table, x, y, z, n, out, out_stride);
  } else {
    HashForwardFeatures<2>(level, table, x, y, z, n, out, out_stride);
  }
}

void HashBackwardImpl(const HashLevel& level, int features, const float* x, const float* y, const float* z, int64_t n, const float* out_gradient,
                      size_t out_stride, float* table_gradient, uint8_t* touched, uint32_t* list, uint32_t* count) {
  if (features == 4) {
    HashBackwardFeatures<4>(level, x, y, z, n, out_gradient, out_stride, table_gradient, touched, list, count);
  } else {
    HashBackwardFeatures<2>(level, x, y, z, n, out_gradient, out_stride, table_gradient, touched, list, count);
  }
}

template <class D>
HWY_INLINE void AdamVector(D d, const AdamStep& step, float* parameter, hn::Vec<D> gradient, float* moment1, float* moment2) {
  const auto m = hn::MulAdd(hn::Set(d, 1.0F - step.beta1), gradient, hn::Mul(hn::Set(d, step.beta1), hn::LoadU(d, moment1)));
  const auto v = hn::MulAdd(hn::Set(d, 1.0F - step.beta2), hn::Mul(gradient, gradient), hn::Mul(hn::Set(d, step.beta2), hn::LoadU(d, moment2)));
  hn::StoreU(m, d, moment1);
  hn::StoreU(v, d, moment2);
  const auto denominator = hn::Add(hn::Sqrt(hn::Mul(v, hn::Set(d, 1.0F / step.correction2))), hn::Set(d, step.epsilon));
  const auto update = hn::Div(hn::Mul(m, hn::Set(d, step.learning_rate / step.correction1)), denominator);
  hn::StoreU(hn::Sub(hn::LoadU(d, parameter), update), d, parameter);
}

template <int kFeatures>
void AdamListedFeatures(const AdamStep& step, const uint32_t* list, uint32_t count, float* table, float* table_gradient, float* moment1,
                        float* moment2, uint8_t* touched) {
  const EntryTag<kFeatures> d;
  constexpr int kLanes = kEntryLanes<kFeatures>;
  for (uint32_t k = 0; k < count; ++k) {
    const size_t offset = static_cast<size_t>(list[k]) * kFeatures;
    for (size_t f = offset; f < offset + kFeatures; f += kLanes) {
      AdamVector(d, step, table + f, hn::LoadU(d, table_gradient + f), moment1 + f, moment2 + f);
      hn::StoreU(hn::Zero(d), d, table_gradient + f);
    }
    touched[list[k]] = 0;
  }
}

void AdamListedImpl(const AdamStep& step, int features, const uint32_t* list, uint32_t count, float* table, float* table_gradient, float* moment1,
                    float* moment2, uint8_t* touched) {
  if (features == 4) {
    AdamListedFeatures<4>(step, list, count, table, table_gradient, moment1, moment2, touched);
  } else {
    AdamListedFeatures<2>(step, list, count, table, table_gradient, moment1, moment2, touched);
  }
}

void AdamDenseImpl(const AdamStep& step, float l2, int64_t n, float* parameters, float* gradient, float* moment1, float* moment2) {
  const FloatTag d;
  const int64_t lanes = static_cast<int64_t>(hn::Lanes(d));
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

const char* TargetNameImpl() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace skyquilt::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace skyquilt::kernel {

HWY_EXPORT(DenseImpl);
HWY_EXPORT(DenseWeightGradientImpl);
HWY_EXPORT(ReluBackwardImpl);
HWY_EXPORT(HashForwardImpl);
HWY_EXPORT(HashBackwardImpl);
HWY_EXPORT(AdamListedImpl);
HWY_EXPORT(AdamDenseImpl);
HWY_EXPORT(TargetNameImpl);

namespace {
void RequireFeatures(int features) {
  if (features != 2 && features != 4) throw std::logic_error("hash grid: features per entry must be 2 or 4, got " + std::to_string(features));
}
void RequirePadded(int rows, int64_t n) {
  if (rows % kRowPad != 0 || n % kPad != 0) {
    throw std::logic_error("dense kernel: rows and samples must be padded, got " + std::to_string(rows) + " rows, " + std::to_string(n) + " samples");
  }
}
}  // namespace

std::string ActiveInstructionSet() {
  return HWY_DYNAMIC_DISPATCH(TargetNameImpl)();
}

uint32_t HashIndex(const HashLevel& level, uint32_t x, uint32_t y, uint32_t z) {
  if (level.dense) return x + y * static_cast<uint32_t>(level.size[0]) + z * static_cast<uint32_t>(level.size[0] * level.size[1]);
  return (x ^ (y * 2654435761U) ^ (z * 805459861U)) & (level.entries - 1U);
}

void Dense(const float* weights, int n_out, int n_in, const float* in, size_t in_stride, int64_t n, bool relu, float* out, size_t out_stride) {
  RequirePadded(n_out, n);
  HWY_DYNAMIC_DISPATCH(DenseImpl)(weights, n_out, n_in, in, in_stride, n, relu, out, out_stride);
}

void DenseWeightGradient(const float* out_gradient, size_t out_stride, int n_out, const float* in, size_t in_stride, int n_in, int64_t n,
                         float* weight_gradient) {
  RequirePadded(n_out, n);
  RequirePadded(n_in, n);
  HWY_DYNAMIC_DISPATCH(DenseWeightGradientImpl)(out_gradient, out_stride, n_out, in, in_stride, n_in, n, weight_gradient);
}

void ReluBackward(const float* activation, size_t activation_stride, int rows, int64_t n, float* gradient, size_t gradient_stride) {
  RequirePadded(0, n);
  HWY_DYNAMIC_DISPATCH(ReluBackwardImpl)(activation, activation_stride, rows, n, gradient, gradient_stride);
}

void HashForward(const HashLevel& level, int features, const float* table, const float* x, const float* y, const float* z, int64_t n, float* out,
                 size_t out_stride) {
  RequireFeatures(features);
  HWY_DYNAMIC_DISPATCH(HashForwardImpl)(level, features, table, x, y, z, n, out, out_stride);
}

void HashBackward(const HashLevel& level, int features, const float* x, const float* y, const float* z, int64_t n, const float* out_gradient,
                  size_t out_stride, float* table_gradient, uint8_t* touched, uint32_t* list, uint32_t* count) {
  RequireFeatures(features);
  HWY_DYNAMIC_DISPATCH(HashBackwardImpl)(level, features, x, y, z, n, out_gradient, out_stride, table_gradient, touched, list, count);
}

void AdamListed(const AdamStep& step, int features, const uint32_t* list, uint32_t count, float* table, float* table_gradient, float* moment1,
                float* moment2, uint8_t* touched) {
  RequireFeatures(features);
  HWY_DYNAMIC_DISPATCH(AdamListedImpl)(step, features, list, count, table, table_gradient, moment1, moment2, touched);
}

void AdamDense(const AdamStep& step, float l2, int64_t n, float* parameters, float* gradient, float* moment1, float* moment2) {
  HWY_DYNAMIC_DISPATCH(AdamDenseImpl)(step, l2, n, parameters, gradient, moment1, moment2);
}

}  // namespace skyquilt::kernel
#endif  // HWY_ONCE
