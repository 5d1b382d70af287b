#include "python/open_scene.h"

#include <unistd.h>

#include <algorithm>
#include <limits>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/gis/map_projection.h"
#include "products/camera_path.h"
#include "products/map_rays.h"
#include "products/normal_pictures.h"

namespace skyquilt::python {
namespace {

constexpr size_t kRaysAtATime = size_t{1} << 16U;  // so that memory does not grow with the question

coordinator::RunOptions OptionsOf(int threads, double memory_gb) {
  coordinator::RunOptions options;
  options.threads = threads;
  options.memory_gb = memory_gb;
  options.Check();
  return options;
}

void RequireAsMany(size_t n, size_t directions, const std::string& what) {
  if (directions == n) return;
  throw base::UsageError("there are " + std::to_string(n) + " " + what + " and " + std::to_string(directions) + " directions");
}

Eigen::Vector3d UnitOf(const Eigen::Vector3d& direction, size_t i) {
  if (!direction.allFinite() || !(direction.norm() > 0.0)) throw base::UsageError("direction " + std::to_string(i) + " is zero or not finite");
  return direction.normalized();
}

}  // namespace

OpenScene::OpenScene(const std::filesystem::path& scene_h5, int threads, double memory_gb)
    : session_(comm_, scene_h5, OptionsOf(threads, memory_gb), false, true),
      places_(session_.scene().info().origin, session_.scene().info().georeferenced),
      opened_in_(getpid()) {}

std::unique_lock<std::mutex> OpenScene::Enter() {
  if (getpid() != opened_in_) {
    throw base::UsageError(
        "this scene was opened before the process was forked, and its threads stayed behind: open it in the new process, or start processes with "
        "multiprocessing.set_start_method('spawn')");
  }
  return std::unique_lock(mutex_);
}

Rendered OpenScene::Render(const products::View& view, const std::string& exposure, const std::string& normals) {
  const auto lock = Enter();
  if (const std::string problem = view.camera.Problem(); !problem.empty()) throw base::UsageError("the camera of the view: " + problem);
  scene::Appearance appearance = products::AppearanceOf(exposure, info());
  if (normals.empty()) {
    return {std::make_shared<Colors>(session_.scene().RenderCamera(view.camera, view.cam_from_enu, appearance, session_.threads())), {}};
  }
  const products::NormalKind kind = products::NormalKindNamed(normals);
  products::RequireNormals(kind, info());
  appearance.normals = products::NeedsRenderedNormals(kind);
  Rendered rendered{std::make_shared<Colors>(session_.scene().RenderCamera(view.camera, view.cam_from_enu, appearance, session_.threads())), {}};
  rendered.normals = products::NormalsOfView(kind, view, *rendered.colors, session_.threads());
  return rendered;
}

void OpenScene::Cast(std::span<const Eigen::Vector3d> origins, std::span<const Eigen::Vector3d> directions, const RayShape& shape,
                     const std::string& exposure, bool background, std::span<render::RayColor> out) {
  RequireAsMany(origins.size(), directions.size(), "origins");
  const auto lock = Enter();
  const scene::Appearance appearance = products::AppearanceOf(exposure, info());
  std::vector<render::Ray> rays;
  for (size_t first = 0; first < origins.size(); first += kRaysAtATime) {
    const size_t end = std::min(origins.size(), first + kRaysAtATime);
    rays.clear();
    for (size_t i = first; i < end; ++i) {
      if (!origins[i].allFinite()) throw base::UsageError("the origin of ray " + std::to_string(i) + " is not finite");
      rays.push_back({.origin_enu = origins[i],
                      .direction_enu = UnitOf(directions[i], i),
                      .t_near = shape.near_m,
                      .t_far = shape.far_m,
                      .pixel_pitch = static_cast<float>(shape.pitch),
                      .pixel_width = static_cast<float>(shape.width_m)});
    }
    if (background) {
      session_.scene().RenderRaysOverBackground(rays, out.subspan(first, rays.size()), appearance, session_.threads());
    } else {
      session_.scene().RenderRays(rays, out.subspan(first, rays.size()), appearance, session_.threads());
    }
  }
}

void OpenScene::Query(std::span<const Eigen::Vector3d> points, Frame frame, std::span<const Eigen::Vector3d> directions,
                      const scene::PointOptions& options, std::span<scene::PointColor> out) {
  if (directions.size() != 1) RequireAsMany(points.size(), directions.size(), "points");
  const auto lock = Enter();
  std::vector<Eigen::Vector3d> unit;
  unit.reserve(directions.size());
  for (size_t i = 0; i < directions.size(); ++i) unit.push_back(UnitOf(directions[i], i));
  std::vector<Eigen::Vector3d> enu;
  if (frame != Frame::kEnu) {
    enu.resize(points.size());
    places_.ToEnu(frame, points, enu, session_.threads());
    points = enu;
  }
  session_.scene().QueryPoints(points, unit, options, out, session_.threads());
}

void OpenScene::Heights(std::span<const Eigen::Vector2d> places, Frame frame, double width_m, std::span<double> out) {
  const auto lock = Enter();
  places_.Require(frame);
  gis::MapGrid grid;
  grid.georeferenced = frame != Frame::kEnu;
  if (grid.georeferenced) grid.zone = *places_.zone();
  const gis::MapProjection projection(info().origin, grid);
  const double column_m = width_m > 0.0 ? width_m : info().gsd_m;
  std::vector<render::Ray> rays;
  std::vector<std::pair<size_t, double>> starts;  // place and height where the ray begins
  std::vector<render::RayColor> colors;
  const auto flush = [&] {
    colors.resize(rays.size());
    session_.scene().RenderRays(rays, colors, {}, session_.threads());
    for (size_t r = 0; r < rays.size(); ++r) out[starts[r].first] = starts[r].second - static_cast<double>(colors[r].depth_median);
    rays.clear();
    starts.clear();
  };
  for (size_t i = 0; i < places.size(); ++i) {
    out[i] = std::numeric_limits<double>::quiet_NaN();
    if (!places[i].allFinite() || (frame == Frame::kWgs84 && std::abs(places[i].y()) > 90.0)) continue;
    const gis::MapProjection::VerticalLine line = projection.VerticalLineAt(places_.EastingNorthing(frame, places[i]));
    const std::optional<products::RayDown> down = products::RayDownFrom(info(), line, projection.start_height_m(), 0.0, column_m);
    if (!down) continue;
    rays.push_back(down->ray);
    starts.emplace_back(i, down->start_height_m);
    if (rays.size() == kRaysAtATime) flush();
  }
  flush();
}

void OpenScene::ToEnu(Frame from, std::span<const Eigen::Vector3d> in, std::span<Eigen::Vector3d> out) {
  const auto lock = Enter();
  places_.ToEnu(from, in, out, session_.threads());
}

void OpenScene::FromEnu(Frame to, std::span<const Eigen::Vector3d> in, std::span<Eigen::Vector3d> out) {
  const auto lock = Enter();
  places_.FromEnu(to, in, out, session_.threads());
}

std::vector<products::View> OpenScene::Path(const std::string& text, const std::filesystem::path& file, int width, int height) {
  return products::ParseCameraPath(text, file, info(), width, height);
}

}  // namespace skyquilt::python
