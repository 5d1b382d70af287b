#include <algorithm>
#include <bit>
#include <cstring>
#include <stdexcept>

#include "core/linear/linear.h"
#include "tour/ways/heights.h"

namespace skyquilt::tour {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are read as they are in memory");

// Share of a cell that the rounding of points to floats may have moved them.
constexpr double kRounding = 1e-3;
constexpr double kMostCells = 1 << 24;
constexpr size_t kHeaderBytes = 40, kPointBytes = 12;
constexpr int kMostPointsOfSide = 1 << 16;

[[noreturn]] void Damaged(const char* why) {
  throw std::runtime_error(std::string("the surface model is damaged: ") + why);
}

struct TerrainPoint {
  int column = 0, row = 0;
  Eigen::Vector3d offset;  // minus the anchor
};

// Points with a surface.
struct TerrainPoints {
  int columns = 0, rows = 0;
  Eigen::Vector3d anchor;
  std::vector<TerrainPoint> points;

  explicit TerrainPoints(std::string_view bytes) {
    if (bytes.size() < kHeaderBytes || !bytes.starts_with("SKYTERR1")) Damaged("it does not begin as it should");
    uint32_t size[2];
    std::memcpy(size, bytes.data() + 8, sizeof(size));
    std::memcpy(anchor.data(), bytes.data() + 16, 3 * sizeof(double));
    const bool possible = size[0] <= kMostPointsOfSide && size[1] <= kMostPointsOfSide && anchor.allFinite() &&
                          bytes.size() == kHeaderBytes + kPointBytes * size[0] * static_cast<size_t>(size[1]);
    if (!possible) Damaged("its length is not that of its points");
    columns = static_cast<int>(size[0]);
    rows = static_cast<int>(size[1]);
    const char* at = bytes.data() + kHeaderBytes;
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column, at += kPointBytes) {
        float values[3];
        std::memcpy(values, at, sizeof(values));
        const Eigen::Vector3d offset = Eigen::Map<const Eigen::Vector3f>(values).cast<double>();
        if (offset.allFinite()) points.push_back({column, row, offset});
      }
    }
  }
};

// Steps in ENU from a point to the next of its row and of its column.
struct Lattice {
  Eigen::Vector2d per_column, per_row;
};

// Least squares over all points. Points of one row or column give one step, and the other one is as long and at right angles to it.
Lattice FitLattice(const TerrainPoints& terrain) {
  const auto n = static_cast<double>(terrain.points.size());
  Eigen::Vector2d cell = Eigen::Vector2d::Zero(), place = Eigen::Vector2d::Zero();
  for (const TerrainPoint& point : terrain.points) {
    cell += Eigen::Vector2d(point.column, point.row);
    place += point.offset.head<2>();
  }
  cell /= n;
  place /= n;
  Eigen::Matrix2d cells = Eigen::Matrix2d::Zero(), mixed = Eigen::Matrix2d::Zero();  // mixed: columns per column and row
  for (const TerrainPoint& point : terrain.points) {
    const Eigen::Vector2d c = Eigen::Vector2d(point.column, point.row) - cell, d = point.offset.head<2>() - place;
    cells += c * c.transpose();
    mixed += d * c.transpose();
  }
  Lattice lattice;
  if (linear::Determinant(cells) > 1e-9 * cells(0, 0) * cells(1, 1)) {
    const Eigen::Matrix2d steps = mixed * linear::Inverse(cells);
    lattice = {steps.col(0), steps.col(1)};
  } else if (cells(0, 0) >= cells(1, 1) && cells(0, 0) > 0.0) {
    lattice.per_column = mixed.col(0) / cells(0, 0);
    lattice.per_row = {lattice.per_column.y(), -lattice.per_column.x()};
  } else if (cells(1, 1) > 0.0) {
    lattice.per_row = mixed.col(1) / cells(1, 1);
    lattice.per_column = {-lattice.per_row.y(), lattice.per_row.x()};
  } else {
    // One point says nothing of its surroundings: a metre to each side.
    lattice = {{1.0, 0.0}, {0.0, -1.0}};
  }
  if (!(lattice.per_column.norm() > 0.0 && lattice.per_row.norm() > 0.0)) Damaged("its points are not a grid");
  return lattice;
}

}  // namespace

std::optional<Heights> HeightsFromTerrain(std::string_view terrain_bin) {
  const TerrainPoints terrain(terrain_bin);
  if (terrain.points.empty()) return {};
  const Lattice lattice = FitLattice(terrain);
  const Eigen::Vector2d cell_m(lattice.per_column.norm(), lattice.per_row.norm());
  // Half the box of the four meshes around a point; one cell to each side when the grid is not turned.
  const Eigen::Vector2d reach = lattice.per_column.cwiseAbs() + lattice.per_row.cwiseAbs() - kRounding * cell_m;
  Eigen::AlignedBox2d box;
  for (const TerrainPoint& point : terrain.points) box.extend(Eigen::Vector2d(point.offset.head<2>()));
  // Cells begin at points, so that a grid that is not turned keeps its own.
  const Eigen::Vector2d corner = box.min().array() - (reach.array() / cell_m.array()).ceil() * cell_m.array();
  const Eigen::Array2d size = ((box.max() + reach - corner).array() / cell_m.array()).floor() + 1.0;
  const double most = 4.0 * (terrain.columns + 3.0) * (terrain.rows + 3.0) + 3.0 * terrain.columns * static_cast<double>(terrain.rows);
  if (!(size.minCoeff() >= 1.0 && size.prod() <= std::min(kMostCells, most))) Damaged("its points are not a grid");
  const int wide = static_cast<int>(size.x()), high = static_cast<int>(size.y());
  std::vector<double> z(static_cast<size_t>(wide) * static_cast<size_t>(high), std::numeric_limits<double>::quiet_NaN());
  for (const TerrainPoint& point : terrain.points) {
    const Eigen::Array2d d = (point.offset.head<2>() - corner).array();
    const Eigen::Array2d first = ((d - reach.array()) / cell_m.array()).floor().max(0.0);
    const Eigen::Array2d last = ((d + reach.array()) / cell_m.array()).floor().min(size - 1.0);
    const double top = point.offset.z() + terrain.anchor.z();
    for (int row = static_cast<int>(first.y()); row <= static_cast<int>(last.y()); ++row) {
      for (int column = static_cast<int>(first.x()); column <= static_cast<int>(last.x()); ++column) {
        double& cell = z[static_cast<size_t>(row) * static_cast<size_t>(wide) + static_cast<size_t>(column)];
        // NaN is not above anything either.
        if (!(cell >= top)) cell = top;
      }
    }
  }
  return Heights(corner + terrain.anchor.head<2>(), cell_m, wide, high, std::move(z));
}

}  // namespace skyquilt::tour
