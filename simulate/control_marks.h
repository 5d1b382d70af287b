// What a surveyor and a person at a screen would make of the targets: surveyed coordinates, and marks on photos, with the errors asked for.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/camera/camera.h"
#include "simulate/control_targets.h"
#include "simulate/flight.h"
#include "simulate/simulate_options.h"

namespace skyquilt::simulate {

struct TargetMark {
  uint32_t photo = 0;                                    // index
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();       // as marked; the centre of the top-left pixel is (0.5, 0.5)
  Eigen::Vector2d true_pixel = Eigen::Vector2d::Zero();  // projection of the target's centre
  bool wrong = false;                                    // far from the target
};

struct SurveyedTarget {
  ControlTarget target;
  Eigen::Vector3d given = Eigen::Vector3d::Zero();  // ENU metres; the true position, except for wrong points
  bool wrong = false;
  std::vector<TargetMark> marks;  // in order of the photos
};

// Marks of at most options.control_marks photos per target, evenly chosen from those that see it, with control_mark_noise_px. Some of the control
// points are wrong by control_wrong_m in a random direction in space (control_wrong_points), and marks of others by 3 to 8 % of the photo's width
// (control_wrong_marks, as few per point as possible). Check points are never wrong.
std::vector<SurveyedTarget> SurveyTargets(std::vector<ControlTarget> targets, const SimulateOptions& options, const camera::Camera& camera,
                                          const std::vector<PhotoPlan>& photos, uint32_t seed);

}  // namespace skyquilt::simulate
