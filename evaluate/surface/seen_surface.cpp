#include "evaluate/surface/seen_surface.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "evaluate/photos/pixel_groups.h"

namespace skyquilt::evaluate::surface {
namespace {

constexpr int kEnoughViews = 2;
// Rays start this far from the surface, so that they do not hit the triangle that they leave. Positions have single precision.
constexpr float kClearance_m = 0.005F;

}  // namespace

SeenSurface::SeenSurface(const TrueSurface& truth, std::span<const photos::TrainingView> training, const photos::TrainingViews& views,
                         std::span<const geo::BlockBox> boxes)
    : truth_(truth), views_(views), boxes_(boxes), traced_(truth.position, truth.triangle) {
  for (const photos::TrainingView& view : training) centre_.push_back(view.cam_from_enu.OriginInSource());
  if (boxes.empty()) return;
  Eigen::Vector3d low = boxes[0].min_enu, high = boxes[0].max_enu;
  for (const geo::BlockBox& box : boxes) {
    low = low.cwiseMin(box.min_enu);
    high = high.cwiseMax(box.max_enu);
  }
  low_ = low.head<2>();
  cell_m_ = ((high - low).head<2>() / kCells).cwiseMax(1e-3);
  const double z = 0.5 * (low.z() + high.z());
  for (int row = 0; row < kCells; ++row) {
    for (int column = 0; column < kCells; ++column) {
      order_.push_back(views.ByDistance({low_.x() + (column + 0.5) * cell_m_.x(), low_.y() + (row + 0.5) * cell_m_.y(), z}));
    }
  }
}

size_t SeenSurface::CellAt(const Eigen::Vector3d& point) const {
  const auto index = [&](Eigen::Index axis) {
    return static_cast<size_t>(std::clamp((point[axis] - low_[axis]) / cell_m_[axis], 0.0, static_cast<double>(kCells - 1)));
  };
  return index(1) * kCells + index(0);
}

bool SeenSurface::Sees(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
  if (order_.empty() || photos::BlockAt(point, boxes_) < 0) return false;
  const std::vector<int>& order = order_[CellAt(point)];
  const Eigen::Vector3f start = (point - truth_.middle).cast<float>() + kClearance_m * normal.cast<float>();
  int seen = 0;
  size_t next = 0;
  // The first packet is small, because mostly the nearest photos see a place.
  for (size_t wanted = 4; next < order.size(); wanted = raytrace::kPacket) {
    raytrace::RayPacket rays{};
    size_t lanes = 0;
    for (; next < order.size() && lanes < wanted; ++next) {
      const int view = order[next];
      const Eigen::Vector3d to_camera = centre_[static_cast<size_t>(view)] - point;
      if (!(to_camera.dot(normal) > 0.0) || !views_.Sees(view, point)) continue;
      const Eigen::Vector3f way = (centre_[static_cast<size_t>(view)] - truth_.middle).cast<float>() - start;
      const float distance_m = way.norm();
      rays.Set(lanes++, start, way / std::max(distance_m, std::numeric_limits<float>::min()), 0.0F, distance_m);
    }
    if (lanes == 0) return false;
    seen += static_cast<int>(lanes) - std::popcount(traced_.Occluded(rays));
    if (seen >= kEnoughViews) return true;
  }
  return false;
}

}  // namespace skyquilt::evaluate::surface
