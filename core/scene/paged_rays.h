// Renders rays through more fields than fit in memory: as far as the loaded ones carry, then with others.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/render/ray_engine.h"
#include "core/render/ray_segments.h"
#include "core/scene/field_store.h"

namespace skyquilt::scene {

// A ray on its way through a scene.
struct RayInFlight {
  render::RayState state;
  double at = 0.0;  // metres along the ray: what lies before is gathered
  int owner = 0;    // who goes on with it; kArrived when nobody needs to
};
constexpr int kArrived = -1;

class PagedRays {
 public:
  // Who renders where these blocks meet (a set of RaySegments): any numbers from 0. Empty: everything is for `me`.
  using Owner = std::function<int(std::span<const int> blocks)>;

  // All must outlive this.
  PagedRays(FieldStore& store, const render::RaySegments& segments, base::ThreadPool& threads);

  // Takes every ray on until it arrives or comes to a place of another owner than `me`; rays of others are left as they are. The result does
  // not depend on memory, owners or threads. Returns the samples evaluated. Throws base::UsageError (memory too small), base::Interrupted.
  int64_t Continue(std::span<const render::Ray> rays, std::span<RayInFlight> in_flight, const render::EngineOptions& options, int me,
                   const Owner& owner);

 private:
  void ForGroups(size_t n, const std::function<void(size_t begin, size_t end, int thread)>& body);
  int64_t Carry(std::span<const render::Ray> rays, std::span<RayInFlight> in_flight, const render::EngineOptions& options,
                std::span<const size_t> going, std::span<const render::Window> windows);
  int64_t RunTogether(std::span<const render::Ray> rays, std::span<RayInFlight> in_flight, const render::EngineOptions& options);

  FieldStore& store_;
  const render::RaySegments& segments_;
  base::ThreadPool& threads_;
  // One per thread, kept while the loaded fields and the options stay the same.
  std::vector<std::unique_ptr<render::RayRenderer>> renderers_;
  int64_t renderers_loads_ = -1;
  render::EngineOptions renderers_options_;
};

}  // namespace skyquilt::scene
