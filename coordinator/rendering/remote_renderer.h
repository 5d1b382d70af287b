// Rays answered by the other ranks, as rank 0 sees it. Ranks whose memory holds the whole scene work side by side; otherwise groups of ranks hold
// it together, and a ray goes from rank to rank, front to back, with what it has gathered (scene::RayInFlight). So the picture is the one that a
// single process makes, to the bit.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "coordinator/ranks/rank_group.h"
#include "coordinator/rendering/block_owners.h"
#include "coordinator/rendering/ray_request.h"
#include "core/comm/communicator.h"
#include "core/scene/ray_service.h"

namespace skyquilt::coordinator {

class RemoteRenderer : public scene::RayService {
 public:
  // Calls the other ranks together (at least one); they open the scene file. Its destructor sends them back.
  // `setup` is for ServeRays, see serve_rays.h.
  RemoteRenderer(comm::Communicator& comm, const std::string& setup);

  void Begin(const scene::FieldStore& store, const render::RaySegments& segments) override;
  void Render(std::span<const render::Ray> rays, std::span<render::RayColor> out, const render::EngineOptions& options) override;

  scene::RenderStatistics statistics() const override { return statistics_; }

 private:
  // Rays that wait for a rank, or are with one.
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
  std::vector<SceneHolders> groups_;
  uint64_t next_id_ = 1;
  std::map<int, int64_t> loads_;  // per rank
  scene::RenderStatistics statistics_;
};

}  // namespace skyquilt::coordinator
