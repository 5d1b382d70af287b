#include "partition/altitude.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/errors.h"
#include "core/base/order_statistics.h"
#include "core/survey/seen_distance.h"

namespace skyquilt::partition {

std::vector<PhotoAltitude> TrainingAltitudes(const survey::Survey& survey, const Eigen::Vector2d& centre, double ground_m) {
  std::vector<PhotoAltitude> altitudes;
  altitudes.reserve(survey.photos.size());
  const std::vector<std::optional<survey::SeenDistance>> seen = survey::DistancesOfLevelPhotos(survey);
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    const survey::Photo& photo = survey.photos[i];
    if (photo.is_test) continue;
    const Eigen::Vector3d eye = photo.cam_from_enu.OriginInSource();
    double agl = seen[i] ? seen[i]->median_m : photo.agl_m;
    if (!std::isfinite(agl) || agl <= 0.0) agl = eye.z() - ground_m;
    if (agl <= 0.0) agl = std::max(1e-3, (eye - Eigen::Vector3d(centre.x(), centre.y(), ground_m)).norm());
    altitudes.push_back({eye.head<2>(), agl});
  }
  return altitudes;
}

double BlockAltitude(const std::vector<PhotoAltitude>& photos, const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  SKYQUILT_CHECK(!photos.empty(), "a block's altitude is that of photos");
  std::vector<double> above;
  std::vector<std::pair<double, double>> by_distance;
  for (const PhotoAltitude& photo : photos) {
    const Eigen::Vector2d outside = (low - photo.eye_enu).cwiseMax(photo.eye_enu - high).cwiseMax(0.0);
    if (outside.isZero(0.0)) above.push_back(photo.agl_m);
    by_distance.emplace_back(outside.norm(), photo.agl_m);
  }
  if (above.size() >= 2) return base::Median(std::move(above));
  constexpr size_t kNearest = 5;
  const size_t n = std::min(kNearest, by_distance.size());
  std::partial_sort(by_distance.begin(), by_distance.begin() + static_cast<std::ptrdiff_t>(n), by_distance.end());
  std::vector<double> nearest;
  for (size_t i = 0; i < n; ++i) nearest.push_back(by_distance[i].second);
  return base::Median(std::move(nearest));
}

std::string AltitudeDoubt(const Block& block) {
  constexpr double kMuch = 2.0;
  if (!(block.flown_agl_m > 0.0) || !(block.altitude_agl_m > 0.0)) return "";
  const double ratio = block.altitude_agl_m / block.flown_agl_m;
  if (ratio >= 1.0 / kMuch && ratio <= kMuch) return "";
  const std::string said =
      fmt::format("its height is given as {:.3g} m above ground, but its photos were taken from {:.3g} m", block.altitude_agl_m, block.flown_agl_m);
  if (ratio < 1.0) return said + ": voxels are as fine as the photos' pixels, not finer";
  return said + ": voxels are coarser than the photos' pixels, and detail is lost";
}

}  // namespace skyquilt::partition
