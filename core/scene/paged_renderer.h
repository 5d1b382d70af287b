// Renders rays through more fields than fit in memory: continues them as far as the loaded fields reach, then loads others.
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

// A partly rendered ray.
struct RayInFlight {
  render::RayState state;
  double at = 0.0;  // metres along the ray up to which it has been rendered
  int owner = 0;    // who continues it; kFinished: it is finished
};
constexpr int kFinished = -1;

class PagedRenderer {
 public:
  // Returns who renders a segment that needs these blocks (a set of RaySegments): a rank or any other number from 0. Empty function: always `me`.
  using Owner = std::function<int(std::span<const int> blocks)>;

  // All arguments must outlive this.
  PagedRenderer(FieldStore& store, const render::RaySegments& segments, base::ThreadPool& threads);

  // Continues every ray whose owner is `me` until it is finished or reaches a segment of another owner; other rays are left as they are. The result
  // does not depend on memory, owners or threads. Returns the number of samples evaluated. Throws base::UsageError when memory is too small,
  // base::Interrupted when cancelled.
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
  std::vector<render::RaySplitter> splitters_;  // one per thread
  // Workspace of a thread: some of the rays of a call.
  struct Some {
    std::vector<render::Ray> rays;
    std::vector<render::RayState> states;
  };
  std::vector<Some> some_;  // one per thread
  // One per thread, kept while the loaded fields and the options stay the same.
  std::vector<std::unique_ptr<render::RayRenderer>> renderers_;
  int64_t renderers_loads_ = -1;
  render::EngineOptions renderers_options_;
};

}  // namespace skyquilt::scene
