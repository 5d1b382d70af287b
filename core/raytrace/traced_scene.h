// Ray tracing of one mesh by Embree, 16 rays at a time. Committed once; tracing is const and thread-safe. All scenes of the process share one Embree
// device, so there may be as many as memory holds, made by any thread.
// Triangles are intersected from both sides. The BVH is built on one thread, so that the same mesh always gives the same hits.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace skyquilt::raytrace {

constexpr size_t kPacket = 16;
constexpr uint32_t kNoTriangle = 0xffffffffU;

// Structure of arrays, metres; directions of length 1. A hit shortens t_far and sets triangle, u, v; a closer earlier hit stays.
struct alignas(64) RayPacket {
  std::array<float, kPacket> ox, oy, oz, dx, dy, dz, t_near, t_far, u, v;
  std::array<uint32_t, kPacket> triangle;
  std::array<int32_t, kPacket> valid;  // -1: trace, 0: skip

  // Lane to be traced with nothing hit yet.
  void Set(size_t lane, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float near_m, float far_m);
};

class TracedScene {
 public:
  // position: metres, in one frame of the caller's (float: within a few kilometres of its origin); triangle: indices of three positions each. Both
  // are copied. No triangles: an empty scene, which nothing hits. Throws std::logic_error when Embree refuses.
  TracedScene(std::span<const Eigen::Vector3f> position, std::span<const std::array<uint32_t, 3>> triangle);
  ~TracedScene();
  TracedScene(TracedScene&&) noexcept;
  TracedScene& operator=(TracedScene&&) noexcept;

  // Nearest hits in (t_near, t_far). Returns the lanes whose hit changed as a bit mask.
  uint32_t Intersect(RayPacket& rays) const;
  // Lanes with anything in (t_near, t_far), as a bit mask.
  uint32_t Occluded(const RayPacket& rays) const;
  bool empty() const { return empty_; }

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  bool empty_ = true;
};

}  // namespace skyquilt::raytrace
