#include "evaluate/photos/training_depths.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/cancel.h"
#include "core/base/progress.h"

namespace skyquilt::evaluate::photos {
namespace {

constexpr int kLongSide = 64;
constexpr double kSlack = 0.03;  // of the distance

camera::Camera SmallCamera(const camera::Camera& camera) {
  const double scale = static_cast<double>(kLongSide) / std::max({camera.width, camera.height, kLongSide});
  const auto side = [scale](int size) { return std::max(1, static_cast<int>(std::lround(scale * size))); };
  return camera.Resized(side(camera.width), side(camera.height));
}

}  // namespace

std::vector<TrainingView> WithDepths(std::vector<TrainingView> views, const scene::Scene& scene, base::ThreadPool& threads) {
  base::Progress progress("views of training photos", static_cast<double>(views.size()), "views");
  for (TrainingView& view : views) {
    base::ThrowIfCancelled();
    const camera::Camera camera = SmallCamera(view.camera);
    const std::vector<render::RayColor> rendered = scene.RenderCamera(camera, view.cam_from_enu, {.look = scene::Rendition::kRecorded}, threads);
    view.depth_m = image::ImageF(camera.width, camera.height, 1, std::numeric_limits<float>::quiet_NaN());
    for (size_t i = 0; i < rendered.size(); ++i) view.depth_m.data[i] = rendered[i].depth_median;
    progress.Advance();
  }
  progress.Finish();
  return views;
}

bool IsHidden(const TrainingView& view, const Eigen::Vector3d& x_in_enu) {
  if (view.depth_m.Empty()) return false;
  const Eigen::Vector3d in_cam = view.cam_from_enu * x_in_enu;
  const std::optional<Eigen::Vector2d> pixel = view.camera.ImgFromCam(in_cam);
  if (!pixel) return false;
  // The four small pixels whose middles surround the place.
  const auto first = [](double at, int size, int small) { return static_cast<int>(std::floor(at * small / size - 0.5)); };
  const int column = first(pixel->x(), view.camera.width, view.depth_m.width), row = first(pixel->y(), view.camera.height, view.depth_m.height);
  const double distance_m = in_cam.norm();
  for (int i = 0; i < 4; ++i) {
    const int x = std::clamp(column + i % 2, 0, view.depth_m.width - 1), y = std::clamp(row + i / 2, 0, view.depth_m.height - 1);
    // NaN too: that ray meets nothing.
    if (!((1.0 + kSlack) * static_cast<double>(*view.depth_m.At(x, y)) < distance_m)) return false;
  }
  return true;
}

}  // namespace skyquilt::evaluate::photos
