// A made flight whose poses have been found, with control points and marks on its photos.
#pragma once

#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/survey/colmap_model.h"
#include "prepare/control/fit/fit_control.h"
#include "prepare/control/reading/control_points.h"
#include "prepare/input/prepared_photo.h"
#include "tests/prepare/poses/seed/made_survey.h"

namespace skyquilt::test {

struct ControlPlan {
  SurveyPlan survey = {.gimbal_tags = false};
  int control = 10, check = 10;                               // points; control ones come first
  int marks = 5;                                              // of each point
  double mark_noise_px = 0.4;                                 // of the marks
  double horizontal_sigma_m = 0.01, vertical_sigma_m = 0.02;  // stated
  double given_noise = 1.0;                                   // of the coordinates, in stated sigmas
  bool own_frame = false;                                     // the model is turned, shifted and scaled
  Eigen::Vector3d tag_shift_m = Eigen::Vector3d::Zero();
  bool tags = true;
  uint64_t seed = 1;
};

struct MadeControl {
  survey::ColmapModel model;
  survey::ColmapObservations observations;
  std::vector<prepare::input::PreparedPhoto> photos;
  prepare::control::ControlPoints control;
  std::vector<geo::Rigid3d> true_poses;  // of the model's images, likewise
  double true_focal_px = 0.0;

  prepare::control::ControlJob Job() { return {.model = model, .observations = observations, .photos = photos, .control = control}; }
};

inline const geo::Geodetic kMadeOrigin = {47.3, 8.5, 500.0};

MadeControl MakeControl(const ControlPlan& plan, base::ThreadPool& threads);
// Moves a point's coordinates by so many metres east, north and up.
void Displace(prepare::control::ControlPoint& point, const Eigen::Vector3d& by_m);

}  // namespace skyquilt::test
