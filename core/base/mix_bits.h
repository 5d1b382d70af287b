// A hash of a number, for choices that look random but depend on nothing else than the number.
#pragma once

#include <cstdint>

namespace skyquilt::base {

// Every bit of the result depends on all bits of x (last step of SplitMix64, Steele et al. 2014).
inline uint64_t MixBits(uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31U);
}

}  // namespace skyquilt::base
