// Thinned pictures of depth in memory, for telling how many of them see a place.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/thread_pool.h"
#include "surface/views/depth_views.h"

namespace skyquilt::surface {

// A place on the surface that a view shows.
struct SurfaceSample {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // survey ENU, metres
  double area_m2 = 0.0;                                // of the surface that it stands for
  double cosine = 1.0;                                 // of the angle between its ray and its normal, at least 0.1
  int views = 1;                                       // that see it, the one it comes from included
  size_t view = 0;                                     // the one it comes from
};

class CoarseDepths {
 public:
  // Keeps every n-th pixel of every n-th row, with the smallest n for which `pixels` (of all views together) fit in limit_bytes.
  CoarseDepths(int64_t pixels, double limit_bytes);
  void Add(const DepthView& view);

  // How a view shows the surroundings of a place.
  struct Look {
    double behind_m = 0.0;  // how far the place is behind what is shown there; negative: in front of it
    double slack_m = 0.0;   // by so much the depth may differ between the kept pixel and the place
  };

  const std::vector<ViewPose>& poses() const { return poses_; }
  // Nothing when the place is outside the image, or no depth is known there.
  std::optional<Look> LookAtPlace(size_t view, const Eigen::Vector3d& x_in_enu) const;
  // Whether the view shows this place rather than something in front of or behind it; the distance may differ by tolerance_m.
  bool Sees(size_t view, const Eigen::Vector3d& x_in_enu, double tolerance_m) const;
  // About max_samples places or fewer, evenly from all views, with the number of views that see each. Same result for any number of threads.
  std::vector<SurfaceSample> Samples(int64_t max_samples, double tolerance_m, base::ThreadPool& threads) const;

 private:
  struct Picture {
    int width = 0, height = 0;  // in kept pixels
    std::vector<float> depth_m;
    std::vector<uint8_t> cosine;
  };
  // Image position of a kept pixel.
  double PositionOf(int index) const { return index * step_ + step_ / 2 + 0.5; }

  int step_ = 1;
  std::vector<ViewPose> poses_;
  std::vector<Picture> pictures_;  // as long as poses_
};

}  // namespace skyquilt::surface
