// Shared by the kernels that read and write hash tables: the cell of a position, the weight of a footprint, and features from one entry per sample to
// one row per feature and back. Included once per instruction set, as Highway's own -inl.h files are.
#if defined(SKYQUILT_CORE_KERNEL_HASH_LATTICE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SKYQUILT_CORE_KERNEL_HASH_LATTICE_INL_H_
#undef SKYQUILT_CORE_KERNEL_HASH_LATTICE_INL_H_
#else
#define SKYQUILT_CORE_KERNEL_HASH_LATTICE_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#include "core/kernel/footprint_table.h"

HWY_BEFORE_NAMESPACE();
namespace skyquilt::kernel::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::ScalableTag<float>;
using FloatVector = hn::Vec<FloatTag>;

constexpr int kHashBlock = 256;

// Lower lattice coordinate and fraction along one axis. NaN fails the comparison and becomes 0.
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

// Footprint weight per sample by linear interpolation in the table. Infinity and NaN count as points.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V WeightOf(D d, const float* table, V sharpness, float cell) {
  const hn::Rebind<int32_t, D> di;
  const V top = hn::Set(d, static_cast<float>(kFootprintSteps));
  V at = hn::Mul(sharpness, hn::Set(d, cell * static_cast<float>(kFootprintStepsPerUnit)));
  at = hn::IfThenElse(hn::Lt(at, top), at, top);
  at = hn::Max(at, hn::Zero(d));
  const auto index = hn::Min(hn::ConvertTo(di, at), hn::Set(di, kFootprintSteps - 1));
  const V low = hn::GatherIndex(d, table, index);
  const V high = hn::GatherIndex(d, table + 1, index);
  return hn::MulAdd(hn::Sub(at, hn::ConvertTo(d, index)), hn::Sub(high, low), low);
}

// A vector of one table entry; of one lane on the scalar path.
template <int kFeatures>
using EntryTag = hn::CappedTag<float, kFeatures>;
template <int kFeatures>
constexpr int kEntryLanes = static_cast<int>(hn::MaxLanes(EntryTag<kFeatures>()));

// Converts features from one entry per sample (packed) to one row per feature. The lookup stores whole entries and this writes whole vectors: storing
// single floats and loading them as a wider vector would stall the processor for every sample.
template <int kFeatures>
void UnpackRows(const float* packed, int n, float* out, size_t out_stride) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  int s = 0;
  for (; s + lanes <= n; s += lanes) {
    FloatVector row[4];
    if constexpr (kFeatures == 2) {
      hn::LoadInterleaved2(d, packed + s * 2, row[0], row[1]);
    } else {
      hn::LoadInterleaved4(d, packed + s * 4, row[0], row[1], row[2], row[3]);
    }
    for (int f = 0; f < kFeatures; ++f) hn::StoreU(row[f], d, out + static_cast<size_t>(f) * out_stride + s);
  }
  for (; s < n; ++s) {
    for (int f = 0; f < kFeatures; ++f) out[static_cast<size_t>(f) * out_stride + static_cast<size_t>(s)] = packed[s * kFeatures + f];
  }
}

// The inverse of UnpackRows. size[s] is the sum of the features' absolute values: 0 exactly where all are 0.
template <int kFeatures>
void PackRows(const float* in, size_t in_stride, int n, float* packed, float* size) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  int s = 0;
  for (; s + lanes <= n; s += lanes) {
    FloatVector row[4];
    FloatVector sum = hn::Zero(d);
    for (int f = 0; f < kFeatures; ++f) {
      row[f] = hn::LoadU(d, in + static_cast<size_t>(f) * in_stride + s);
      sum = hn::Add(sum, hn::Abs(row[f]));
    }
    if constexpr (kFeatures == 2) {
      hn::StoreInterleaved2(row[0], row[1], d, packed + s * 2);
    } else {
      hn::StoreInterleaved4(row[0], row[1], row[2], row[3], d, packed + s * 4);
    }
    hn::StoreU(sum, d, size + s);
  }
  for (; s < n; ++s) {
    size[s] = 0.0F;
    for (int f = 0; f < kFeatures; ++f) {
      packed[s * kFeatures + f] = in[static_cast<size_t>(f) * in_stride + static_cast<size_t>(s)];
      size[s] += packed[s * kFeatures + f] < 0.0F ? -packed[s * kFeatures + f] : packed[s * kFeatures + f];
    }
  }
}

}  // namespace
}  // namespace skyquilt::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
