// Noise for procedural textures. Octaves finer than the pixel footprint fade out, so that textures do not alias. Pure functions of position and seed,
// so the result does not depend on threads.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace skyquilt::simulate {

inline uint32_t HashCell(int x, int y, uint32_t seed) {
  uint32_t h = static_cast<uint32_t>(x) * 0x8da6b343U ^ static_cast<uint32_t>(y) * 0xd8163841U ^ (seed + 0x9e3779b9U) * 0xcb1ab31fU;
  h ^= h >> 15U;
  h *= 0x2c1b3c6dU;
  h ^= h >> 12U;
  h *= 0x297a2d39U;
  h ^= h >> 15U;
  return h;
}

// Uniform in [0, 1).
inline float HashUnit(int x, int y, uint32_t seed) {
  return static_cast<float>(HashCell(x, y, seed) >> 8U) * 0x1.0p-24F;
}

inline int FloorInt(float x) {
  const int i = static_cast<int>(x);
  return x < static_cast<float>(i) ? i - 1 : i;
}

inline float Smoothstep(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0F, 1.0F);
  return t * t * (3.0F - 2.0F * t);
}

// Value noise in [-1, 1] on a lattice with cells of size 1.
inline float ValueNoise(float x, float y, uint32_t seed) {
  const int ix = FloorInt(x);
  const int iy = FloorInt(y);
  const float fx = x - static_cast<float>(ix);
  const float fy = y - static_cast<float>(iy);
  const float wx = fx * fx * (3.0F - 2.0F * fx);
  const float wy = fy * fy * (3.0F - 2.0F * fy);
  const float a = HashUnit(ix, iy, seed);
  const float b = HashUnit(ix + 1, iy, seed);
  const float c = HashUnit(ix, iy + 1, seed);
  const float d = HashUnit(ix + 1, iy + 1, seed);
  return 2.0F * (a + (b - a) * wx + (c - a) * wy + (a - b - c + d) * wx * wy) - 1.0F;
}

struct FractalShape {
  float wavelength_m = 10.0F;  // of the first octave
  int octaves = 4;             // each has half the wavelength of the one before
  float persistence = 0.5F;    // amplitude of an octave relative to the one before; 0.5 is the 1/f of natural surfaces
};

// Sum of octaves, the first with amplitude 1. Octaves with a wavelength below 4 footprints are reduced, below 2 left out. footprint: metres per
// pixel; 0 keeps all octaves.
inline float FractalNoise(float x, float y, const FractalShape& shape, uint32_t seed, float footprint) {
  float sum = 0.0F;
  float amplitude = 1.0F;
  float wavelength = shape.wavelength_m;
  for (int octave = 0; octave < shape.octaves; ++octave) {
    const float keep = wavelength >= 4.0F * footprint ? 1.0F : wavelength / (2.0F * footprint) - 1.0F;
    if (keep <= 0.0F) break;
    const float inverse = 1.0F / wavelength;
    sum += amplitude * keep * ValueNoise(x * inverse, y * inverse, seed + static_cast<uint32_t>(octave));
    amplitude *= shape.persistence;
    wavelength *= 0.5F;
    // Each octave is rotated to hide the axes of the lattice.
    const float turned = 0.8F * x - 0.6F * y;
    y = 0.6F * x + 0.8F * y;
    x = turned;
  }
  return sum;
}

// Share of [x - width/2, x + width/2] covered by bars [0, duty) of a pattern with period 1: the exact box filter of a pulse train.
inline float PulseTrain(float x, float duty, float width) {
  const auto integral = [duty](float at) {
    const auto whole = static_cast<float>(FloorInt(at));
    return whole * duty + std::min(at - whole, duty);
  };
  const float w = std::max(width, 1e-4F);
  return (integral(x + 0.5F * w) - integral(x - 0.5F * w)) / w;
}

// Share of [x - width/2, x + width/2] inside [low, high].
inline float Bar(float x, float low, float high, float width) {
  const float w = std::max(width, 1e-4F);
  return std::clamp((std::min(x + 0.5F * w, high) - std::max(x - 0.5F * w, low)) / w, 0.0F, 1.0F);
}

}  // namespace skyquilt::simulate
