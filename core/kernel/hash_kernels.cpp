#include <algorithm>

#include "core/kernel/footprint_table.h"
#include "core/kernel/hash_shapes.h"
#include "core/kernel/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernel/hash_kernels.cpp"
#include <hwy/foreach_target.h>  // re-includes this file once per instruction set
// clang-format off
#include <hwy/highway.h>
#include "core/kernel/hash_lattice-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace skyquilt::kernel::HWY_NAMESPACE {
namespace {

// Entries and weights of the eight corners for up to kHashBlock positions; corner c of position s at [c * kHashBlock + s].
struct Corners {
  HWY_ALIGN uint32_t index[8 * kHashBlock];
  HWY_ALIGN float weight[8 * kHashBlock];
};

void FootprintHiddenImpl(const float* sharpness, int64_t n, float cells_per_unit, float* out) {
  const FloatTag d;
  const auto lanes = static_cast<int64_t>(hn::Lanes(d));
  const float* const table = FootprintTable();
  const float cell = 1.0F / cells_per_unit;
  const FloatVector one = hn::Set(d, 1.0F);
  HWY_ALIGN float tail[hn::MaxLanes(FloatTag())];
  for (int64_t s = 0; s < n; s += lanes) {
    if (s + lanes <= n) {
      hn::StoreU(hn::Sub(one, WeightOf(d, table, hn::LoadU(d, sharpness + s), cell)), d, out + s);
      continue;
    }
    std::fill(std::begin(tail), std::end(tail), 0.0F);
    std::copy(sharpness + s, sharpness + n, tail);
    hn::Store(hn::Sub(one, WeightOf(d, table, hn::Load(d, tail), cell)), d, tail);
    std::copy_n(tail, n - s, out + s);
  }
}

// sharpness: null for points. share: weight of these positions in their samples.
void FindCorners(const GridLevel& level, const float* x, const float* y, const float* z, const float* sharpness, float share, int n,
                 Corners& corners) {
  const FloatTag d;
  const hn::Rebind<int32_t, FloatTag> di;
  const hn::Rebind<uint32_t, FloatTag> du;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto mask = hn::Set(du, level.entries - 1U);
  HWY_ALIGN float tail[4][hn::MaxLanes(FloatTag())];
  const float* const table = FootprintTable();
  const float cell = 1.0F / level.cells_per_unit;
  for (int s = 0; s < n; s += lanes) {
    const float* px = x + s;
    const float* py = y + s;
    const float* pz = z + s;
    const float* ps = sharpness != nullptr ? sharpness + s : nullptr;
    if (s + lanes > n) {
      for (int k = 0; k < lanes; ++k) {
        const int from = std::min(k, n - s - 1);
        tail[0][k] = px[from];
        tail[1][k] = py[from];
        tail[2][k] = pz[from];
        if (ps != nullptr) tail[3][k] = ps[from];
      }
      px = tail[0];
      py = tail[1];
      pz = tail[2];
      if (ps != nullptr) ps = tail[3];
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
    FloatVector wz[2] = {hn::Sub(one, fz), fz};
    if (ps != nullptr || share != 1.0F) {
      FloatVector weight = hn::Set(d, share);
      if (ps != nullptr) weight = hn::Mul(weight, WeightOf(d, table, hn::LoadU(d, ps), cell));
      for (FloatVector& w : wz) w = hn::Mul(w, weight);
    }
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

// Of position j of the samples begin .. begin + n.
void FindCornersOf(const GridLevel& level, const Positions& at, int j, int64_t begin, int n, Corners& corners) {
  const int64_t first = static_cast<int64_t>(static_cast<size_t>(j) * at.plane) + begin;
  FindCorners(level, at.x + first, at.y + first, at.z + first, at.sharpness != nullptr ? at.sharpness + begin : nullptr,
              1.0F / static_cast<float>(at.points), n, corners);
}

template <int kFeatures>
void HashForwardFeatures(const GridLevel& level, const float* table, const Positions& at, int64_t n, float* out, size_t out_stride) {
  const EntryTag<kFeatures> d;
  constexpr int kLanes = kEntryLanes<kFeatures>;
  Corners corners;
  HWY_ALIGN float packed[kHashBlock * kFeatures];
  for (int64_t begin = 0; begin < n; begin += kHashBlock) {
    const int count = static_cast<int>(std::min<int64_t>(kHashBlock, n - begin));
    for (int j = 0; j < at.points; ++j) {
      FindCornersOf(level, at, j, begin, count, corners);
      for (int s = 0; s < count; ++s) {
        for (int f = 0; f < kFeatures; f += kLanes) {
          float* const to = packed + s * kFeatures + f;
          auto even = j == 0 ? hn::Zero(d) : hn::LoadU(d, to);
          auto odd = hn::Zero(d);
          for (int c = 0; c < 8; c += 2) {
            const float* entry0 = table + static_cast<size_t>(corners.index[c * kHashBlock + s]) * kFeatures + f;
            const float* entry1 = table + static_cast<size_t>(corners.index[(c + 1) * kHashBlock + s]) * kFeatures + f;
            even = hn::MulAdd(hn::Set(d, corners.weight[c * kHashBlock + s]), hn::LoadU(d, entry0), even);
            odd = hn::MulAdd(hn::Set(d, corners.weight[(c + 1) * kHashBlock + s]), hn::LoadU(d, entry1), odd);
          }
          hn::StoreU(hn::Add(even, odd), d, to);
        }
      }
    }
    UnpackRows<kFeatures>(packed, count, out + begin, out_stride);
  }
}

template <int kFeatures>
void HashBackwardFeatures(const GridLevel& level, const Positions& at, int64_t n, const float* out_gradient, size_t out_stride, float* table_gradient,
                          uint8_t* touched) {
  const EntryTag<kFeatures> d;
  constexpr int kLanes = kEntryLanes<kFeatures>;
  Corners corners;
  HWY_ALIGN float packed[kHashBlock * kFeatures];
  HWY_ALIGN float size[kHashBlock];
  for (int64_t begin = 0; begin < n; begin += kHashBlock) {
    const int samples = static_cast<int>(std::min<int64_t>(kHashBlock, n - begin));
    PackRows<kFeatures>(out_gradient + begin, out_stride, samples, packed, size);
    for (int j = 0; j < at.points; ++j) {
      FindCornersOf(level, at, j, begin, samples, corners);
      for (int s = 0; s < samples; ++s) {
        if (size[s] == 0.0F) continue;
        for (int c = 0; c < 8; ++c) {
          const uint32_t index = corners.index[c * kHashBlock + s];
          const auto weight = hn::Set(d, corners.weight[c * kHashBlock + s]);
          for (int f = 0; f < kFeatures; f += kLanes) {
            float* entry = table_gradient + static_cast<size_t>(index) * kFeatures + f;
            hn::StoreU(hn::MulAdd(weight, hn::LoadU(d, packed + s * kFeatures + f), hn::LoadU(d, entry)), d, entry);
          }
          touched[index / (kLineFloats / kFeatures)] = 1;
        }
      }
    }
  }
}

void HashForwardImpl(const GridLevel& level, int features, const float* table, const Positions& at, int64_t n, float* out, size_t out_stride) {
  if (features == 4) {
    HashForwardFeatures<4>(level, table, at, n, out, out_stride);
  } else {
    HashForwardFeatures<2>(level, table, at, n, out, out_stride);
  }
}

void HashBackwardImpl(const GridLevel& level, int features, const Positions& at, int64_t n, const float* out_gradient, size_t out_stride,
                      float* table_gradient, uint8_t* touched) {
  if (features == 4) {
    HashBackwardFeatures<4>(level, at, n, out_gradient, out_stride, table_gradient, touched);
  } else {
    HashBackwardFeatures<2>(level, at, n, out_gradient, out_stride, table_gradient, touched);
  }
}

}  // namespace
}  // namespace skyquilt::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace skyquilt::kernel {

HWY_EXPORT(HashForwardImpl);
HWY_EXPORT(HashBackwardImpl);
HWY_EXPORT(FootprintHiddenImpl);

uint32_t HashIndex(const GridLevel& level, uint32_t x, uint32_t y, uint32_t z) {
  if (level.dense) return x + y * static_cast<uint32_t>(level.size[0]) + z * static_cast<uint32_t>(level.size[0] * level.size[1]);
  return (x ^ (y * 2654435761U) ^ (z * 805459861U)) & (level.entries - 1U);
}

float FootprintWeight(float sharpness, float cells_per_unit) {
  const float at = sharpness * (1.0F / cells_per_unit * static_cast<float>(kFootprintStepsPerUnit));
  if (!(at < static_cast<float>(kFootprintSteps))) return 1.0F;
  const float* const table = FootprintTable();
  const int index = static_cast<int>(std::max(at, 0.0F));
  return table[index] + (std::max(at, 0.0F) - static_cast<float>(index)) * (table[index + 1] - table[index]);
}

void FootprintHidden(const float* sharpness, int64_t n, float cells_per_unit, float* out) {
  HWY_DYNAMIC_DISPATCH(FootprintHiddenImpl)(sharpness, n, cells_per_unit, out);
}

void HashForward(const GridLevel& level, int features, const float* table, const Positions& at, int64_t n, float* out, size_t out_stride) {
  CheckHashShapes(level, features, at, n, out_stride);
  HWY_DYNAMIC_DISPATCH(HashForwardImpl)(level, features, table, at, n, out, out_stride);
}

void HashBackward(const GridLevel& level, int features, const Positions& at, int64_t n, const float* out_gradient, size_t out_stride,
                  float* table_gradient, uint8_t* touched) {
  CheckHashShapes(level, features, at, n, out_stride);
  HWY_DYNAMIC_DISPATCH(HashBackwardImpl)(level, features, at, n, out_gradient, out_stride, table_gradient, touched);
}

}  // namespace skyquilt::kernel
#endif  // HWY_ONCE
