// The way of the camera from one pose to another: planned once, then asked for the pose at any time. It keeps kWayClearance_m from what is solid.
// Ends that are nearer themselves are left straight up and reached straight down. The same as web/src/tour/route.ts, so that a video shows what the
// page does; both pass web/test/unit/tour/route_cases.json.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "tour/format/tour.h"
#include "tour/ways/heights.h"

namespace skyquilt::tour {

class Route {
 public:
  // heights: null when nothing is known to be in the way.
  Route(const Pose& from, const Pose& to, const Path& path, const Heights* heights);

  double length_m() const { return length_m_; }
  double duration_s() const { return duration_s_; }  // 0: a cut
  // Before the beginning the first, after the end the last.
  Pose At(double seconds) const;

 private:
  struct Node {
    Pose pose;
    double time_s = 0.0;  // that the way to here would take without easing
  };

  Pose from_, to_;
  double length_m_ = 0.0, duration_s_ = 0.0;
  std::vector<Node> nodes_;
};

}  // namespace skyquilt::tour
