#include "bench/poses/judge_poses.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "core/base/order_statistics.h"
#include "core/geo/robust_similarity.h"

namespace skyquilt::bench {

PoseScore JudgePoses(const TrueSet& truth, const survey::ColmapModel& model) {
  std::map<std::string, const TruePhoto*> by_name;
  for (const TruePhoto& photo : truth.photos) by_name.emplace(photo.name, &photo);
  PoseScore score;
  score.n_photos = truth.CountOurs();
  std::vector<const survey::ColmapImage*> found;
  std::vector<const TruePhoto*> wanted;
  std::vector<Eigen::Vector3d> centres, true_centres;
  for (const survey::ColmapImage& image : model.images) {
    const auto photo = by_name.find(image.name);
    if (photo == by_name.end()) continue;
    if (photo->second->intruder) {
      ++score.intruders;
      continue;
    }
    found.push_back(&image);
    wanted.push_back(photo->second);
    centres.push_back(image.cam_from_world.OriginInSource());
    true_centres.push_back(photo->second->cam_from_enu.OriginInSource());
    const double relative = std::abs(model.cameras.at(image.camera_id).FocalX() / photo->second->focal_px - 1.0);
    score.focal_error = std::isnan(score.focal_error) ? relative : std::max(score.focal_error, relative);
  }
  score.registered = found.size();
  const double limit_m = kRightPosition * truth.height_m;
  const geo::RobustSimilarityFit fit = geo::FitSimilarityRobustly(centres, true_centres, {.inlier_threshold_m = limit_m});
  if (!fit.ok) {
    score.problem = fit.reason;
    return score;
  }
  std::vector<double> off_m, off_deg;
  for (size_t i = 0; i < found.size(); ++i) {
    const geo::Rigid3d cam_from_enu = geo::TransformCameraWorld(found[i]->cam_from_world, fit.b_from_a);
    off_m.push_back(fit.residual_m[i]);
    off_deg.push_back(cam_from_enu.rotation.angularDistance(wanted[i]->cam_from_enu.rotation) * 180.0 / std::numbers::pi);
    score.right += off_m.back() < limit_m && off_deg.back() < kRightRotation_deg ? 1 : 0;
  }
  score.position_m = base::Median(std::move(off_m));
  score.rotation_deg = base::Median(std::move(off_deg));
  return score;
}

}  // namespace skyquilt::bench
