// Which places of a true surface training photos see, with what hides them.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/geo/block_box.h"
#include "core/raytrace/traced_scene.h"
#include "evaluate/photos/coverage.h"
#include "evaluate/surface/true_surface.h"

namespace skyquilt::evaluate::surface {

class SeenSurface {
 public:
  // training: the same views as in `views`. All must outlive it.
  SeenSurface(const TrueSurface& truth, std::span<const photos::TrainingView> training, const photos::TrainingViews& views,
              std::span<const geo::BlockBox> boxes);

  // Whether the place is in a box (seen from above) and at least two training photos see it: it is in their frame and not masked, its outer side
  // faces them, and nothing of the true surface is in between. point: survey ENU, on a triangle with this normal.
  bool Sees(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;

  const raytrace::TracedScene& traced() const { return traced_; }  // the true surface, relative to TrueSurface::middle

 private:
  static constexpr int kCells = 24;  // per side
  size_t CellAt(const Eigen::Vector3d& point) const;

  const TrueSurface& truth_;
  const photos::TrainingViews& views_;
  const std::span<const geo::BlockBox> boxes_;
  const raytrace::TracedScene traced_;
  std::vector<Eigen::Vector3d> centre_;  // of the views' cameras
  // Cells over the boxes, seen from above. Per cell the views, the nearest to its middle first: they most likely see a place, so the search ends
  // soon.
  Eigen::Vector2d low_ = Eigen::Vector2d::Zero(), cell_m_ = Eigen::Vector2d::Ones();
  std::vector<std::vector<int>> order_;
};

}  // namespace skyquilt::evaluate::surface
