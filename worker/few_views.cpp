#include "worker/few_views.h"

namespace skyquilt::worker {

int CountViews(const RaySource& source, const survey::Survey& survey, const std::vector<int>& photos, const Eigen::Vector3d& x_in_enu,
               double radius_m, int enough) {
  int views = 0;
  for (const int photo : photos) {
    if (views >= enough) break;
    if (survey.photos[static_cast<size_t>(photo)].is_test) continue;
    const camera::Camera& camera = source.CameraOf(photo);
    const Eigen::Vector3d in_cam = survey.photos[static_cast<size_t>(photo)].cam_from_enu * x_in_enu;
    if (in_cam.z() < -radius_m || (radius_m <= 0.0 && in_cam.z() <= 0.0)) continue;
    if (in_cam.z() <= radius_m) {
      views += in_cam.norm() < 4.0 * radius_m ? 1 : 0;  // the ball surrounds the camera or nearly so
    } else if (const auto pixel = camera.ImgFromCam(in_cam)) {
      const double slack = camera.FocalX() * radius_m / in_cam.z();
      views += pixel->x() >= -slack && pixel->x() < camera.width + slack && pixel->y() >= -slack && pixel->y() < camera.height + slack ? 1 : 0;
    }
  }
  return views;
}

std::vector<Tile> TilesInCompany(const RaySource& source, const survey::Survey& survey, const std::vector<int>& photos,
                                 const scene::PlanSurface& surface, int min_views) {
  std::vector<Tile> all = TrainingTiles(survey, photos);
  if (surface.Empty() || min_views < 2) return all;
  std::vector<Tile> kept;
  for (const Tile& tile : all) {
    Eigen::Vector3d origin, direction, x;
    source.RayThrough(tile.photo, source.TileCentre(tile), &origin, &direction);
    if (!surface.Meet(origin, direction, &x) || CountViews(source, survey, photos, x, 0.0, min_views) >= min_views) kept.push_back(tile);
  }
  return kept.empty() ? all : kept;
}

}  // namespace skyquilt::worker
