// The light that comes along rays, from whatever they meet in a simulated place. Photos and the true orthophoto share it, so that the same ray has
// the same colour in both.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "core/raytrace/traced_scene.h"
#include "simulate/world.h"

namespace skyquilt::simulate {

// The rays of a packet are a square of samples: lane = column + kPacketSide * row. Each 2 x 2 of them use different points of the sun's disc.
inline constexpr int kPacketSide = 4;
static_assert(kPacketSide * kPacketSide == static_cast<int>(raytrace::kPacket));
inline constexpr float kFarthestHit_m = 1e6F;

// Of a square of 1, 4 or 16 samples.
int SamplesPerSide(int samples);

// Width of a pixel at a distance t along its rays: at_start_m + t * per_metre.
struct PixelWidth {
  float at_start_m = 0.0F;
  float per_metre = 0.0F;
};

struct RayLight {
  std::array<Eigen::Vector3f, raytrace::kPacket> radiance;  // linear; undefined for lanes that are not valid
  uint32_t moved = 0;                                       // lanes that meet a moving car, a person or their shadows, as a bit mask
};

class RayShader {
 public:
  // Holds a reference: the world must outlive it.
  RayShader(const World& world, bool soft_shadows) : world_(world), soft_shadows_(soft_shadows) {}

  // Traces the valid rays of a packet, which has their hits afterwards, and returns the light that comes along them. Thread-safe.
  RayLight Trace(const MovingScene& moving, const PixelWidth& pixel, raytrace::RayPacket& rays) const;

 private:
  Eigen::Vector3f Shade(const Hit& hit, const Surface& surface, float sun_share) const;

  const World& world_;
  bool soft_shadows_;
};

}  // namespace skyquilt::simulate
