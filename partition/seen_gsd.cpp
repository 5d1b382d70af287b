#include "partition/seen_gsd.h"

#include <limits>
#include <utility>

#include "core/base/order_statistics.h"
#include "core/survey/seen_distance.h"
#include "partition/capacity.h"

namespace skyquilt::partition {

std::vector<SeenPoint> SeenPoints(const survey::Survey& survey, int image_width) {
  std::vector<SeenPoint> points;
  if (survey.tracks.points() != survey.points.size()) return points;
  std::vector<double> per_metre;
  for (const camera::Camera& camera : survey.cameras) per_metre.push_back(TrainingGsd(camera, 1.0, image_width));
  std::vector<double> gsds;
  for (size_t i = 0; i < survey.points.size(); ++i) {
    const Eigen::Vector3d& x = survey.points[i].x_in_enu;
    if (!x.allFinite()) continue;
    gsds.clear();
    for (const int32_t index : survey.tracks.PhotosOf(i)) {
      const survey::Photo& photo = survey.photos.at(static_cast<size_t>(index));
      if (photo.is_test) continue;
      const auto camera = static_cast<size_t>(photo.camera);
      const double distance_m = survey::ViewingDistance(survey.cameras.at(camera), photo.cam_from_enu, x);
      if (distance_m > 0.0) gsds.push_back(distance_m * per_metre[camera]);
    }
    if (gsds.size() >= 2) points.push_back({x.head<2>(), base::Median(gsds)});
  }
  return points;
}

std::vector<double> SeenGsds(const std::vector<SeenPoint>& points, const BlockGrid& grid) {
  std::vector<std::vector<double>> inside(static_cast<size_t>(grid.rows()) * static_cast<size_t>(grid.columns()));
  for (const SeenPoint& point : points) {
    const int cell = grid.CellOf(point.x_enu.x(), point.x_enu.y());
    if (cell >= 0) inside[static_cast<size_t>(cell)].push_back(point.gsd_m);
  }
  std::vector<double> gsds;
  gsds.reserve(inside.size());
  for (std::vector<double>& values : inside) {
    const bool enough = values.size() >= survey::kFewestSeenPoints;
    gsds.push_back(enough ? base::Median(std::move(values)) : std::numeric_limits<double>::quiet_NaN());
  }
  return gsds;
}

}  // namespace skyquilt::partition
