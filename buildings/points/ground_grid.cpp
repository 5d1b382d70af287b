#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "buildings/points/surface_points.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/gis/read_maps.h"

namespace skyquilt::buildings {
namespace {

constexpr double kUsualCell_m = 0.5;  // as fine as the terrain is found
constexpr double kMostCells = 16e6;
constexpr double kNodeStep_m = 50.0;  // between exact conversions; the frames bend by less than 0.1 mm in between

// Heights of the map in its own coordinates, row 0 in the north.
struct MapHeights {
  Eigen::Vector2d first_centre;  // of row 0, column 0
  double cell_m = 0.0;
  image::ImageF image;

  // Bilinear over the cells that have a height; NaN when less than half of the weight is theirs.
  double At(const Eigen::Vector2d& map_xy) const {
    const double x = (map_xy.x() - first_centre.x()) / cell_m, y = (first_centre.y() - map_xy.y()) / cell_m;
    if (!(x >= -0.5 && y >= -0.5 && x <= image.width - 0.5 && y <= image.height - 0.5)) return std::numeric_limits<double>::quiet_NaN();
    const auto column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
    double sum = 0.0, weight = 0.0;
    for (int r = row; r <= row + 1; ++r) {
      for (int c = column; c <= column + 1; ++c) {
        const double w = (1.0 - std::abs(x - c)) * (1.0 - std::abs(y - r));
        if (!(w > 0.0)) continue;
        const float height = *image.At(std::clamp(c, 0, image.width - 1), std::clamp(r, 0, image.height - 1));
        if (!std::isfinite(height)) continue;
        sum += w * static_cast<double>(height);
        weight += w;
      }
    }
    return weight >= 0.5 ? sum / weight : std::numeric_limits<double>::quiet_NaN();
  }
  double Mean() const {
    double sum = 0.0, n = 0.0;
    for (const float height : image.data) {
      if (!std::isfinite(height)) continue;
      sum += static_cast<double>(height);
      n += 1.0;
    }
    return n > 0.0 ? sum / n : 0.0;
  }
};

MapHeights ReadHeights(const std::filesystem::path& file, double* cell_m) {
  const gis::MapGrid grid = gis::ReadMapGrid(file);
  const double area = grid.resolution_m * grid.resolution_m * grid.width * grid.height;
  // Much coarser than the map only where it is huge; surveys without a scale may be tiny, so the map's own cells count too.
  *cell_m = std::max(std::clamp(kUsualCell_m, grid.resolution_m, 3.0 * grid.resolution_m), std::sqrt(area / kMostCells));
  const auto width = static_cast<int>(std::ceil(grid.width * grid.resolution_m / *cell_m));
  const auto height = static_cast<int>(std::ceil(grid.height * grid.resolution_m / *cell_m));
  const Eigen::Vector2d low(grid.left, grid.top - height * *cell_m), high(grid.left + width * *cell_m, grid.top);
  return {{grid.left + 0.5 * *cell_m, grid.top - 0.5 * *cell_m}, *cell_m, gis::ReadMapPart(file, Eigen::AlignedBox2d(low, high), width, height)};
}

// Map coordinates over a grid of places in ENU, near one height: exact at nodes, bilinear between them, linear in height.
class MapFromEnuTable {
 public:
  MapFromEnuTable(const surface::MapFrame& frame, const Eigen::AlignedBox2d& box, double z) : origin_(box.min()), z_(z) {
    columns_ = 2 + static_cast<int>(box.sizes().x() / kNodeStep_m);
    const int rows = 2 + static_cast<int>(box.sizes().y() / kNodeStep_m);
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns_; ++column) {
        const Eigen::Vector2d at = origin_ + kNodeStep_m * Eigen::Vector2d(column, row);
        const Eigen::Vector3d low = frame.MapFromEnu({at.x(), at.y(), z_});
        nodes_.push_back({low, frame.MapFromEnu({at.x(), at.y(), z_ + 1.0}) - low});
      }
    }
  }
  // ENU z of the ground at a place; NaN: none.
  double GroundAt(const MapHeights& heights, const Eigen::Vector2d& enu) const {
    const Eigen::Vector2d at = (enu - origin_) / kNodeStep_m;
    const auto column = static_cast<int>(at.x()), row = static_cast<int>(at.y());
    Node node{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    for (int r = row; r <= row + 1; ++r) {
      for (int c = column; c <= column + 1; ++c) {
        const double w = (1.0 - std::abs(at.x() - c)) * (1.0 - std::abs(at.y() - r));
        if (!(w > 0.0)) continue;
        const Node& corner = nodes_[static_cast<size_t>(r) * static_cast<size_t>(columns_) + static_cast<size_t>(c)];
        node.map += w * corner.map;
        node.rise += w * corner.rise;
      }
    }
    // Plumb lines differ by milliradians from ENU's z: the place on the map hardly depends on the height, so two steps are exact.
    double z = z_;
    for (int i = 0; i < 2; ++i) {
      const Eigen::Vector2d map_xy = (node.map + (z - z_) * node.rise).head<2>();
      z = z_ + (heights.At(map_xy) - node.map.z()) / node.rise.z();
    }
    return z;
  }

 private:
  struct Node {
    Eigen::Vector3d map, rise;  // at z_, and per metre of ENU z
  };
  Eigen::Vector2d origin_;
  double z_;
  int columns_ = 0;
  std::vector<Node> nodes_;
};

}  // namespace

GroundGrid::GroundGrid(const Eigen::Vector2d& origin, double cell_m, int columns, int rows, std::vector<float> height_z)
    : origin_(origin), cell_m_(cell_m), columns_(columns), rows_(rows), height_z_(std::move(height_z)) {
  SKYQUILT_CHECK(cell_m > 0.0 && columns > 0 && rows > 0 && height_z_.size() == static_cast<size_t>(columns) * static_cast<size_t>(rows),
                 std::to_string(columns) + " x " + std::to_string(rows) + " cells of " + std::to_string(cell_m) + " m with " +
                     std::to_string(height_z_.size()) + " heights");
}

double GroundGrid::At(const Eigen::Vector2d& enu) const {
  const Eigen::Vector2d at = (enu - origin_) / cell_m_;
  if (!(at.x() >= 0.0 && at.y() >= 0.0 && at.x() <= columns_ - 1 && at.y() <= rows_ - 1)) return std::numeric_limits<double>::quiet_NaN();
  const int column = std::min(static_cast<int>(at.x()), std::max(columns_ - 2, 0)), row = std::min(static_cast<int>(at.y()), std::max(rows_ - 2, 0));
  double height = 0.0;
  for (int r = row; r <= std::min(row + 1, rows_ - 1); ++r) {
    for (int c = column; c <= std::min(column + 1, columns_ - 1); ++c) {
      const double w = (1.0 - std::abs(at.x() - c)) * (1.0 - std::abs(at.y() - r));
      // A corner without weight must not spoil the height of a place on the edge of the known ground.
      if (w > 0.0) height += w * static_cast<double>(height_z_[static_cast<size_t>(r) * static_cast<size_t>(columns_) + static_cast<size_t>(c)]);
    }
  }
  return height;
}

GroundGrid GroundGrid::Read(const std::filesystem::path& dtm_tif, const surface::MapFrame& frame) {
  double cell_m = 0.0;
  const MapHeights heights = ReadHeights(dtm_tif, &cell_m);
  const double mean = heights.Mean();
  const double width = heights.cell_m * heights.image.width, height = heights.cell_m * heights.image.height;
  const Eigen::Vector2d corner = heights.first_centre + Eigen::Vector2d(-0.5 * heights.cell_m, 0.5 * heights.cell_m);  // north-western
  Eigen::AlignedBox2d box;
  double z = 0.0;
  // Edges of the map are nearly straight in ENU: corners and middles hold them, with a cell to spare.
  for (const double x : {0.0, 0.5, 1.0}) {
    for (const double y : {0.0, 0.5, 1.0}) {
      const Eigen::Vector3d enu = frame.EnuFromMap({corner.x() + x * width, corner.y() - y * height, mean});
      box.extend(Eigen::Vector2d(enu.head<2>()));
      if (x == 0.5 && y == 0.5) z = enu.z();
    }
  }
  const auto columns = 3 + static_cast<int>(std::ceil(box.sizes().x() / cell_m)), rows = 3 + static_cast<int>(std::ceil(box.sizes().y() / cell_m));
  const Eigen::Vector2d origin = box.min() - Eigen::Vector2d::Constant(cell_m);
  const MapFromEnuTable table(frame, {origin, origin + cell_m * Eigen::Vector2d(columns, rows)}, z);
  std::vector<float> ground(static_cast<size_t>(columns) * static_cast<size_t>(rows));
  for (int row = 0; row < rows; ++row) {
    base::ThrowIfCancelled();
    for (int column = 0; column < columns; ++column) {
      ground[static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column)] =
          static_cast<float>(table.GroundAt(heights, origin + cell_m * Eigen::Vector2d(column, row)));
    }
  }
  return {origin, cell_m, columns, rows, std::move(ground)};
}

}  // namespace skyquilt::buildings
