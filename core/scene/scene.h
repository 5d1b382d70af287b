// The merged result: the context field and every block's field, ready to answer rays.
// A sample's density is the sum of its blocks' densities times partition-of-unity weights (smooth across margins); outside all
// ground plans the context answers. Frame: rays in survey ENU, metres, double; each field converts once into its own box.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/brightness/luminance.h"
#include "core/brightness/response.h"
#include "core/camera/camera.h"
#include "core/geo/block_box.h"
#include "core/geo/geodetic.h"
#include "core/geo/transform.h"
#include "core/render/ray.h"

namespace skyquilt::scene {

struct SceneBlock : geo::BlockBox {
  std::string name;
  int64_t parameters = 0;
  int64_t steps = 0;
  double train_seconds = 0.0;
  int64_t samples = 0;  // trained
};

// How blocks meet.
enum class Borders {
  kSmooth,  // blended by weights that sum to one across [face - margin, face + margin]
  kHard,    // a block ends at its core box's face, where the next one or the context begins
};
inline std::string NameOf(Borders borders) {
  return borders == Borders::kHard ? "hard" : "smooth";
}

struct SceneInfo {
  geo::Geodetic origin;
  bool georeferenced = false;
  std::vector<SceneBlock> blocks;    // non-empty ones
  Eigen::Vector3d min_enu, max_enu;  // union of the core boxes
  brightness::Response response;     // of the photos, relative to light at reference exposure
  brightness::Luminance luminance;   // concealing field, for badly exposed surveys
  brightness::LuminanceState luminance_state;
  int64_t parameters = 0;  // of all fields, context included
  double context_seconds = 0.0;
  int64_t context_samples = 0;
  double gsd_m = 0.0;  // finest of the blocks
  Borders borders = Borders::kSmooth;
  std::string config;  // TOML text it was trained with
};

// The two renderings of a scene with concealing field; of any other scene they are the same.
enum class Look {
  kNormal,    // what is shown to people
  kRecorded,  // what a photo at reference exposure would have recorded
};

// How a rendering is to look: which of the two, and the change of exposure on top, natural logarithm in linear light per colour.
struct Appearance {
  Look look = Look::kNormal;
  std::array<float, 3> log_gain = {0.0F, 0.0F, 0.0F};
};

// What answering rays has taken so far.
struct RenderStatistics {
  int ranks = 1;   // that render
  int groups = 1;  // of ranks, each holding the scene
  int64_t rays = 0;
  int64_t samples = 0;
  int64_t field_loads = 0;     // more than there are fields where memory is short, or several ranks hold one
  int64_t handovers = 0;       // rays that went on to another rank
  int64_t bytes_sent = 0;      // by the rank that asks
  int64_t bytes_received = 0;  // by it
};

class RayService;

struct SceneOptions {
  double memory_bytes = 0.0;      // fields that do not fit are loaded on demand; 0: all are loaded
  RayService* service = nullptr;  // who answers rays instead of this process, which then loads no field; must outlive the scene
};

// Not for two threads at once.
class Scene {
 public:
  // Throws base::InputError.
  static Scene Load(const std::filesystem::path& scene_h5, const SceneOptions& options = {});
  Scene(Scene&&) noexcept;
  ~Scene();

  const SceneInfo& info() const;
  RenderStatistics statistics() const;
  // Any number of rays, 0 included; out has the same length. Deterministic, for any memory and service.
  // Throws base::Interrupted when cancelled, base::UsageError when not even the blocks that meet at one place fit in memory.
  void RenderRays(std::span<const render::Ray> rays, std::span<render::RayColor> out, const Appearance& appearance, base::ThreadPool& threads) const;
  // All pixels of a camera, row-major, width * height results, colours over the scene's background. Opacity tells where that shows.
  std::vector<render::RayColor> RenderCamera(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu, const Appearance& appearance,
                                             base::ThreadPool& threads) const;

 private:
  Scene();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skyquilt::scene
