#include "core/scene/paged_renderer.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <numeric>

#include "core/base/cancel.h"
#include "core/base/errors.h"

namespace skyquilt::scene {
namespace {

// Rays of one task: enough to be worth its overhead, few enough that small calls use all threads.
constexpr int64_t kMostInGroup = 1024, kFewestInGroup = 128;

// The segments of a ray, front to back.
struct Way {
  std::vector<render::RaySegment> segments;
  size_t at = 0;  // the next segment to render
};

}  // namespace

PagedRenderer::PagedRenderer(FieldStore& store, const render::RaySegments& segments, base::ThreadPool& threads)
    : store_(store),
      segments_(segments),
      threads_(threads),
      splitters_(static_cast<size_t>(threads.size()), render::RaySplitter(segments)),
      some_(static_cast<size_t>(threads.size())) {}

void PagedRenderer::ForGroups(size_t n, const std::function<void(size_t begin, size_t end, int thread)>& body) {
  const int64_t each = (static_cast<int64_t>(n) + threads_.size() - 1) / threads_.size();
  const int64_t group = std::clamp(each, kFewestInGroup, kMostInGroup);
  threads_.ParallelFor((static_cast<int64_t>(n) + group - 1) / group, [&](int64_t task, int thread) {
    base::ThrowIfCancelled();
    const auto begin = static_cast<size_t>(task * group);
    body(begin, std::min(n, begin + static_cast<size_t>(group)), thread);
  });
}

// Continues these rays through their windows with the loaded fields.
int64_t PagedRenderer::Carry(std::span<const render::Ray> rays, std::span<RayInFlight> in_flight, const render::EngineOptions& options,
                             std::span<const size_t> going, std::span<const render::Window> windows) {
  if (store_.loads() != renderers_loads_ || !(options == renderers_options_)) {
    renderers_.clear();
    renderers_.resize(static_cast<size_t>(threads_.size()));
    renderers_loads_ = store_.loads();
    renderers_options_ = options;
  }
  render::FieldSet fields;
  fields.blocks = store_.Blocks();
  if (store_.HasContext()) fields.context = &store_.context();
  std::atomic<int64_t> evaluated{0};
  ForGroups(going.size(), [&](size_t begin, size_t end, int thread) {
    auto& renderer = renderers_[static_cast<size_t>(thread)];
    if (!renderer) renderer = std::make_unique<render::RayRenderer>(fields, options);
    auto& [some, states] = some_[static_cast<size_t>(thread)];
    some.clear();
    states.clear();
    for (size_t g = begin; g < end; ++g) {
      some.push_back(rays[going[g]]);
      states.push_back(in_flight[going[g]].state);
    }
    evaluated += renderer->Continue(some, windows.subspan(begin, end - begin), states);
    for (size_t g = begin; g < end; ++g) in_flight[going[g]].state = states[g - begin];
  });
  return evaluated;
}

int64_t PagedRenderer::RunTogether(std::span<const render::Ray> rays, std::span<RayInFlight> in_flight, const render::EngineOptions& options) {
  std::vector<size_t> going(rays.size());
  std::iota(going.begin(), going.end(), size_t{0});
  std::vector<render::Window> windows;
  for (const RayInFlight& ray_in_flight : in_flight) windows.push_back({.from = ray_in_flight.at});
  const int64_t evaluated = Carry(rays, in_flight, options, going, windows);
  for (RayInFlight& ray_in_flight : in_flight) ray_in_flight.owner = kFinished;
  return evaluated;
}

int64_t PagedRenderer::Continue(std::span<const render::Ray> rays, std::span<RayInFlight> in_flight, const render::EngineOptions& options, int me,
                                const Owner& owner) {
  SKYQUILT_CHECK(rays.size() == in_flight.size(), "one state in flight per ray");
  const size_t n = rays.size();
  if (!owner && store_.AllFit()) {
    store_.EnsureAllLoaded();
    return RunTogether(rays, in_flight, options);
  }
  std::vector<Way> ways(n);
  ForGroups(n, [&](size_t begin, size_t end, int thread) {
    for (size_t i = begin; i < end; ++i) {
      splitters_[static_cast<size_t>(thread)].Split(rays[i], &ways[i].segments);
      while (ways[i].at + 1 < ways[i].segments.size() && ways[i].segments[ways[i].at].t_far <= in_flight[i].at) ++ways[i].at;
    }
  });
  std::map<int, int> owners;  // per set
  const auto owner_of = [&](int set) {
    const auto at = owners.find(set);
    if (at != owners.end()) return at->second;
    return owners[set] = owner ? owner(segments_.Blocks(set)) : me;
  };
  // Sets the owner of a ray's next segment.
  const auto settle = [&](size_t i) {
    const Way& way = ways[i];
    const bool arrived = in_flight[i].state.ended || way.at >= way.segments.size();
    in_flight[i].owner = arrived ? kFinished : owner_of(way.segments[way.at].set);
  };
  for (size_t i = 0; i < n; ++i) {
    if (in_flight[i].owner != kFinished) settle(i);
  }

  int64_t evaluated = 0;
  while (true) {
    std::map<int, int64_t> waiting;  // rays per set
    for (size_t i = 0; i < n; ++i) {
      if (in_flight[i].owner == me) ++waiting[ways[i].segments[ways[i].at].set];
    }
    if (waiting.empty()) break;
    const auto loaded = [this](int set) {
      const std::span<const int> blocks = segments_.Blocks(set);
      return std::all_of(blocks.begin(), blocks.end(), [this](int k) { return store_.IsLoaded(k); });
    };
    // The set that most rays wait for; loaded sets first.
    const auto next = std::max_element(waiting.begin(), waiting.end(), [&](const auto& a, const auto& b) {
      return std::pair(loaded(a.first), a.second) < std::pair(loaded(b.first), b.second);
    });
    store_.EnsureLoaded(segments_.Blocks(next->first));
    std::map<int, bool> carried;  // whether a set is ours and loaded
    const auto carries = [&](int set) {
      const auto at = carried.find(set);
      if (at != carried.end()) return at->second;
      return carried[set] = owner_of(set) == me && loaded(set);
    };
    std::vector<size_t> going;
    std::vector<render::Window> windows;
    for (size_t i = 0; i < n; ++i) {
      if (in_flight[i].owner != me || !carries(ways[i].segments[ways[i].at].set)) continue;
      Way& way = ways[i];
      while (way.at < way.segments.size() && carries(way.segments[way.at].set)) ++way.at;
      going.push_back(i);
      windows.push_back({in_flight[i].at, way.segments[way.at - 1].t_far});
    }
    evaluated += Carry(rays, in_flight, options, going, windows);
    for (size_t g = 0; g < going.size(); ++g) {
      in_flight[going[g]].at = windows[g].to;
      settle(going[g]);
    }
  }
  return evaluated;
}

}  // namespace skyquilt::scene
