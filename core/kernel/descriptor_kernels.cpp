#include "core/base/errors.h"
#include "core/kernel/descriptors.h"
#include "core/kernel/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernel/descriptor_kernels.cpp"
#include <hwy/foreach_target.h>  // re-includes this file once per instruction set
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <string>

HWY_BEFORE_NAMESPACE();
namespace skyquilt::kernel::HWY_NAMESPACE {
namespace {

// Takes the dot product of row i with row j into account. Pairs come in ascending j.
HWY_INLINE void Offer(BestDots& best, size_t i, size_t j, int32_t dot) {
  if (dot <= best.second[i]) return;
  if (dot > best.dot[i]) {
    best.second[i] = best.dot[i];
    best.dot[i] = dot;
    best.index[i] = static_cast<int32_t>(j);
  } else {
    best.second[i] = dot;
  }
}

#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
namespace hn = hwy::HWY_NAMESPACE;

using WordTag = hn::ScalableTag<int32_t>;
using Words = hn::Vec<WordTag>;
constexpr size_t kLanes = hn::MaxLanes(WordTag());

// A register tile: dot products of kTileRows rows of a with kTileVectors vectors of rows of b, one per lane. It fills 32 or 16 registers.
constexpr size_t kTileRows = (HWY_TARGET <= HWY_AVX3) ? 8 : 4;
constexpr size_t kTileVectors = (HWY_TARGET <= HWY_AVX3) ? 3 : 2;
// So many rows of a are in the second-level cache while the tiles of b, which fit into the first level, pass by.
constexpr size_t kBlockRows = 512;

using Line = PackedDescriptors::Line;

// The two ways to multiply. A row is a sequence of kSteps words, each of which meets the word of the same step of the other row.

// Two 16-bit numbers a word: bytes 0 and 2 of four, then 1 and 3. Exact for all bytes, unlike the multiplication of bytes of AVX2, which saturates.
struct PairDot {
  static constexpr size_t kSteps = 2 * PackedDescriptors::kLines;
  static constexpr bool kOffset = false;
  static constexpr uint32_t kEvenBytes = 0x00FF00FFU;

  static HWY_INLINE Words Add(Words column, Words row, Words sum) {
    const WordTag d;
    const hn::Repartition<int16_t, WordTag> d16;
    Words none = hn::Zero(d);  // stays zero on x86
    return hn::ReorderWidenMulAccumulate(d, hn::BitCast(d16, column), hn::BitCast(d16, row), sum, none);
  }
  static void RowWords(uint32_t bytes, int32_t* words) {
    words[0] = static_cast<int32_t>(bytes & kEvenBytes);
    words[1] = static_cast<int32_t>((bytes >> 8) & kEvenBytes);
  }
  // The words of kVectors vectors from descriptor `first` of b on, one vector after another.
  template <size_t kVectors>
  static const int32_t* ColumnWords(const PackedDescriptors& b, size_t first, int32_t* scratch) {
    const WordTag d;
    const hn::RebindToUnsigned<WordTag> du;
    const auto even = hn::Set(du, kEvenBytes);
    for (size_t v = 0; v < kVectors; ++v) {
      const size_t at = first + v * kLanes;
      const Line* lines = b.lines.data() + at / kDescriptorGroup * PackedDescriptors::kLines;
      int32_t* words = scratch + v * kSteps * kLanes;
      for (size_t line = 0; line < PackedDescriptors::kLines; ++line) {
        const auto bytes = hn::Load(du, lines[line].word.data() + at % kDescriptorGroup);
        hn::Store(hn::BitCast(d, hn::And(bytes, even)), d, words + 2 * line * kLanes);
        hn::Store(hn::BitCast(d, hn::And(hn::ShiftRight<8>(bytes), even)), d, words + (2 * line + 1) * kLanes);
      }
    }
    return scratch;
  }
};

#if HWY_TARGET <= HWY_AVX3 && (HWY_COMPILER_GCC || HWY_COMPILER_CLANG)
#define SKYQUILT_VNNI 1
// Four bytes a word, unsigned for b and signed for a: a's bytes have 128 subtracted, which `offset` of b adds again.
struct VnniDot {
  static constexpr size_t kSteps = PackedDescriptors::kLines;
  static constexpr bool kOffset = true;
  static_assert(kLanes == kDescriptorGroup, "lines are read as they are");

  static HWY_INLINE Words Add(Words column, Words row, Words sum) {
    // In assembly, since the instruction set of this file's AVX-512 has no VNNI.
    asm("vpdpbusd %2, %1, %0" : "+v"(sum.raw) : "v"(column.raw), "v"(row.raw));
    return sum;
  }
  static void RowWords(uint32_t bytes, int32_t* words) { words[0] = static_cast<int32_t>(bytes ^ 0x80808080U); }
  template <size_t kVectors>
  static const int32_t* ColumnWords(const PackedDescriptors& b, size_t first, int32_t* /*scratch*/) {
    return reinterpret_cast<const int32_t*>(b.lines.data() + first / kDescriptorGroup * PackedDescriptors::kLines);
  }
};
#else
#define SKYQUILT_VNNI 0
#endif

// Writes the dot products of a tile to `dots`, kTileRows x kVectors vectors, if one of them is above the second best of its row or column so far,
// which becomes rare after the first few tiles. Returns which: bit r for row r, bit kTileRows + v for the columns of vector v.
template <class Dot, size_t kVectors>
HWY_NOINLINE uint32_t Tile(const int32_t* HWY_RESTRICT rows, const int32_t* HWY_RESTRICT columns, const int32_t* HWY_RESTRICT offset,
                           const int32_t* HWY_RESTRICT row_second, const int32_t* HWY_RESTRICT column_second, int32_t* HWY_RESTRICT dots) {
  const WordTag d;
  Words sum[kTileRows][kVectors];
  for (auto& row : sum) {
    for (size_t v = 0; v < kVectors; ++v) row[v] = Dot::kOffset ? hn::LoadU(d, offset + v * kLanes) : hn::Zero(d);
  }
  for (size_t step = 0; step < Dot::kSteps; ++step) {
    Words column[kVectors];
    for (size_t v = 0; v < kVectors; ++v) column[v] = hn::Load(d, columns + (v * Dot::kSteps + step) * kLanes);
    for (size_t r = 0; r < kTileRows; ++r) {
      const Words row = hn::Set(d, rows[r * Dot::kSteps + step]);
      for (size_t v = 0; v < kVectors; ++v) sum[r][v] = Dot::Add(column[v], row, sum[r][v]);
    }
  }
  uint32_t better = 0;
  for (size_t r = 0; r < kTileRows; ++r) {
    Words most = sum[r][0];
    for (size_t v = 1; v < kVectors; ++v) most = hn::Max(most, sum[r][v]);
    better |= static_cast<uint32_t>(!hn::AllFalse(d, hn::Gt(most, hn::Set(d, row_second[r])))) << r;
  }
  for (size_t v = 0; v < kVectors; ++v) {
    Words most = sum[0][v];
    for (size_t r = 1; r < kTileRows; ++r) most = hn::Max(most, sum[r][v]);
    better |= static_cast<uint32_t>(!hn::AllFalse(d, hn::Gt(most, hn::LoadU(d, column_second + v * kLanes)))) << (kTileRows + v);
  }
  if (better == 0) return 0;
  for (size_t r = 0; r < kTileRows; ++r) {
    for (size_t v = 0; v < kVectors; ++v) hn::Store(sum[r][v], d, dots + (r * kVectors + v) * kLanes);
  }
  return better;
}

// Offer for the columns of a vector: rows i, i + 1, ... of a to rows j, j + 1, ... of b.
void OfferRows(BestDots& best, size_t j, size_t i, const int32_t* dots, size_t stride) {
  const WordTag d;
  Words first = hn::LoadU(d, best.dot.data() + j), second = hn::LoadU(d, best.second.data() + j), index = hn::LoadU(d, best.index.data() + j);
  for (size_t r = 0; r < kTileRows; ++r) {
    const Words dot = hn::Load(d, dots + r * stride);
    index = hn::IfThenElse(hn::Gt(dot, first), hn::Set(d, static_cast<int32_t>(i + r)), index);
    second = hn::Max(second, hn::Min(first, dot));
    first = hn::Max(first, dot);
  }
  hn::StoreU(first, d, best.dot.data() + j);
  hn::StoreU(second, d, best.second.data() + j);
  hn::StoreU(index, d, best.index.data() + j);
}

// All pairs of the n_rows rows of a from `first` on, prepared as `rows`, with kVectors vectors of rows of b from j on.
template <class Dot, size_t kVectors>
void Columns(const int32_t* rows, size_t first, size_t n_rows, const PackedDescriptors& b, size_t j, int32_t* scratch, BestDotsBothWays& best) {
  constexpr size_t kStride = kVectors * kLanes;
  const int32_t* columns = Dot::template ColumnWords<kVectors>(b, j, scratch);
  HWY_ALIGN int32_t dots[kTileRows * kStride];
  for (size_t row = 0; row < n_rows; row += kTileRows) {
    const size_t i = first + row;
    const uint32_t better =
        Tile<Dot, kVectors>(rows + row * Dot::kSteps, columns, b.offset.data() + j, best.of_a.second.data() + i, best.of_b.second.data() + j, dots);
    if (better == 0) continue;
    for (size_t r = 0; r < kTileRows; ++r) {
      if ((better >> r & 1U) == 0) continue;
      for (size_t c = 0; c < kStride; ++c) Offer(best.of_a, i + r, j + c, dots[r * kStride + c]);
    }
    for (size_t v = 0; v < kVectors; ++v) {
      if ((better >> (kTileRows + v) & 1U) != 0) OfferRows(best.of_b, j + v * kLanes, i, dots + v * kLanes, kStride);
    }
  }
}

template <class Dot>
void AllPairs(const PackedDescriptors& a, const PackedDescriptors& b, BestDotsBothWays& best) {
  const size_t n_a = a.offset.size(), n_b = b.offset.size();
  constexpr size_t kWords = Dot::kSteps;
  const auto lines = [](size_t words) { return std::vector<Line>((words + kDescriptorGroup - 1) / kDescriptorGroup); };
  std::vector<Line> row_lines = lines(std::min(n_a, kBlockRows) * kWords), scratch_lines = lines(kTileVectors * kLanes * kWords);
  auto* rows = reinterpret_cast<int32_t*>(row_lines.data());
  auto* scratch = reinterpret_cast<int32_t*>(scratch_lines.data());
  for (size_t first = 0; first < n_a; first += kBlockRows) {
    const size_t n_rows = std::min(n_a - first, kBlockRows);
    for (size_t row = 0; row < n_rows; ++row) {
      const size_t i = first + row;
      const Line* from = a.lines.data() + i / kDescriptorGroup * PackedDescriptors::kLines;
      for (size_t line = 0; line < PackedDescriptors::kLines; ++line) {
        Dot::RowWords(from[line].word[i % kDescriptorGroup], rows + row * kWords + line * (kWords / PackedDescriptors::kLines));
      }
    }
    size_t j = 0;
    for (; j + kTileVectors * kLanes <= n_b; j += kTileVectors * kLanes) Columns<Dot, kTileVectors>(rows, first, n_rows, b, j, scratch, best);
    if (kTileVectors > 2 && j + 2 * kLanes <= n_b) {
      Columns<Dot, 2>(rows, first, n_rows, b, j, scratch, best);
      j += 2 * kLanes;
    }
    for (; j < n_b; j += kLanes) Columns<Dot, 1>(rows, first, n_rows, b, j, scratch, best);
  }
}

void AllPairsImpl(const PackedDescriptors& a, const PackedDescriptors& b, bool vnni, BestDotsBothWays* best) {
#if SKYQUILT_VNNI
  if (vnni) {
    AllPairs<VnniDot>(a, b, *best);
    return;
  }
#endif
  static_cast<void>(vnni);
  AllPairs<PairDot>(a, b, *best);
}
#undef SKYQUILT_VNNI

#else  // not x86

// The descriptors of a group as rows of 16-bit numbers: compilers find the products of pairs of them in the loop below.
void Unpack(const PackedDescriptors& from, size_t group, int16_t* rows) {
  for (size_t line = 0; line < PackedDescriptors::kLines; ++line) {
    for (size_t row = 0; row < kDescriptorGroup; ++row) {
      const uint32_t bytes = from.lines[group * PackedDescriptors::kLines + line].word[row];
      for (size_t k = 0; k < 4; ++k) rows[row * kDescriptorBytes + line * 4 + k] = static_cast<int16_t>(bytes >> (8 * k) & 0xFFU);
    }
  }
}

int32_t Dot(const int16_t* x, const int16_t* y) {
  int32_t sum = 0;
  for (size_t k = 0; k < kDescriptorBytes; ++k) sum += static_cast<int32_t>(x[k]) * static_cast<int32_t>(y[k]);
  return sum;
}

void AllPairsImpl(const PackedDescriptors& a, const PackedDescriptors& b, bool /*vnni*/, BestDotsBothWays* best) {
  constexpr size_t kGroupBytes = kDescriptorGroup * kDescriptorBytes;
  std::vector<int16_t> rows(kGroupBytes), columns(b.groups() * kGroupBytes);
  for (size_t group = 0; group < b.groups(); ++group) Unpack(b, group, columns.data() + group * kGroupBytes);
  for (size_t group = 0; group < a.groups(); ++group) {
    Unpack(a, group, rows.data());
    for (size_t j = 0; j < b.size(); ++j) {
      for (size_t row = 0; row < kDescriptorGroup; ++row) {
        const int32_t dot = Dot(rows.data() + row * kDescriptorBytes, columns.data() + j * kDescriptorBytes);
        Offer(best->of_a, group * kDescriptorGroup + row, j, dot);
        Offer(best->of_b, j, group * kDescriptorGroup + row, dot);
      }
    }
  }
}
#endif

}  // namespace
}  // namespace skyquilt::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace skyquilt::kernel {

HWY_EXPORT(AllPairsImpl);

namespace {

bool vnni_allowed = true;

bool ProcessorHasVnni() {
#if HWY_ARCH_X86_64 && (HWY_COMPILER_GCC || HWY_COMPILER_CLANG)
  return __builtin_cpu_supports("avx512vnni") != 0;
#else
  return false;
#endif
}

// Room for whole groups: the descriptors that fill up the last one have dot product 0 with all others, so nothing is ever found for or in them.
void Resize(BestDots* best, size_t n) {
  best->dot.resize(n, 0);
  best->second.resize(n, 0);
  best->index.resize(n, -1);
}

}  // namespace

PackedDescriptors PackDescriptors(std::span<const uint8_t> rows) {
  SKYQUILT_CHECK(rows.size() % kDescriptorBytes == 0, std::to_string(rows.size()) + " bytes");
  PackedDescriptors packed;
  packed.count = rows.size() / kDescriptorBytes;
  const size_t groups = (packed.count + kDescriptorGroup - 1) / kDescriptorGroup;
  packed.lines.resize(groups * PackedDescriptors::kLines);
  packed.offset.resize(groups * kDescriptorGroup);
  for (size_t i = 0; i < packed.count; ++i) {
    PackedDescriptors::Line* lines = packed.lines.data() + i / kDescriptorGroup * PackedDescriptors::kLines;
    int32_t sum = 0;
    for (size_t k = 0; k < kDescriptorBytes; ++k) {
      const uint32_t byte = rows[i * kDescriptorBytes + k];
      lines[k / 4].word[i % kDescriptorGroup] |= byte << (8 * (k % 4));
      sum += static_cast<int32_t>(byte);
    }
    packed.offset[i] = 128 * sum;
  }
  return packed;
}

BestDotsBothWays FindBestDots(const PackedDescriptors& a, const PackedDescriptors& b) {
  BestDotsBothWays best;
  Resize(&best.of_a, a.offset.size());
  Resize(&best.of_b, b.offset.size());
  HWY_DYNAMIC_DISPATCH(AllPairsImpl)(a, b, UsesVnni(), &best);
  Resize(&best.of_a, a.size());
  Resize(&best.of_b, b.size());
  return best;
}

bool UsesVnni() {
  static const bool has = ProcessorHasVnni();
  return has && vnni_allowed && ActiveInstructionSet().starts_with("avx3");
}

void AllowVnni(bool allowed) {
  vnni_allowed = allowed;
}

}  // namespace skyquilt::kernel
#endif  // HWY_ONCE
