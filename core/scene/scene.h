// The merged result of training: all blocks and the context, rendered as if they were one radiance field.
// The density of a sample is the sum of its blocks' densities times blend weights that sum to 1 and change smoothly across margins; outside all
// blocks the context is rendered. Rays are in survey ENU, metres, double; each field converts them once into its own box.
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
#include "core/geo/height_reference.h"
#include "core/geo/place_accuracy.h"
#include "core/geo/transform.h"
#include "core/render/ray.h"
#include "core/scene/scales.h"

namespace skyquilt::scene {

struct SceneBlock : geo::BlockBox {
  std::string name;
  int64_t parameters = 0;
  int64_t steps = 0;
  double train_seconds = 0.0;
  int64_t samples = 0;         // evaluated in training
  bool shows_context = false;  // the context is rendered in its place; parameters is then 0
};

// How neighbouring blocks are joined.
enum class Borders {
  kSmooth,  // blended across [face - margin, face + margin]
  kHard,    // a block ends at the face of its core box, where the next block or the context begins
};
inline std::string NameOf(Borders borders) {
  return borders == Borders::kHard ? "hard" : "smooth";
}

struct SceneInfo {
  geo::Geodetic origin;
  bool georeferenced = false;
  // Of the survey; unknown in scenes of older programs.
  geo::PlaceAccuracy accuracy;
  geo::HeightReference height_reference = geo::HeightReference::kUnknown;
  std::vector<SceneBlock> blocks;    // without empty ones; those that show the context last
  Eigen::Vector3d min_enu, max_enu;  // union of the core boxes
  brightness::Response response;     // of the photos, relative to light at reference exposure
  brightness::Luminance luminance;   // concealing field, for under- or over-exposed surveys
  brightness::LuminanceState luminance_state;
  int64_t parameters = 0;  // of all fields, context included
  double context_seconds = 0.0;
  int64_t context_samples = 0;
  double gsd_m = 0.0;  // ground sampling distance of the finest block
  Scales scales;
  Borders borders = Borders::kSmooth;
  bool density_normals = false;  // whether all fields have normals of the density: not every encoding has
  bool normal_head = false;      // whether all blocks predict normals
  std::string config;            // TOML text of the configuration it was trained with
};

// The two renderings of a scene with a concealing field. For other scenes they are the same.
enum class Rendition {
  kNormal,    // shown to people
  kRecorded,  // as a photo at reference exposure would have recorded the scene
};

// Brightness of a rendering, and what it shows beside colours.
struct Appearance {
  Rendition look = Rendition::kNormal;
  std::array<float, 3> log_gain = {0.0F, 0.0F, 0.0F};  // additional exposure per colour: natural logarithm of a factor on linear light
  bool normals = false;                                // also the normals of render::RayColor, which takes longer
  bool plain_surround = false;                         // over a background: core/scene/surround.h where no photo looked
  double depths_to_opacity = 0.0;                      // above 0: only depths, of rays that end there (render::EngineOptions::DepthsOnly)
};

// Counts of all rays rendered so far.
struct RenderStatistics {
  int ranks = 1;   // ranks that render
  int groups = 1;  // groups of ranks; each group holds the whole scene
  int64_t rays = 0;
  int64_t samples = 0;
  int64_t field_loads = 0;     // larger than the number of fields when memory is short or several ranks hold the same field
  int64_t handovers = 0;       // rays passed on to another rank
  int64_t bytes_sent = 0;      // by the rank that requests rays
  int64_t bytes_received = 0;  // by the same rank
  double seconds = 0.0;        // that the calls took which rendered them
};

class RayService;
struct Background;
struct PointColor;
struct PointOptions;

struct SceneOptions {
  double memory_bytes = 0.0;      // limit for the fields in memory; those that do not fit are loaded on demand; 0: no limit
  RayService* service = nullptr;  // renders the rays instead of this process, which then loads no field; must outlive the scene
};

// Not for two threads at once.
class Scene {
 public:
  // Throws base::InputError.
  static Scene Load(const std::filesystem::path& scene_h5, const SceneOptions& options = {});
  Scene(Scene&&) noexcept;
  ~Scene();

  const SceneInfo& info() const;
  const Background& background() const;
  RenderStatistics statistics() const;
  // Any number of rays, 0 included; out has the same length. Same bits for any memory, service and number of threads.
  // Throws base::Interrupted when cancelled, base::UsageError when the overlapping blocks of one place do not fit in memory.
  void RenderRays(std::span<const render::Ray> rays, std::span<render::RayColor> out, const Appearance& appearance, base::ThreadPool& threads) const;
  // The same, composited over the scene's background, which shows where opacity is below 1: the colours that RenderCamera gives these rays.
  void RenderRaysOverBackground(std::span<const render::Ray> rays, std::span<render::RayColor> out, const Appearance& appearance,
                                base::ThreadPool& threads) const;
  // All pixels of a camera, row-major, width * height results, over the background. See core/scene/camera_rays.h for some pixels.
  std::vector<render::RayColor> RenderCamera(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu, const Appearance& appearance,
                                             base::ThreadPool& threads) const;
  // Density and colour at points, see core/scene/point_query.h. Not with a service, which renders rays only.
  void QueryPoints(std::span<const Eigen::Vector3d> x_in_enu, std::span<const Eigen::Vector3d> direction_enu, const PointOptions& options,
                   std::span<PointColor> out, base::ThreadPool& threads) const;

 private:
  Scene();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skyquilt::scene
