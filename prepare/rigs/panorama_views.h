// Which pinhole views a panorama is cut into.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "core/survey/exif.h"
#include "prepare/rigs/rig_config.h"

namespace skyquilt::prepare::rigs {

struct PanoramaView {
  std::string prefix;                                                 // of the names of its photos: "pano_view00/"
  double yaw_deg = 0.0;                                               // to the right of the panorama's middle
  double pitch_deg = 0.0;                                             // up from its horizon
  Eigen::Quaterniond cam_from_pano = Eigen::Quaterniond::Identity();  // frames: x right, y down, z forward, and core/camera/equirectangular.h
};

// Rings of `per_ring` views around the panorama, one at each of these pitches, the first ones nearest to the horizon; straight up and straight down
// is one view. Rings above the horizon are turned by half of a step, so that their views cover where those of the others meet. per_ring >= 1, pitches
// in
// [-90, 90].
std::vector<PanoramaView> LayOutViews(int per_ring, std::vector<double> pitches_deg);

// Pixels of a square view of that angle, and its focal length in pixels. The width in whose middle it has as many pixels per degree as a panorama of
// `pano_width` pixels on its horizon, even.
double ViewFocal(int width, double fov_deg);
int WidthAsSharp(int pano_width, double fov_deg);

// The rig, whose reference is the first view.
Rig RigOf(const std::vector<PanoramaView>& views);

// The tags of a photo of this view: time, place and exposure are the panorama's, gimbal angles follow from its heading, pitch and roll (without any
// of these there are none), lens and size are the view's.
survey::PhotoTags TagsOfView(const survey::PhotoTags& panorama, const PanoramaView& view, int width, double focal_px);

// Yaw (clockwise from north), pitch and roll (right side down) in degrees of a camera's rotation cam_from_enu, as poses::RotationFromAngles takes
// them.
struct Angles {
  double yaw_deg = 0.0, pitch_deg = 0.0, roll_deg = 0.0;
};
Angles AnglesOf(const Eigen::Quaterniond& cam_from_enu);

}  // namespace skyquilt::prepare::rigs
