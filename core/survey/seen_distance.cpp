#include "core/survey/seen_distance.h"

#include <cmath>
#include <utility>

#include "core/base/order_statistics.h"

namespace skyquilt::survey {
namespace {

constexpr double kLevelSine = 0.3;
constexpr double kFarShare = 0.95;

}  // namespace

bool LooksLevel(const Photo& photo) {
  return std::abs((photo.cam_from_enu.rotation.conjugate() * Eigen::Vector3d::UnitZ()).z()) < kLevelSine;
}

double ViewingDistance(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu, const Eigen::Vector3d& x_in_enu) {
  const Eigen::Vector3d x = cam_from_enu * x_in_enu;
  return camera::IsFisheye(camera.model) ? x.norm() : x.z();
}

std::vector<std::optional<SeenDistance>> DistancesOfLevelPhotos(const Survey& survey) {
  std::vector<std::optional<SeenDistance>> seen(survey.photos.size());
  if (survey.tracks.points() != survey.points.size()) return seen;
  std::vector<char> is_wanted(survey.photos.size());
  for (size_t i = 0; i < survey.photos.size(); ++i) is_wanted[i] = !survey.photos[i].is_test && LooksLevel(survey.photos[i]) ? 1 : 0;
  std::vector<std::vector<double>> viewing(survey.photos.size()), straight(survey.photos.size());
  for (size_t i = 0; i < survey.points.size(); ++i) {
    const Eigen::Vector3d& x = survey.points[i].x_in_enu;
    if (!x.allFinite()) continue;
    for (const int32_t index : survey.tracks.PhotosOf(i)) {
      const auto p = static_cast<size_t>(index);
      if (!is_wanted[p]) continue;
      const Photo& photo = survey.photos[p];
      const double distance = ViewingDistance(survey.cameras.at(static_cast<size_t>(photo.camera)), photo.cam_from_enu, x);
      if (!(distance > 0.0)) continue;
      viewing[p].push_back(distance);
      straight[p].push_back((photo.cam_from_enu * x).norm());
    }
  }
  for (size_t i = 0; i < seen.size(); ++i) {
    if (viewing[i].size() < kFewestSeenPoints) continue;
    seen[i] = SeenDistance{base::Median(std::move(viewing[i])), base::Quantile(std::move(straight[i]), kFarShare)};
  }
  return seen;
}

}  // namespace skyquilt::survey
