// A scene that is open for questions: from one thread at a time, whoever asks first. Nothing here knows Python.
#pragma once

#include <sys/types.h>

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "coordinator/rendering/scene_session.h"
#include "core/comm/communicator.h"
#include "core/image/image.h"
#include "core/scene/point_query.h"
#include "products/ray_caster.h"
#include "python/frames.h"

namespace skyquilt::python {

using Colors = std::vector<render::RayColor>;

struct Rendered {
  std::shared_ptr<Colors> colors;  // row-major, one per pixel
  image::ImageF normals;           // empty when none were asked for
};

// What all rays of a question have in common (render::Ray).
struct RayShape {
  double near_m = 0.0, far_m = 1e30;
  double width_m = 0.0;  // of the column
  double pitch = 0.0;    // of the cone
};

class OpenScene {
 public:
  // threads: 0: all cores. memory_gb: for the fields in memory, 0: half of the machine's. Throws base::InputError, base::UsageError.
  OpenScene(const std::filesystem::path& scene_h5, int threads, double memory_gb);

  const scene::SceneInfo& info() const { return session_.scene().info(); }
  const Places& places() const { return places_; }

  // All of these throw base::Interrupted when cancelled, base::UsageError for wrong arguments and in a process that was forked off after the scene
  // was opened, whose threads are missing.

  // exposure: as products.exposure. normals: "depth", "density", "predicted"; empty: none.
  Rendered Render(const products::View& view, const std::string& exposure, const std::string& normals);
  // Rays of any number; directions of any length. background: what lies behind the fields shows.
  void Cast(std::span<const Eigen::Vector3d> origins, std::span<const Eigen::Vector3d> directions, const RayShape& shape, const std::string& exposure,
            bool background, std::span<render::RayColor> out);
  // Points of a frame; directions in ENU, of any length: one or as many.
  void Query(std::span<const Eigen::Vector3d> points, Frame frame, std::span<const Eigen::Vector3d> directions, const scene::PointOptions& options,
             std::span<scene::PointColor> out);
  // Heights of the surface from above at places x, y of a frame, in this frame's heights: where half of the light of a column of this width has
  // passed. width_m: 0: ground sampling distance of the scene. NaN where there is no surface and outside the scene.
  void Heights(std::span<const Eigen::Vector2d> places, Frame frame, double width_m, std::span<double> out);
  void ToEnu(Frame from, std::span<const Eigen::Vector3d> in, std::span<Eigen::Vector3d> out);
  void FromEnu(Frame to, std::span<const Eigen::Vector3d> in, std::span<Eigen::Vector3d> out);
  // Views of a camera path, the text of a file as `render --path` reads it; messages name `file`.
  std::vector<products::View> Path(const std::string& text, const std::filesystem::path& file, int width, int height);

 private:
  std::unique_lock<std::mutex> Enter();

  comm::SingleCommunicator comm_;
  coordinator::SceneSession session_;
  Places places_;
  std::mutex mutex_;
  pid_t opened_in_;
};

}  // namespace skyquilt::python
