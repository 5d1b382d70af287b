#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "buildings/pictures/building_pictures.h"
#include "buildings/pictures/model_view.h"
#include "core/camera/photo_visibility.h"

namespace skyquilt::buildings {
namespace {

constexpr double kFewest = 0.5;   // share of the building that must be in the photo
constexpr double kMargin = 0.15;  // around the building, of the longer side of its box in the photo
constexpr double kLeastMargin_px = 24.0;

struct Outline {
  Eigen::AlignedBox2d box;  // of the pixels that exist
  double share_inside = 0.0;
};

Outline OutlineIn(const std::vector<Eigen::Vector3d>& places, const camera::Camera& camera, const geo::Rigid3d& cam_from_enu) {
  Outline outline;
  const Eigen::AlignedBox2d frame(Eigen::Vector2d::Zero(), Eigen::Vector2d(camera.width, camera.height));
  size_t inside = 0;
  for (const Eigen::Vector3d& x : places) {
    const auto pixel = camera.ImgFromCam(cam_from_enu * x);
    if (!pixel) continue;
    outline.box.extend(*pixel);
    if (frame.contains(*pixel)) ++inside;
  }
  if (!places.empty()) outline.share_inside = static_cast<double>(inside) / static_cast<double>(places.size());
  return outline;
}

// Greater is better. A cut building loses more than any distance from the middle or a steep view can.
double ScoreOf(const Outline& outline, const camera::Camera& camera, const geo::Rigid3d& cam_from_enu, const Eigen::Vector3d& middle) {
  const Eigen::Vector2d frame(camera.width, camera.height);
  const double off_middle = std::min(1.0, (outline.box.center() - 0.5 * frame).norm() / (0.5 * frame.norm()));
  const double size = std::min(1.0, outline.box.diagonal().norm() / frame.norm());
  // The angle of the view below the horizon: at 45 degrees both walls and roof are seen.
  const Eigen::Vector3d view = (middle - cam_from_enu.OriginInSource()).normalized();
  const double oblique = std::sin(2.0 * std::acos(std::clamp(-view.z(), -1.0, 1.0)));
  return std::pow(outline.share_inside, 6.0) * (1.0 - 0.5 * off_middle) * std::sqrt(size) * (0.6 + 0.4 * std::max(0.0, oblique));
}

}  // namespace

std::optional<int> BestPhoto(const Building& building, const survey::Survey& survey) {
  const Solid& solid = ModelOf(building);
  if (solid.Empty()) return std::nullopt;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& x : solid.vertex) box.extend(x);
  const camera::VisibilityRule touches{.radius_m = 0.5 * box.diagonal().norm()};
  const std::vector<Eigen::Vector3d> places = PlacesOnEdges(solid);
  std::optional<int> best;
  double best_score = 0.0;
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    const survey::Photo& photo = survey.photos[i];
    const camera::Camera& camera = survey.cameras[static_cast<size_t>(photo.camera)];
    if (!camera::IsVisible(camera, photo.cam_from_enu, box.center(), touches)) continue;
    const Outline outline = OutlineIn(places, camera, photo.cam_from_enu);
    if (outline.share_inside < kFewest) continue;
    const double score = ScoreOf(outline, camera, photo.cam_from_enu, box.center());
    if (score <= best_score) continue;
    best_score = score;
    best = static_cast<int>(i);
  }
  return best;
}

PhotoPart PartAround(const Building& building, const camera::Camera& camera, const geo::Rigid3d& cam_from_enu) {
  const Outline outline = OutlineIn(PlacesOnEdges(ModelOf(building)), camera, cam_from_enu);
  if (outline.box.isEmpty()) return {};
  const double margin = std::max(kLeastMargin_px, kMargin * outline.box.sizes().maxCoeff());
  const Eigen::Vector2d frame(camera.width, camera.height);
  const Eigen::Vector2d low = (outline.box.min().array() - margin).floor().matrix().cwiseMax(0.0).cwiseMin(frame);
  const Eigen::Vector2d high = (outline.box.max().array() + margin).ceil().matrix().cwiseMax(0.0).cwiseMin(frame);
  const Eigen::Vector2d size = high - low;
  if (!(size.minCoeff() > 0.0)) return {};
  return {static_cast<int>(low.x()), static_cast<int>(low.y()), static_cast<int>(size.x()), static_cast<int>(size.y())};
}

}  // namespace skyquilt::buildings
