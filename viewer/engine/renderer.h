// What the scheduler needs of the scenes, so that it can be tested without any.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "core/geo/transform.h"
#include "core/render/ray.h"
#include "products/ray_caster.h"
#include "viewer/protocol/messages.h"
#include "viewer/queries/query.h"

namespace skyquilt::viewer {

struct SceneFrame {
  bool cones = false;                                          // scene::Scales::Cones
  Eigen::Vector3d min_enu = Eigen::Vector3d::Zero();           // box of the scene, in its own frame, metres
  Eigen::Vector3d max_enu = Eigen::Vector3d::Zero();           //
  std::optional<geo::Rigid3d> scene_from_main = std::nullopt;  // the main project's ENU into this scene's; none: the same
};

// Only for the engine's thread.
class Renderer {
 public:
  virtual ~Renderer() = default;
  // Null when the project's field cannot be rendered; WhyNot then says why and what helps. Valid until the next loading.
  virtual const SceneFrame* Frame(Which project) const = 0;
  virtual std::string WhyNot(Which project) const = 0;
  // Rays that are rendered within about 10 ms, which is how long anything else has to wait.
  virtual size_t Batch(Which project) const = 0;
  // Rays in the frame of the project's scene, over its background, in the brightness that was asked for. Same length. Throws base::UsageError,
  // base::InputError, base::Interrupted.
  virtual void Render(Which project, std::span<const render::Ray> rays, std::span<render::RayColor> out) = 0;
  // Camera and pose of a photo of the main project in this width, as `skyquilt render` has them. Throws BadMessage when there is none.
  virtual products::View PhotoView(int photo, int width) const = 0;
  virtual FieldAccess Access() = 0;
};

}  // namespace skyquilt::viewer
