// PCG32 random generator (O'Neill 2014): 64-bit state, 32-bit output, one independent sequence per `stream`.
// The same seed and stream give the same numbers on every machine. There is no global generator: it is always passed as an argument.
#pragma once

#include <cstdint>
#include <string>

namespace skyquilt::base {

class Random {
 public:
  explicit Random(uint64_t seed = 1, uint64_t stream = 0) : increment_((stream << 1U) | 1U) {
    NextU32();
    state_ += seed;
    NextU32();
  }

  uint32_t NextU32() {
    const uint64_t old = state_;
    state_ = old * 6364136223846793005ULL + increment_;
    const auto xorshifted = static_cast<uint32_t>(((old >> 18U) ^ old) >> 27U);
    const auto rotation = static_cast<uint32_t>(old >> 59U);
    return (xorshifted >> rotation) | (xorshifted << ((32U - rotation) & 31U));
  }
  // Uniform in [0, 1) with 24 bits.
  float Uniform() { return static_cast<float>(NextU32() >> 8U) * 0x1.0p-24F; }
  double UniformDouble() {
    const uint64_t high = NextU32() >> 5U;
    const uint64_t low = NextU32() >> 6U;
    return (static_cast<double>(high) * 67108864.0 + static_cast<double>(low)) / 9007199254740992.0;
  }
  double Uniform(double low, double high) { return low + (high - low) * UniformDouble(); }
  // Uniform in [0, n); n = 0 gives 0. The bias is below n / 2^32.
  uint32_t Below(uint32_t n) { return static_cast<uint32_t>((static_cast<uint64_t>(NextU32()) * n) >> 32U); }
  // Standard normal distribution (Box-Muller; the second value of each pair is not used).
  double Normal();

  // For checkpoints: Restore with both numbers continues the sequence.
  uint64_t state() const { return state_; }
  uint64_t increment() const { return increment_; }
  void Restore(uint64_t state, uint64_t increment) {
    state_ = state;
    increment_ = increment;
  }

 private:
  uint64_t state_ = 0;
  uint64_t increment_;
};

// 16 hex digits from the system's source of random numbers, for names that must differ between processes. Process numbers would not do: containers
// on one disk have the same ones.
std::string RandomToken();

// A hash of a number, for choices that look random but depend on nothing else than the number. Every bit of the result depends on all bits of x (last
// step of SplitMix64, Steele et al. 2014).
inline uint64_t MixBits(uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31U);
}

}  // namespace skyquilt::base
