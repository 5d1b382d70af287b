#include "products/height_shift.h"

#include <algorithm>

#include "core/base/errors.h"

namespace skyquilt::products {
namespace {

constexpr double kSpacing_m = 50.0;

// Bilinear between the corners of a cell of nodes, also across the date line.
geo::Geodetic Between(const geo::Geodetic* above, const geo::Geodetic* below, double u, double v) {
  const auto blend = [&](const auto& value) {
    return (1.0 - v) * ((1.0 - u) * value(above[0]) + u * value(above[1])) + v * ((1.0 - u) * value(below[0]) + u * value(below[1]));
  };
  const double west_deg = above[0].longitude_deg;
  const double latitude_deg = blend([](const geo::Geodetic& node) { return node.latitude_deg; });
  const double east_deg = blend([&](const geo::Geodetic& node) { return geo::WrapLongitudeDeg(node.longitude_deg - west_deg); });
  return {latitude_deg, geo::WrapLongitudeDeg(west_deg + east_deg), 0.0};
}

}  // namespace

HeightShift::HeightShift(const scene::MapHeights& heights, const gis::MapGrid& grid) : heights_(heights), grid_(grid) {
  step_ = static_cast<int>(std::clamp(kSpacing_m / grid.resolution_m, 1.0, static_cast<double>(std::max({grid.width, grid.height, 1}))));
  columns_ = (grid.width - 1) / step_ + 2;
}

void HeightShift::AddTo(int first_row, float no_data, std::span<float> height_m) {
  if (heights_.undulations() == 0) return;
  const auto width = static_cast<size_t>(grid_.width);
  SKYQUILT_CHECK(height_m.size() % width == 0, std::to_string(height_m.size()));
  for (size_t row = 0; row < height_m.size() / width; ++row) {
    const int y = first_row + static_cast<int>(row);
    const std::vector<geo::Geodetic>& above = NodesOf(y / step_);
    const std::vector<geo::Geodetic>& below = NodesOf(y / step_ + 1);
    const double v = static_cast<double>(y % step_) / step_;
    for (int x = 0; x < grid_.width; ++x) {
      float& height = height_m[row * width + static_cast<size_t>(x)];
      if (height == no_data) continue;
      const auto i = static_cast<size_t>(x / step_);
      const double u = static_cast<double>(x % step_) / step_;
      geo::Geodetic place = Between(above.data() + i, below.data() + i, u, v);
      place.height_m = static_cast<double>(height);
      height = static_cast<float>(heights_.FromSurvey(place));
    }
  }
}

const std::vector<geo::Geodetic>& HeightShift::NodesOf(int node_row) {
  std::vector<geo::Geodetic>& nodes = nodes_[node_row];
  if (nodes.empty()) {
    nodes_.erase(nodes_.begin(), nodes_.lower_bound(node_row - 1));
    for (int i = 0; i < columns_; ++i) {
      const Eigen::Vector2d at = grid_.CellCentre(static_cast<double>(i) * step_, static_cast<double>(node_row) * step_);
      nodes.push_back(geo::GeodeticFromUtm(at, 0.0, grid_.zone));
    }
  }
  return nodes;
}

}  // namespace skyquilt::products
