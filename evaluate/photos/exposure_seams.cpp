#include "evaluate/photos/exposure_seams.h"

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "evaluate/photos/choose_photos.h"

namespace skyquilt::evaluate::photos {
namespace {

constexpr int kPerSide = 256;          // sampled points along each side of a photo
constexpr double kApartPixels = 2.0;   // distance between the point inside and the point outside
constexpr double kControlPixels = 12;  // distance of the control lines from the border

struct Place {
  Eigen::Vector2d pixel, inwards;
};

// Points along the four sides, `inset` pixels inside. Not near corners, where two borders meet.
std::vector<Place> PlacesAlong(const camera::Camera& camera, double inset) {
  std::vector<Place> places;
  const Eigen::Vector2d size(camera.width, camera.height);
  for (int i = 0; i < kPerSide; ++i) {
    const double share = 0.05 + 0.9 * (i + 0.5) / kPerSide;
    places.push_back({{share * size.x(), inset}, {0.0, 1.0}});
    places.push_back({{share * size.x(), size.y() - inset}, {0.0, -1.0}});
    places.push_back({{inset, share * size.y()}, {1.0, 0.0}});
    places.push_back({{size.x() - inset, share * size.y()}, {-1.0, 0.0}});
  }
  return places;
}

// |mean over the points of brightness outside minus brightness inside|, seen from straight above. Nothing when too few points are in the scene.
std::optional<double> StepAcross(const scene::Scene& scene, const TrainingView& view, double inset, base::ThreadPool& threads) {
  const geo::Rigid3d enu_from_cam = view.cam_from_enu.Inverse();
  const std::vector<Place> places = PlacesAlong(view.camera, inset);
  std::vector<render::Ray> rays;
  for (const Place& place : places) {
    render::Ray ray;
    ray.origin_enu = enu_from_cam.translation;
    ray.direction_enu = (enu_from_cam.rotation * view.camera.RayFromImg(place.pixel)).normalized();
    rays.push_back(ray);
  }
  std::vector<render::RayColor> seen(rays.size());
  scene.RenderRays(rays, seen, {}, threads);
  const Eigen::Vector3d low = scene.info().min_enu, high = scene.info().max_enu;
  std::vector<render::Ray> down;
  for (size_t i = 0; i < rays.size(); ++i) {
    if (!std::isfinite(seen[i].depth_median)) continue;
    const Eigen::Vector3d ground = rays[i].origin_enu + static_cast<double>(seen[i].depth_median) * rays[i].direction_enu;
    // The neighbouring pixel further inside, at the same depth, gives direction and size of a pixel on the ground.
    const Eigen::Vector3d beside = enu_from_cam.rotation * view.camera.RayFromImg(places[i].pixel + places[i].inwards).normalized();
    const Eigen::Vector3d inwards = rays[i].origin_enu + static_cast<double>(seen[i].depth_median) * beside - ground;
    std::array<Eigen::Vector3d, 2> pair = {ground - 0.5 * kApartPixels * inwards, ground + 0.5 * kApartPixels * inwards};
    const auto inside_area = [&](const Eigen::Vector3d& x) { return x.x() > low.x() && x.y() > low.y() && x.x() < high.x() && x.y() < high.y(); };
    if (!inside_area(pair[0]) || !inside_area(pair[1])) continue;
    for (const Eigen::Vector3d& x : pair) {
      render::Ray ray;
      ray.origin_enu = {x.x(), x.y(), high.z() + 1.0};
      ray.direction_enu = {0.0, 0.0, -1.0};
      down.push_back(ray);
    }
  }
  std::vector<render::RayColor> colors(down.size());
  scene.RenderRays(down, colors, {}, threads);
  double sum = 0.0, n = 0.0;
  for (size_t i = 0; i + 1 < colors.size(); i += 2) {
    if (colors[i].opacity < 0.9F || colors[i + 1].opacity < 0.9F) continue;
    for (size_t c = 0; c < 3; ++c) sum += static_cast<double>(colors[i].rgb_srgb[c] - colors[i + 1].rgb_srgb[c]) / 3.0;
    n += 1.0;
  }
  if (n < kPerSide) return std::nullopt;  // less than one side of the photo is in the scene
  return std::abs(sum / n);
}

}  // namespace

ExposureSeams MeasureExposureSeams(const scene::Scene& scene, const std::vector<TrainingView>& views, base::ThreadPool& threads) {
  std::vector<double> border, control;
  for (const size_t place : EvenlySpacedIndices(views.size(), kMaxSeamPhotos)) {
    const TrainingView& view = views[place];
    const std::optional<double> across = StepAcross(scene, view, 0.5, threads), beside = StepAcross(scene, view, kControlPixels, threads);
    if (!across || !beside) continue;
    border.push_back(*across);
    control.push_back(*beside);
  }
  return {MedianOfMeasured(border), MedianOfMeasured(control), static_cast<int>(border.size())};
}

}  // namespace skyquilt::evaluate::photos
