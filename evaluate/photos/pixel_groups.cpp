#include "evaluate/photos/pixel_groups.h"

#include <algorithm>

namespace skyquilt::evaluate::photos {

namespace {

bool InsideGrown(const Eigen::Vector3d& x, const geo::BlockBox& box, double grow_m) {
  return x.x() >= box.min_enu.x() - grow_m && x.x() < box.max_enu.x() + grow_m && x.y() >= box.min_enu.y() - grow_m &&
         x.y() < box.max_enu.y() + grow_m;
}

}  // namespace

int BlockAt(const Eigen::Vector3d& x_in_enu, std::span<const geo::BlockBox> boxes) {
  for (size_t i = 0; i < boxes.size(); ++i) {
    if (InsideGrown(x_in_enu, boxes[i], 0.0)) return static_cast<int>(i);
  }
  return -1;
}

Zone ZoneAt(const Eigen::Vector3d& x_in_enu, int block, std::span<const geo::BlockBox> boxes) {
  if (block < 0) return Zone::kOutside;
  const auto n_holding =
      std::count_if(boxes.begin(), boxes.end(), [&](const geo::BlockBox& box) { return InsideGrown(x_in_enu, box, box.margin_m); });
  if (n_holding >= 2) return Zone::kSeam;
  const geo::BlockBox& own = boxes[static_cast<size_t>(block)];
  return InsideGrown(x_in_enu, own, -own.margin_m) ? Zone::kInterior : Zone::kRim;
}

void AddPixel(const float* a, const float* b, skyquilt::metrics::SquaredError* error) {
  for (int channel = 0; channel < 3; ++channel) {
    const double difference = static_cast<double>(a[channel]) - static_cast<double>(b[channel]);
    error->sum += difference * difference;
  }
  error->n_values += 3;
}

}  // namespace skyquilt::evaluate::photos
