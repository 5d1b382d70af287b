// A scene opened for rendering, with all ranks and within the memory that the settings allow.
#pragma once

#include <filesystem>
#include <memory>

#include "coordinator/project/run_options.h"
#include "coordinator/rendering/remote_renderer.h"
#include "core/base/thread_pool.h"
#include "core/comm/communicator.h"
#include "core/scene/scene.h"

namespace skyquilt::coordinator {

class SceneSession {
 public:
  // One process alone renders itself. Throws base::InputError, base::UsageError.
  SceneSession(comm::Communicator& comm, const std::filesystem::path& scene_h5, const RunOptions& options, bool verbose, bool quiet);
  // Says in the log what it took: rays per second is the caller's to say.
  ~SceneSession();
  SceneSession(const SceneSession&) = delete;
  SceneSession& operator=(const SceneSession&) = delete;

  const scene::Scene& scene() const { return *scene_; }
  base::ThreadPool& threads() { return threads_; }

 private:
  base::ThreadPool threads_;
  std::unique_ptr<RemoteRenderer> remote_;
  std::unique_ptr<scene::Scene> scene_;
};

}  // namespace skyquilt::coordinator
