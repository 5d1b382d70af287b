// Traces rays against one triangle mesh with Embree, 16 rays at a time, for simulated photos.
// The mesh cannot be changed after construction; tracing is const and thread-safe. All scenes of the process use one Embree device, so any thread may
// make scenes, as many as fit in memory. Triangles are hit from both sides. The BVH is built on one thread, so that the same mesh always gives the
// same hits.
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

// Structure of arrays, metres; directions have length 1. A hit sets t_far, triangle and its barycentric coordinates u, v, so that only closer hits
// are found by later calls.
struct alignas(64) RayPacket {
  std::array<float, kPacket> ox, oy, oz, dx, dy, dz, t_near, t_far, u, v;
  std::array<uint32_t, kPacket> triangle;
  std::array<int32_t, kPacket> valid;  // -1: trace, 0: skip

  // Puts a ray without a hit into a lane.
  void Set(size_t lane, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float near_m, float far_m);
};

class TracedScene {
 public:
  // position: metres, in a frame of the caller's choice (float: within a few kilometres of its origin). triangle: indices of three positions each.
  // Both are copied. Without triangles no ray hits anything. Throws std::logic_error when Embree reports an error.
  TracedScene(std::span<const Eigen::Vector3f> position, std::span<const std::array<uint32_t, 3>> triangle);
  ~TracedScene();
  TracedScene(TracedScene&&) noexcept;
  TracedScene& operator=(TracedScene&&) noexcept;

  // Finds the nearest hits in (t_near, t_far). Returns the lanes with a new hit as a bit mask.
  uint32_t Intersect(RayPacket& rays) const;
  // Returns the lanes with any hit in (t_near, t_far) as a bit mask.
  uint32_t Occluded(const RayPacket& rays) const;
  bool empty() const { return empty_; }

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  bool empty_ = true;
};

}  // namespace skyquilt::raytrace
