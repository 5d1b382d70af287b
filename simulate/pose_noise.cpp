#include "simulate/pose_noise.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/errors.h"
#include "core/base/order_statistics.h"
#include "core/base/random.h"
#include "core/geo/pose_gauge.h"

namespace skyquilt::simulate {

namespace {

// Median height of the cameras above the points, at least a metre: about the distance of what they see.
double HeightOfFlight(const survey::ColmapModel& model) {
  std::vector<double> cameras, points;
  for (const survey::ColmapImage& image : model.images) cameras.push_back(image.cam_from_world.OriginInSource().z());
  for (const survey::ColmapPoint& point : model.points) points.push_back(point.x_in_world.z());
  if (points.empty()) points.push_back(0.0);
  return std::max(1.0, base::Median(cameras) - base::Median(points));
}

}  // namespace

void AddPoseNoise(double rms_deg, double rms_m, uint32_t seed, const std::vector<PhotoPlan>& photos, survey::ColmapModel& model) {
  SKYQUILT_CHECK(photos.size() == model.images.size(), "one image per photo");
  if (rms_deg == 0.0 && rms_m == 0.0) return;
  constexpr uint64_t kStream = 83;
  base::Random random(seed, kStream);
  const auto error = [&random](double rms) {
    Eigen::Vector3d e;
    for (double& number : e) number = random.Normal();
    return Eigen::Vector3d(rms / std::sqrt(3.0) * e);
  };
  std::vector<geo::Rigid3d> given, changed;
  std::vector<double> weights;
  for (size_t i = 0; i < photos.size(); ++i) {
    const geo::Rigid3d enu_from_cam = model.images[i].cam_from_world.Inverse();
    const Eigen::Vector3d turn = error(rms_deg * std::numbers::pi / 180.0), shift = error(rms_m);
    given.push_back(enu_from_cam);
    changed.push_back({enu_from_cam.rotation * geo::RotationOfVector(turn), enu_from_cam.translation + shift});
    weights.push_back(photos[i].true_depth ? 0.0 : 1.0);
  }
  geo::RemoveSimilarity(given, weights, HeightOfFlight(model), changed);
  for (size_t i = 0; i < photos.size(); ++i) {
    if (!photos[i].true_depth) model.images[i].cam_from_world = changed[i].Inverse();
  }
}

}  // namespace skyquilt::simulate
