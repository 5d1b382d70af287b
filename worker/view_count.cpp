#include "worker/view_count.h"

#include "core/camera/photo_visibility.h"

namespace skyquilt::worker {

int CountViews(const RaySource& source, const survey::Survey& survey, const std::vector<int>& photos, const Eigen::Vector3d& x_in_enu,
               double radius_m, int enough) {
  int views = 0;
  for (const int photo : photos) {
    if (views >= enough) break;
    if (survey.photos[static_cast<size_t>(photo)].is_test) continue;
    const geo::Rigid3d& cam_from_enu = survey.photos[static_cast<size_t>(photo)].cam_from_enu;
    if (camera::IsVisible(source.CameraOf(photo), cam_from_enu, x_in_enu, {.radius_m = radius_m})) ++views;
  }
  return views;
}

std::vector<Tile> TilesWithEnoughViews(const RaySource& source, const survey::Survey& survey, const std::vector<int>& photos,
                                       const scene::HeightMap& surface, int min_views) {
  std::vector<Tile> all = TrainingTiles(survey, photos);
  if (surface.Empty() || min_views < 2) return all;
  std::vector<Tile> kept;
  for (const Tile& tile : all) {
    Eigen::Vector3d origin, direction, x;
    source.RayThrough(tile.photo, source.TileCentre(tile), &origin, &direction);
    if (!surface.Intersect(origin, direction, &x) || CountViews(source, survey, photos, x, 0.0, min_views) >= min_views) kept.push_back(tile);
  }
  return kept.empty() ? all : kept;
}

}  // namespace skyquilt::worker
