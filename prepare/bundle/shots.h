// Photos that the cameras of a rig took at once: their poses follow from that of the rig, x_in_cam = cam_from_rig * (rig_from_enu * (x - centre)).
// The views that a panorama is cut into are such photos, too, with one centre.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "prepare/bundle/bundle_problem.h"

namespace skyquilt::prepare::bundle {

struct RigPose {
  Eigen::Quaterniond rig_from_enu = Eigen::Quaterniond::Identity();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of the rig, ENU metres
};

struct Shot {
  std::vector<uint32_t> photos;  // placed ones, ascending; at least one
  RigPose pose;
};

// The shots that have placed photos, in the order of their first ones. Where these contradict each other the pose is that of the largest part that
// agrees within kShotAngle_deg.
std::vector<Shot> PlacedShots(const BundleProblem& bundle);
constexpr double kShotAngle_deg = 5.0;

// Gives the photo the pose that it has on a rig with this one.
void PlaceByRig(const RigPose& pose, BundlePhoto& photo);
// Gives all photos of shots that have placed photos their poses on the rig. Returns how many had none.
size_t PlaceShots(BundleProblem& bundle);

// The photo, or what the tags of a shot's first tagged photo say of the rig: a position is taken for that of the rig.
BundlePhoto TagsOfPose(const BundleProblem& bundle, const std::vector<Shot>& shots, uint32_t photo);

// Metres of the rigs over units of the bundle, by the distances between the placed cameras of each shot (median). 1 when no rig has cameras that are
// apart, or none with two placed.
double RigScale(const BundleProblem& bundle);

}  // namespace skyquilt::prepare::bundle
