// Coverage: a pixel of a held-out photo is scored only if at least two training photos see its surface point, because a scene cannot be expected to
// know anything else. Where photos look level, they must see it with nothing before it (training_depths.h). Frame: survey ENU, metres.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/camera/camera.h"
#include "core/geo/transform.h"
#include "core/image/image.h"

namespace skyquilt::evaluate::photos {

// Lowest and highest z of the scene's surface, metres; low <= high.
struct HeightRange {
  double low_m = 0.0;
  double high_m = 0.0;
};

// The point at `depth_m` along the ray (unit direction), moved along the ray into the height range. A NaN depth (the ray never became opaque) counts
// as infinitely far. Nothing when the ray never enters the range in front of the camera, or is level and has no depth.
std::optional<Eigen::Vector3d> SurfacePoint(const Eigen::Vector3d& origin_enu, const Eigen::Vector3d& direction_enu, double depth_m,
                                            HeightRange range);

struct TrainingView {
  camera::Camera camera;  // at the size of the mask
  geo::Rigid3d cam_from_enu;
  std::span<const uint8_t> mask;  // width * height, 0 = ignored; empty: every pixel counts
  // What hides places: metres along the ray to the scene's surface, NaN where there is none, in one channel and any size; empty: nothing does.
  image::ImageF depth_m = {};
};

class TrainingViews {
 public:
  explicit TrainingViews(std::vector<TrainingView> views);

  // Indices of the views, nearest camera to the point first. Near views most likely see a point, so Count then stops early.
  std::vector<int> ByDistance(const Eigen::Vector3d& x_in_enu) const;
  // Number of views in `order` that have the point inside their image on an unmasked pixel and not hidden; stops counting at `enough`.
  int Count(const Eigen::Vector3d& x_in_enu, std::span<const int> order, int enough) const;
  bool Sees(int view, const Eigen::Vector3d& x_in_enu) const;
  size_t size() const { return views_.size(); }

 private:
  struct Cone {
    Eigen::Vector3d apex_enu;
    double cos_limit = 1.0;  // a direction with a smaller cosine to the optical axis cannot be in the frame
    Eigen::Vector3d axis_enu;
  };
  std::vector<TrainingView> views_;
  std::vector<Cone> cones_;
};

}  // namespace skyquilt::evaluate::photos
