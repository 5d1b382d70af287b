// 16-bit storage of 32-bit floats, to halve the size of a scene file: bfloat16 (8 exponent bits, 8 mantissa bits with the hidden one) and IEEE 754
// binary16 (5 and 11). Rounds to nearest, ties to even. Values too large for the format become its largest finite number, not infinity: a single
// infinite parameter would turn a whole field into NaN. NaN stays NaN.
#pragma once

#include <bit>
#include <cstdint>

namespace skyquilt::base {

constexpr float kLargestBfloat16 = 3.38953139e38F;
constexpr float kLargestFloat16 = 65504.0F;

inline float FloatFromBfloat16(uint16_t bits) {
  return std::bit_cast<float>(static_cast<uint32_t>(bits) << 16U);
}

inline uint16_t Bfloat16FromFloat(float value) {
  const auto bits = std::bit_cast<uint32_t>(value);
  const uint32_t magnitude = bits & 0x7FFFFFFFU;
  const uint32_t sign = bits >> 16U & 0x8000U;
  if (magnitude > 0x7F800000U) return static_cast<uint16_t>(sign | 0x7FC0U);
  const uint32_t rounded = (magnitude + 0x7FFFU + (magnitude >> 16U & 1U)) >> 16U;
  return static_cast<uint16_t>(sign | (rounded >= 0x7F80U ? 0x7F7FU : rounded));
}

inline float FloatFromFloat16(uint16_t half) {
  const uint32_t sign = static_cast<uint32_t>(half & 0x8000U) << 16U;
  const uint32_t exponent = half >> 10U & 0x1FU;
  const uint32_t mantissa = half & 0x3FFU;
  if (exponent == 0x1FU) return std::bit_cast<float>(sign | 0x7F800000U | mantissa << 13U);
  if (exponent == 0) {
    // Subnormal: a multiple of 2^-24.
    const float magnitude = static_cast<float>(mantissa) * 0x1p-24F;
    return sign != 0 ? -magnitude : magnitude;
  }
  return std::bit_cast<float>(sign | (exponent + 112U) << 23U | mantissa << 13U);
}

inline uint16_t Float16FromFloat(float value) {
  const auto bits = std::bit_cast<uint32_t>(value);
  const uint32_t magnitude = bits & 0x7FFFFFFFU;
  const uint32_t sign = bits >> 16U & 0x8000U;
  if (magnitude > 0x7F800000U) return static_cast<uint16_t>(sign | 0x7E00U);
  if (magnitude < 0x38800000U) {
    // Below 2^-14 the result is subnormal, a multiple of 2^-24. Adding 0.5 puts the rounded multiple into the low bits of the sum.
    const float shifted = std::bit_cast<float>(magnitude) + 0.5F;
    return static_cast<uint16_t>(sign | (std::bit_cast<uint32_t>(shifted) - 0x3F000000U));
  }
  const uint32_t rounded = (magnitude - 0x38000000U + 0xFFFU + (magnitude >> 13U & 1U)) >> 13U;
  return static_cast<uint16_t>(sign | (rounded >= 0x7C00U ? 0x7BFFU : rounded));
}

}  // namespace skyquilt::base
