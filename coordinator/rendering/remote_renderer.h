// Rank 0's side of rendering on several ranks. When the scene fits into each rank's memory, every rank renders whole rays. Otherwise groups of
// ranks hold the scene together, and a ray passes from rank to rank, front to back, with its colour and transmittance so far
// (scene::RayInFlight). The image is bit-identical to that of a single process.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/ranks/failure.h"
#include "coordinator/ranks/rank_group.h"
#include "coordinator/rendering/block_owners.h"
#include "coordinator/rendering/ray_request.h"
#include "core/comm/communicator.h"
#include "core/scene/ray_service.h"

namespace skyquilt::coordinator {

class RemoteRenderer : public scene::RayService {
 public:
  // Starts the rendering on the other ranks (at least one), which open the scene file; the destructor ends it there.
  // `setup`: from RenderingSetup, see serve_rays.h.
  RemoteRenderer(comm::Communicator& comm, const std::string& setup);

  void Begin(const scene::FieldStore& store, const render::RaySegments& segments) override;
  void Render(std::span<const render::Ray> rays, std::span<render::RayColor> out, const render::EngineOptions& options) override;

  // Those that render, after Begin.
  const std::vector<GroupMember>& members() const { return members_; }
  scene::RenderStatistics statistics() const override { return statistics_; }

 private:
  // Rays that wait for a rank, or that a rank is rendering.
  struct Request {
    size_t group = 0;
    std::vector<size_t> rays;  // indices into the call's rays
  };
  struct Work;

  void HandOut(Work& work);
  void AddChunk(Work& work, size_t group);
  void Queue(Work& work, int rank, Request request);
  void Send(Work& work, int rank);
  void TakeBack(Work& work, const comm::Message& message);

  comm::Communicator& comm_;
  RankGroup group_;
  const scene::FieldStore* store_ = nullptr;
  const render::RaySegments* segments_ = nullptr;
  std::optional<render::RaySplitter> splitter_;  // of these
  std::vector<GroupMember> members_;
  std::vector<RenderGroup> groups_;
  uint64_t next_id_ = 1;
  std::optional<Failure> broken_;  // a rank cannot go on, and nor can any later call
  std::map<int, int64_t> loads_;   // per rank
  scene::RenderStatistics statistics_;
};

}  // namespace skyquilt::coordinator
