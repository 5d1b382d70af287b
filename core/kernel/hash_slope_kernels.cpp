#include <algorithm>
#include <iterator>

#include "core/kernel/footprint_table.h"
#include "core/kernel/hash_shapes.h"
#include "core/kernel/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernel/hash_slope_kernels.cpp"
#include <hwy/foreach_target.h>  // re-includes this file once per instruction set
// clang-format off
#include <hwy/highway.h>
#include "core/kernel/hash_lattice-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace skyquilt::kernel::HWY_NAMESPACE {
namespace {

// The cells of up to kHashBlock positions: entries of the eight corners as in FindCorners, along each axis the weight of the lower and of the upper
// corners, and how fast the upper weight grows with the position, times the sample's footprint weight and this position's share of the sample.
struct Cells {
  HWY_ALIGN uint32_t index[8 * kHashBlock];
  HWY_ALIGN float weight[3][2][kHashBlock];
  HWY_ALIGN float slope[3][kHashBlock];
};

// n floats, then zeros to the end of the block, so that loops over whole vectors need no tail.
void CopyPadded(const float* from, int n, float* to) {
  std::copy_n(from, n, to);
  std::fill(to + n, to + kHashBlock, 0.0F);
}

// Of position j of the samples begin .. begin + n.
void FindCells(const GridLevel& level, const Positions& at, int j, int64_t begin, int n, Cells& cells) {
  const FloatTag d;
  const hn::Rebind<int32_t, FloatTag> di;
  const hn::Rebind<uint32_t, FloatTag> du;
  using IndexVector = hn::Vec<decltype(du)>;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto mask = hn::Set(du, level.entries - 1U);
  const int64_t first = static_cast<int64_t>(static_cast<size_t>(j) * at.plane) + begin;
  HWY_ALIGN float position[3][kHashBlock];
  HWY_ALIGN float sharpness[kHashBlock];
  CopyPadded(at.x + first, n, position[0]);
  CopyPadded(at.y + first, n, position[1]);
  CopyPadded(at.z + first, n, position[2]);
  if (at.sharpness != nullptr) CopyPadded(at.sharpness + begin, n, sharpness);
  const float share = 1.0F / static_cast<float>(at.points);
  const float cell_edge = 1.0F / level.cells_per_unit;
  const FloatVector one = hn::Set(d, 1.0F);
  for (int s = 0; s < n; s += lanes) {
    FloatVector scale = hn::Set(d, share * level.cells_per_unit);
    if (at.sharpness != nullptr) scale = hn::Mul(scale, WeightOf(d, FootprintTable(), hn::Load(d, sharpness + s), cell_edge));
    IndexVector corner[3];
    for (int axis = 0; axis < 3; ++axis) {
      const FloatVector p = hn::Load(d, position[axis] + s);
      auto cell = hn::Zero(di);
      FloatVector fraction;
      SplitAxis(d, p, level.cells_per_unit, level.size[axis], cell, fraction);
      corner[axis] = hn::BitCast(du, cell);
      hn::Store(hn::Sub(one, fraction), d, cells.weight[axis][0] + s);
      hn::Store(fraction, d, cells.weight[axis][1] + s);
      // Positions outside are clamped and do not move; NaN fails the comparisons.
      const FloatVector scaled = hn::Mul(p, hn::Set(d, level.cells_per_unit));
      const auto inside = hn::And(hn::Ge(scaled, hn::Zero(d)), hn::Le(scaled, hn::Set(d, static_cast<float>(level.size[axis] - 1))));
      hn::Store(hn::IfThenElseZero(inside, scale), d, cells.slope[axis] + s);
    }
    const auto stride_y = hn::Set(du, level.dense ? static_cast<uint32_t>(level.size[0]) : 2654435761U);
    const auto stride_z = hn::Set(du, level.dense ? static_cast<uint32_t>(level.size[0] * level.size[1]) : 805459861U);
    const auto low_y = hn::Mul(corner[1], stride_y), low_z = hn::Mul(corner[2], stride_z);
    const IndexVector x[2] = {corner[0], hn::Add(corner[0], hn::Set(du, 1U))};
    const IndexVector y[2] = {low_y, hn::Add(low_y, stride_y)};
    const IndexVector z[2] = {low_z, hn::Add(low_z, stride_z)};
    for (int c = 0; c < 8; ++c) {
      const int bx = c & 1, by = (c >> 1) & 1, bz = c >> 2;
      const auto index = level.dense ? hn::Add(hn::Add(x[bx], y[by]), z[bz]) : hn::And(hn::Xor(hn::Xor(x[bx], y[by]), z[bz]), mask);
      hn::Store(index, du, cells.index + c * kHashBlock + s);
    }
  }
}

// The vector of `bit`'s weights along an axis, from sample s on.
HWY_INLINE FloatVector WeightAt(const Cells& cells, int axis, int bit, int s) {
  return hn::Load(FloatTag(), cells.weight[axis][bit] + s);
}

// How fast the weight of each corner grows when the samples move by `along`: [c * kHashBlock + s]. moved[s]: 0 exactly where all eight are.
void FindGrowth(const Cells& cells, const float* along, size_t along_stride, int n, float* growth, float* moved) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  HWY_ALIGN float step[3][kHashBlock];
  for (size_t axis = 0; axis < 3; ++axis) CopyPadded(along + axis * along_stride, n, step[axis]);
  for (int s = 0; s < n; s += lanes) {
    FloatVector speed[3];
    FloatVector sum = hn::Zero(d);
    for (int axis = 0; axis < 3; ++axis) {
      speed[axis] = hn::Mul(hn::Load(d, cells.slope[axis] + s), hn::Load(d, step[axis] + s));
      sum = hn::Add(sum, hn::Abs(speed[axis]));
    }
    hn::Store(sum, d, moved + s);
    for (int c = 0; c < 8; ++c) {
      const int bit[3] = {c & 1, (c >> 1) & 1, c >> 2};
      FloatVector total = hn::Zero(d);
      for (int axis = 0; axis < 3; ++axis) {
        const int second = (axis + 1) % 3, third = (axis + 2) % 3;
        const FloatVector others = hn::Mul(WeightAt(cells, second, bit[second], s), WeightAt(cells, third, bit[third], s));
        total = bit[axis] != 0 ? hn::MulAdd(speed[axis], others, total) : hn::NegMulAdd(speed[axis], others, total);
      }
      hn::Store(total, d, growth + c * kHashBlock + s);
    }
  }
}

template <int kFeatures>
void HashTangentFeatures(const GridLevel& level, const float* table, const Positions& at, int64_t n, const float* along, size_t along_stride,
                         float* out, size_t out_stride) {
  const EntryTag<kFeatures> d;
  constexpr int kLanes = kEntryLanes<kFeatures>;
  Cells cells;
  HWY_ALIGN float growth[8 * kHashBlock];
  HWY_ALIGN float moved[kHashBlock];
  HWY_ALIGN float packed[kHashBlock * kFeatures];
  for (int64_t begin = 0; begin < n; begin += kHashBlock) {
    const int count = static_cast<int>(std::min<int64_t>(kHashBlock, n - begin));
    for (int j = 0; j < at.points; ++j) {
      FindCells(level, at, j, begin, count, cells);
      FindGrowth(cells, along + begin, along_stride, count, growth, moved);
      for (int s = 0; s < count; ++s) {
        for (int f = 0; f < kFeatures; f += kLanes) {
          float* const to = packed + s * kFeatures + f;
          auto sum = j == 0 ? hn::Zero(d) : hn::LoadU(d, to);
          for (int c = 0; c < 8; ++c) {
            const float* entry = table + static_cast<size_t>(cells.index[c * kHashBlock + s]) * kFeatures + f;
            sum = hn::MulAdd(hn::Set(d, growth[c * kHashBlock + s]), hn::LoadU(d, entry), sum);
          }
          hn::StoreU(sum, d, to);
        }
      }
    }
    UnpackRows<kFeatures>(packed, count, out + begin, out_stride);
  }
}

template <int kFeatures>
void HashTangentBackwardFeatures(const GridLevel& level, const Positions& at, int64_t n, const float* along, size_t along_stride,
                                 const float* out_gradient, size_t out_stride, float* table_gradient, uint8_t* touched) {
  const EntryTag<kFeatures> d;
  constexpr int kLanes = kEntryLanes<kFeatures>;
  Cells cells;
  HWY_ALIGN float growth[8 * kHashBlock];
  HWY_ALIGN float moved[kHashBlock];
  HWY_ALIGN float packed[kHashBlock * kFeatures];
  HWY_ALIGN float size[kHashBlock];
  for (int64_t begin = 0; begin < n; begin += kHashBlock) {
    const int count = static_cast<int>(std::min<int64_t>(kHashBlock, n - begin));
    PackRows<kFeatures>(out_gradient + begin, out_stride, count, packed, size);
    for (int j = 0; j < at.points; ++j) {
      FindCells(level, at, j, begin, count, cells);
      FindGrowth(cells, along + begin, along_stride, count, growth, moved);
      for (int s = 0; s < count; ++s) {
        if (size[s] == 0.0F || moved[s] == 0.0F) continue;
        for (int c = 0; c < 8; ++c) {
          const uint32_t index = cells.index[c * kHashBlock + s];
          const auto weight = hn::Set(d, growth[c * kHashBlock + s]);
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

// Adds the slopes of a block along each axis. dot: of each corner's entry and the sample's gradient, [c * kHashBlock + s].
void AddSlopes(const Cells& cells, const float* dot, int n, float* position_gradient, size_t position_stride) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  HWY_ALIGN float part[hn::MaxLanes(FloatTag())];
  for (int s = 0; s < n; s += lanes) {
    for (int axis = 0; axis < 3; ++axis) {
      const int second = (axis + 1) % 3, third = (axis + 2) % 3;
      FloatVector sum = hn::Zero(d);
      for (int b = 0; b < 4; ++b) {
        const int low = (b & 1) << second | b >> 1 << third;
        const FloatVector others = hn::Mul(WeightAt(cells, second, b & 1, s), WeightAt(cells, third, b >> 1, s));
        const FloatVector rise = hn::Sub(hn::Load(d, dot + (low | 1 << axis) * kHashBlock + s), hn::Load(d, dot + low * kHashBlock + s));
        sum = hn::MulAdd(others, rise, sum);
      }
      hn::Store(hn::Mul(sum, hn::Load(d, cells.slope[axis] + s)), d, part);
      float* const to = position_gradient + static_cast<size_t>(axis) * position_stride + s;
      for (int k = 0; k < std::min(lanes, n - s); ++k) to[k] += part[k];
    }
  }
}

template <int kFeatures>
void HashSlopeFeatures(const GridLevel& level, const float* table, const Positions& at, int64_t n, const float* out_gradient, size_t out_stride,
                       float* position_gradient, size_t position_stride) {
  const EntryTag<kFeatures> d;
  constexpr int kLanes = kEntryLanes<kFeatures>;
  Cells cells;
  HWY_ALIGN float dot[8 * kHashBlock];
  HWY_ALIGN float packed[kHashBlock * kFeatures];
  HWY_ALIGN float size[kHashBlock];
  std::fill(std::begin(dot), std::end(dot), 0.0F);
  for (int64_t begin = 0; begin < n; begin += kHashBlock) {
    const int count = static_cast<int>(std::min<int64_t>(kHashBlock, n - begin));
    PackRows<kFeatures>(out_gradient + begin, out_stride, count, packed, size);
    for (int j = 0; j < at.points; ++j) {
      FindCells(level, at, j, begin, count, cells);
      for (int s = 0; s < count; ++s) {
        for (int c = 0; c < 8; ++c) {
          const float* entry = table + static_cast<size_t>(cells.index[c * kHashBlock + s]) * kFeatures;
          auto sum = hn::Zero(d);
          for (int f = 0; f < kFeatures; f += kLanes) {
            sum = hn::MulAdd(hn::LoadU(d, entry + f), hn::LoadU(d, packed + s * kFeatures + f), sum);
          }
          dot[c * kHashBlock + s] = hn::GetLane(hn::SumOfLanes(d, sum));
        }
      }
      AddSlopes(cells, dot, count, position_gradient + begin, position_stride);
    }
  }
}

void HashSlopeImpl(const GridLevel& level, int features, const float* table, const Positions& at, int64_t n, const float* out_gradient,
                   size_t out_stride, float* position_gradient, size_t position_stride) {
  if (features == 4) {
    HashSlopeFeatures<4>(level, table, at, n, out_gradient, out_stride, position_gradient, position_stride);
  } else {
    HashSlopeFeatures<2>(level, table, at, n, out_gradient, out_stride, position_gradient, position_stride);
  }
}

void HashTangentImpl(const GridLevel& level, int features, const float* table, const Positions& at, int64_t n, const float* along,
                     size_t along_stride, float* out, size_t out_stride) {
  if (features == 4) {
    HashTangentFeatures<4>(level, table, at, n, along, along_stride, out, out_stride);
  } else {
    HashTangentFeatures<2>(level, table, at, n, along, along_stride, out, out_stride);
  }
}

void HashTangentBackwardImpl(const GridLevel& level, int features, const Positions& at, int64_t n, const float* along, size_t along_stride,
                             const float* out_gradient, size_t out_stride, float* table_gradient, uint8_t* touched) {
  if (features == 4) {
    HashTangentBackwardFeatures<4>(level, at, n, along, along_stride, out_gradient, out_stride, table_gradient, touched);
  } else {
    HashTangentBackwardFeatures<2>(level, at, n, along, along_stride, out_gradient, out_stride, table_gradient, touched);
  }
}

}  // namespace
}  // namespace skyquilt::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace skyquilt::kernel {

HWY_EXPORT(HashSlopeImpl);
HWY_EXPORT(HashTangentImpl);
HWY_EXPORT(HashTangentBackwardImpl);

void HashSlope(const GridLevel& level, int features, const float* table, const Positions& at, int64_t n, const float* out_gradient, size_t out_stride,
               float* position_gradient, size_t position_stride) {
  CheckHashShapes(level, features, at, n, std::min(out_stride, position_stride));
  HWY_DYNAMIC_DISPATCH(HashSlopeImpl)(level, features, table, at, n, out_gradient, out_stride, position_gradient, position_stride);
}

void HashTangent(const GridLevel& level, int features, const float* table, const Positions& at, int64_t n, const float* along, size_t along_stride,
                 float* out, size_t out_stride) {
  CheckHashShapes(level, features, at, n, std::min(out_stride, along_stride));
  HWY_DYNAMIC_DISPATCH(HashTangentImpl)(level, features, table, at, n, along, along_stride, out, out_stride);
}

void HashTangentBackward(const GridLevel& level, int features, const Positions& at, int64_t n, const float* along, size_t along_stride,
                         const float* out_gradient, size_t out_stride, float* table_gradient, uint8_t* touched) {
  CheckHashShapes(level, features, at, n, std::min(out_stride, along_stride));
  HWY_DYNAMIC_DISPATCH(HashTangentBackwardImpl)
  (level, features, at, n, along, along_stride, out_gradient, out_stride, table_gradient, touched);
}

}  // namespace skyquilt::kernel
#endif  // HWY_ONCE
