// For every feature of one photo the two most similar features of another: exact dot products of all pairs of descriptors, on the active instruction
// set (core/kernel/kernels.h). A descriptor is a row of kDescriptorBytes unsigned bytes (SIFT, Lowe 2004; the more similar, the larger the product).
// Every byte value is exact: a product is at most 128 * 255 * 255, and all instruction sets give the same bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace skyquilt::kernel {

constexpr size_t kDescriptorBytes = 128;
// Descriptors are packed in groups of this many; the last group is filled up with zeros.
constexpr size_t kDescriptorGroup = 16;

// The descriptors of one photo in the order in which the kernel reads them; made once for all pairs that the photo is in. Read-only once made, so
// threads may share it.
struct PackedDescriptors {
  // The same four bytes of the 16 descriptors of a group, one word for each. A group has 32 such lines, for bytes 0 to 3, 4 to 7, ...
  struct alignas(64) Line {
    std::array<uint32_t, kDescriptorGroup> word{};
  };
  static constexpr size_t kLines = kDescriptorBytes / sizeof(uint32_t);

  size_t count = 0;
  std::vector<Line> lines;
  std::vector<int32_t> offset;  // 128 times the sum of a descriptor's bytes; for whole groups

  size_t size() const { return count; }
  size_t groups() const { return offset.size() / kDescriptorGroup; }
};

// rows: any number of descriptors, one after another. Throws std::logic_error when the last one is incomplete.
PackedDescriptors PackDescriptors(std::span<const uint8_t> rows);

// For each descriptor of one photo, among those of another:
struct BestDots {
  std::vector<int32_t> dot;     // the largest dot product; 0 if there is none
  std::vector<int32_t> second;  // the second largest, which equals the largest when two share it; 0 if there is none
  std::vector<int32_t> index;   // which one has the largest, the first of equals; -1 when all dot products are 0 or there are none

  bool operator==(const BestDots&) const = default;
};

struct BestDotsBothWays {
  BestDots of_a;  // among the descriptors of b
  BestDots of_b;  // among the descriptors of a
};

// Both ways in one pass over all a.size() * b.size() pairs; either may be empty. On the calling thread.
BestDotsBothWays FindBestDots(const PackedDescriptors& a, const PackedDescriptors& b);

// Whether FindBestDots uses the VNNI instruction VPDPBUSD, which Highway 1.0 does not know: where the active instruction set is AVX-512, the
// processor has it, and it is allowed. Allowed at first; tests and benchmarks refuse it to see the code for older processors. AllowVnni must not be
// called while FindBestDots runs.
bool UsesVnni();
void AllowVnni(bool allowed);

}  // namespace skyquilt::kernel
