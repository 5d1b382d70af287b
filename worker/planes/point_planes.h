// Planes in the sparse points of structure from motion: roofs, walls and pieces of ground, for a loss that pulls a field's surface onto them.
// Points kept from training (Survey::kept_points) are never used. Frame: survey ENU, metres.
//
// A plane has at least kFewestRegionPoints points whose rms distance is below kLargestPlaneRms_gsd ground sampling distances
// (worker/planes/plane_growth.h).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/geo/block_box.h"
#include "core/survey/survey.h"
#include "worker/planes/plane_support.h"

namespace skyquilt::worker {

struct PointPlane {
  Eigen::Vector3d point, normal;  // normal: unit, upward or horizontal; the side of a wall on which the air is, is not known
  double rms_m = 0.0;             // of the distances of its points, noise that lies outside the plane's band included
  int points = 0;                 // within the band, that is, those it was fitted to
};

// Constant after construction, so any number of threads may ask.
class PointPlanes {
 public:
  PointPlanes() = default;  // empty
  // Planes of the survey's points in the plan of a field's box with its margin. gsd_m: ground sampling distance there; none are found unless it is
  // above 0. Points with an error above kLargestPointError_px (worker/rays/depth_points.h) are not used.
  PointPlanes(const survey::Survey& survey, const geo::BlockBox& box, double gsd_m);

  bool Empty() const { return planes_.empty(); }
  const std::vector<PointPlane>& planes() const { return planes_; }

  // The plane that a surface point near x belongs to: the nearest that is not farther than reach_m and in whose support the foot of the perpendicular
  // from x lies. Null when there is none, and when it is ambiguous: another such plane's foot is more than reach_m from the foot on the nearest. So
  // pieces of a gentle slope that overlap are not ambiguous where they meet, but two floors a step apart are.
  const PointPlane* At(const Eigen::Vector3d& x_in_enu, double reach_m) const;

 private:
  // each(index, foot of the perpendicular, squared distance); the same plane may come several times.
  template <typename Each>
  void ForEachFit(const Eigen::Vector3d& x, double reach_m, const Each& each) const;

  std::vector<PointPlane> planes_;
  std::vector<PlaneSupport> supports_;  // of planes_
  double cell_m_ = 1.0;
  std::unordered_map<uint64_t, std::vector<int32_t>> in_cell_;  // planes whose support touches a cube of space, ascending
};

}  // namespace skyquilt::worker
