// Chooses where the ground control of a simulated survey lies: on open level ground, spread over the area, seen by several photos.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "simulate/flight.h"
#include "simulate/place_spec.h"
#include "simulate/target_paint.h"
#include "simulate/target_places.h"
#include "simulate/world.h"

namespace skyquilt::simulate {

struct ControlTarget {
  std::string label;                                   // "gcp1", "gcp2", ... and "check1", ...
  bool check = false;                                  // not for making the survey, only to compare it with
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // of the centre, on the ground; ENU metres
  double side_m = 1.0;                                 // about eight pixels of the photos that see it
  double yaw_rad = 0.0;                                // counter-clockwise from east
  std::vector<uint32_t> photos;                        // that see the centre; indices, ascending
};

// Each target is the candidate that is farthest from those chosen before it; control and check points take turns, so that both spread over the area.
// Fewer than asked for where there is no room. The same result for any number of threads.
std::vector<ControlTarget> ChooseTargets(const World& world, const PlaceSpec& place, const std::vector<PhotoPlan>& photos, int n_control, int n_check,
                                         base::ThreadPool& threads);
// What to paint on the ground for them.
std::vector<PaintedTarget> PaintOf(const std::vector<ControlTarget>& targets);

}  // namespace skyquilt::simulate
