#include "coordinator/rendering/scene_session.h"

#include "coordinator/rendering/rank_parts.h"
#include "coordinator/rendering/serve_rays.h"
#include "core/base/amounts.h"
#include "core/base/log.h"

namespace skyquilt::coordinator {

SceneSession::SceneSession(comm::Communicator& comm, const std::filesystem::path& scene_h5, const RunOptions& options, bool verbose, bool quiet,
                           double* rendering_s)
    : comm_(comm), rendering_s_(rendering_s), threads_(options.threads) {
  if (comm.size() > 1) remote_ = std::make_unique<RemoteRenderer>(comm, RenderingSetup(scene_h5, options, verbose, quiet));
  scene_ = std::make_unique<scene::Scene>(scene::Scene::Load(scene_h5, {.memory_bytes = options.MemoryLimitBytes(), .service = remote_.get()}));
}

SceneSession::~SceneSession() {
  const auto count = [](int64_t n) { return base::FormatCount(static_cast<double>(n)); };
  const int64_t fields = static_cast<int64_t>(scene_->info().blocks.size()) + 1;
  const scene::RenderStatistics s = scene_->statistics();
  if (rendering_s_ != nullptr) *rendering_s_ += s.seconds;
  if (remote_ == nullptr) {
    if (s.field_loads > fields) {
      base::LogInfo("fields were loaded from disk {} times, because they do not all fit in memory. Raise --memory to render faster", s.field_loads);
    }
    return;
  }
  if (s.rays == 0) return;
  base::LogInfo(
      "{} rays rendered by {} rank(s) in {} group(s) that each hold the whole scene: {}B sent, {}B received, {:.0f} bytes per ray, "
      "{} handovers of rays between ranks, {} fields loaded",
      count(s.rays), s.ranks, s.groups, count(s.bytes_sent), count(s.bytes_received),
      static_cast<double>(s.bytes_sent + s.bytes_received) / static_cast<double>(s.rays), count(s.handovers), s.field_loads);
}

std::unique_ptr<products::TileService> SceneSession::TileServiceFor(const std::filesystem::path& survey_folder) const {
  return remote_ ? TilesOnRanks(comm_, remote_->members(), survey_folder) : nullptr;
}

std::unique_ptr<surface::PieceService> SceneSession::PieceServiceForMesh() const {
  return remote_ ? PiecesOnRanks(comm_, remote_->members()) : nullptr;
}

}  // namespace skyquilt::coordinator
