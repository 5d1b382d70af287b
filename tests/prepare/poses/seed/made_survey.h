// A made flight with known poses: features with noise, matches of which some are wrong, and tags with errors.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/geo/transform.h"
#include "prepare/poses/seed/seed_input.h"

namespace skyquilt::test {

struct SurveyPlan {
  int strips = 5, per_strip = 6;
  double along_m = 18.0, across_m = 28.0, height_m = 80.0;
  double pitch_deg = -90.0;
  double relief_m = 8.0;       // of the ground, amplitude
  int points_per_photo = 350;  // about
  double pixel_noise_px = 0.5;
  double gps_noise_m = 1.5, gps_height_noise_m = 3.0;
  double angle_noise_deg = 3.0;
  double wrong_matches = 0.0;   // share of matches that are random
  double focal_error = 0.06;    // of the initial camera, relative
  double tilt_noise_deg = 2.0;  // of the true poses
  int cameras = 1;
  bool gimbal_tags = true;
  double reach_m = 75.0;   // photos nearer to each other are matched
  int chance_matches = 0;  // with each photo beyond reach_m, from nowhere
  double gap_m = 0.0;      // more than across_m between the first half of the strips and the second
  uint64_t seed = 1;
};

struct MadeSurvey {
  prepare::poses::SeedInput input;
  std::vector<geo::Rigid3d> cam_from_enu;   // truth
  std::vector<camera::Camera> cameras;      // truth, id from 1
  std::vector<Eigen::Vector3d> angles_deg;  // truth: yaw, pitch, roll
  std::vector<std::vector<int>> points;     // which point each feature of each photo shows
};

MadeSurvey MakeSurvey(const SurveyPlan& plan);

}  // namespace skyquilt::test
