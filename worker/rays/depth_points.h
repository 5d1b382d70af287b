// Training rays whose depth is known from structure from motion: pixels at which a training photo observed a sparse point, with the distance of the
// point and its uncertainty. For a loss of depth, where photos alone leave surfaces rough. Points kept from training (Survey::kept_points) are never
// among them. Frame: survey ENU, metres.
//
// The standard deviation along the ray is that of a triangulation, error_px * pixel * distance / tan(angle): error_px is the point's mean
// reprojection error, at least 0.5; pixel the angle of a pixel of the photo at full size, to which reprojection errors refer; angle the largest one
// between two rays of training photos that observed the point, at most 45 degrees, because no point is known better along a ray than across it. It is
// therefore between 0.5 and 57 widths of a pixel at the point. More observations make points more accurate than this, errors of the poses less.
// Observations in held-out photos, which tracks of surveys of older programs have, count nowhere.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/random.h"
#include "core/geo/block_box.h"
#include "core/survey/survey.h"
#include "worker/rays/ray_source.h"

namespace skyquilt::worker {

struct DepthPoint {
  int32_t photo = 0;                     // index into Survey::photos; not a held-out one
  float pixel_x = 0.0F, pixel_y = 0.0F;  // in the cached image: the projection of the point, not the feature that was matched
  float distance_m = 0.0F;               // from the camera centre along the ray
  float sigma_m = 0.0F;                  // standard deviation of the distance
};

// Points with a larger reprojection error, or whose rays meet at a smaller angle, are left out.
constexpr double kLargestPointError_px = 2.0;
constexpr double kSmallestPointAngle_deg = 2.0;

// Constant after construction, so any number of threads may draw.
class DepthPoints {
 public:
  static constexpr size_t kMost = 2'000'000;  // observations; 40 MB

  DepthPoints() = default;  // empty
  // The training photos' observations of the survey's points in the plan of a field's box with its margin, in order of point and photo. Empty without
  // tracks. Where they are more than `most` (about), a part of the points is used, chosen by a hash.
  DepthPoints(const survey::Survey& survey, const RaySource& source, const geo::BlockBox& box, size_t most = kMost);

  bool Empty() const { return points_.empty(); }
  const std::vector<DepthPoint>& points() const { return points_; }
  // One of them, all equally likely. There must be one.
  const DepthPoint& Draw(base::Random& random) const { return points_[random.Below(static_cast<uint32_t>(points_.size()))]; }

 private:
  std::vector<DepthPoint> points_;
};

// Largest angle in radians between two of the rays from these camera centres to a point; 0 for fewer than two.
double TriangulationAngle(const Eigen::Vector3d& x_in_enu, const std::vector<Eigen::Vector3d>& centres_enu);

}  // namespace skyquilt::worker
