// A scene opened for rendering. It is rendered by all other ranks, or by this process when it is the only one, within the memory limit of [run].
#pragma once

#include <filesystem>
#include <memory>

#include "coordinator/project/run_options.h"
#include "coordinator/rendering/remote_renderer.h"
#include "core/base/thread_pool.h"
#include "core/comm/communicator.h"
#include "core/scene/scene.h"
#include "products/photo_map/tile_service.h"
#include "surface/piece_service.h"

namespace skyquilt::coordinator {

class SceneSession {
 public:
  // rendering_s: the seconds that rendering took are added to it at the end; null: they are not asked for. Throws base::InputError, base::UsageError.
  SceneSession(comm::Communicator& comm, const std::filesystem::path& scene_h5, const RunOptions& options, bool verbose, bool quiet,
               double* rendering_s = nullptr);
  // Logs traffic between ranks and repeated loading of fields. Speed (rays per second) is logged by the caller.
  ~SceneSession();
  SceneSession(const SceneSession&) = delete;
  SceneSession& operator=(const SceneSession&) = delete;

  const scene::Scene& scene() const { return *scene_; }
  base::ThreadPool& threads() { return threads_; }
  // Paints tiles of orthophotos of this survey on the other ranks; null where this process is the only one. survey_folder: of the project.
  std::unique_ptr<products::TileService> TileServiceFor(const std::filesystem::path& survey_folder) const;
  // Fuses pieces of a mesh on the other ranks; null where this process is the only one.
  std::unique_ptr<surface::PieceService> PieceServiceForMesh() const;

 private:
  comm::Communicator& comm_;
  double* rendering_s_;
  base::ThreadPool threads_;
  std::unique_ptr<RemoteRenderer> remote_;
  std::unique_ptr<scene::Scene> scene_;
};

}  // namespace skyquilt::coordinator
