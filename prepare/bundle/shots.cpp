#include "prepare/bundle/shots.h"

#include <algorithm>
#include <array>
#include <map>
#include <numbers>

#include "core/base/order_statistics.h"

namespace skyquilt::prepare::bundle {
namespace {

constexpr double kLeastArm_m = 1e-3;

// The rig's pose by one of its photos.
RigPose PoseByPhoto(const BundlePhoto& photo) {
  RigPose pose;
  pose.rig_from_enu = (photo.cam_from_rig.rotation.conjugate() * photo.cam_from_enu).normalized();
  pose.centre = photo.centre - pose.rig_from_enu.conjugate() * photo.cam_from_rig.OriginInSource();
  return pose;
}

RigPose MeanPose(const std::vector<RigPose>& poses) {
  constexpr double kMostApart = kShotAngle_deg * std::numbers::pi / 180.0;
  const auto agree = [&](const RigPose& a, const RigPose& b) { return a.rig_from_enu.angularDistance(b.rig_from_enu) <= kMostApart; };
  const auto n_agreeing = [&](const RigPose& pose) {
    return std::count_if(poses.begin(), poses.end(), [&](const RigPose& other) { return agree(pose, other); });
  };
  const RigPose& middle =
      *std::max_element(poses.begin(), poses.end(), [&](const RigPose& a, const RigPose& b) { return n_agreeing(a) < n_agreeing(b); });
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  std::array<std::vector<double>, 3> centres;
  for (const RigPose& pose : poses) {
    if (!agree(middle, pose)) continue;
    // q and -q are the same rotation.
    const Eigen::Vector4d numbers = pose.rig_from_enu.coeffs();
    sum += numbers.dot(middle.rig_from_enu.coeffs()) < 0.0 ? Eigen::Vector4d(-numbers) : numbers;
    for (size_t axis = 0; axis < centres.size(); ++axis) centres[axis].push_back(pose.centre[static_cast<Eigen::Index>(axis)]);
  }
  return {Eigen::Quaterniond(sum).normalized(), {base::Median(centres[0]), base::Median(centres[1]), base::Median(centres[2])}};
}

std::map<int, std::vector<uint32_t>> PhotosByShot(const BundleProblem& bundle) {
  std::map<int, std::vector<uint32_t>> photos;
  for (uint32_t i = 0; i < bundle.photos.size(); ++i) {
    if (bundle.photos[i].shot >= 0 && bundle.photos[i].placed) photos[bundle.photos[i].shot].push_back(i);
  }
  return photos;
}

}  // namespace

std::vector<Shot> PlacedShots(const BundleProblem& bundle) {
  std::vector<Shot> shots;
  for (auto& [number, photos] : PhotosByShot(bundle)) {
    std::vector<RigPose> poses;
    for (const uint32_t photo : photos) poses.push_back(PoseByPhoto(bundle.photos[photo]));
    shots.push_back({std::move(photos), MeanPose(poses)});
  }
  std::sort(shots.begin(), shots.end(), [](const Shot& a, const Shot& b) { return a.photos.front() < b.photos.front(); });
  return shots;
}

void PlaceByRig(const RigPose& pose, BundlePhoto& photo) {
  photo.cam_from_enu = (photo.cam_from_rig.rotation * pose.rig_from_enu).normalized();
  photo.centre = pose.centre + pose.rig_from_enu.conjugate() * photo.cam_from_rig.OriginInSource();
  photo.placed = true;
}

size_t PlaceShots(BundleProblem& bundle) {
  std::map<int, RigPose> poses;
  for (const Shot& shot : PlacedShots(bundle)) poses.emplace(bundle.photos[shot.photos.front()].shot, shot.pose);
  size_t n_new = 0;
  for (BundlePhoto& photo : bundle.photos) {
    const auto pose = poses.find(photo.shot);
    if (photo.shot < 0 || pose == poses.end()) continue;
    n_new += photo.placed ? 0 : 1;
    PlaceByRig(pose->second, photo);
  }
  return n_new;
}

BundlePhoto TagsOfPose(const BundleProblem& bundle, const std::vector<Shot>& shots, uint32_t photo) {
  if (bundle.photos[photo].shot < 0) return bundle.photos[photo];
  const auto shot = std::lower_bound(shots.begin(), shots.end(), photo, [](const Shot& one, uint32_t first) { return one.photos.front() < first; });
  BundlePhoto tags;
  for (const uint32_t one : shot->photos) {
    const BundlePhoto& view = bundle.photos[one];
    if (!tags.gps && view.gps) {
      tags.gps = view.gps;
      tags.gps_sigma = view.gps_sigma;
    }
    if (!tags.tagged_rotation && view.tagged_rotation) tags.tagged_rotation = view.cam_from_rig.rotation.conjugate() * *view.tagged_rotation;
  }
  return tags;
}

double RigScale(const BundleProblem& bundle) {
  std::vector<double> ratios;
  for (const auto& [number, photos] : PhotosByShot(bundle)) {
    for (size_t i = 0; i < photos.size(); ++i) {
      for (size_t k = i + 1; k < photos.size(); ++k) {
        const BundlePhoto &a = bundle.photos[photos[i]], &b = bundle.photos[photos[k]];
        const double arm_m = (a.cam_from_rig.OriginInSource() - b.cam_from_rig.OriginInSource()).norm();
        const double found = (a.centre - b.centre).norm();
        if (arm_m > kLeastArm_m && found > 0.0) ratios.push_back(arm_m / found);
      }
    }
  }
  return ratios.empty() ? 1.0 : base::Median(ratios);
}

}  // namespace skyquilt::prepare::bundle
