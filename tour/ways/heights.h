// What is solid, for ways that keep a distance from it, and for views that must not be blocked: a grid of columns without gaps between them, each
// filled from below up to its height. A column covers its whole cell. Cells without surface and everything outside the grid are empty. ENU, metres.
// As web/src/tour/heights.ts, whose tests it shares.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

namespace skyquilt::tour {

class Heights {
 public:
  // min: south-western corner; cell_m: size of a cell along x and y; z: tops of the columns, row by row from the south-west, NaN without surface.
  Heights(const Eigen::Vector2d& min, const Eigen::Vector2d& cell_m, int columns, int rows, std::vector<double> z);

  const Eigen::AlignedBox2d& box() const { return box_; }
  const Eigen::Vector2d& cell_m() const { return cell_m_; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  // Top of the column of a cell; NaN: no surface.
  double Top(int column, int row) const { return z_[static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column)]; }

  // Top of the column here.
  std::optional<double> At(double x, double y) const;
  // Highest top of a column that comes nearer in plan than the radius; kNothing: there is none.
  double Highest(double x, double y, double radius_m) const;
  // The lowest z from which up every point here is at least the radius away from what is solid. With slack_m the same for all places that are not
  // farther than this from here, or a little more. kNothing: all heights are free.
  double Dilated(double x, double y, double radius_m, double slack_m = 0.0) const;
  // No column is that near in plan.
  bool IsFar(double x, double y, double radius_m) const;

  // Below everything.
  static constexpr double kNothing = -std::numeric_limits<double>::infinity();

 private:
  double Strongest(double x, double y, double radius_m, const std::function<double(double z, double distance_m)>& of) const;

  Eigen::AlignedBox2d box_;
  Eigen::Vector2d cell_m_;
  int columns_, rows_;
  std::vector<double> z_;
};

// From the bytes of terrain.bin (docs/viewer_protocol.md). Its points lie on a map's grid, which is turned against ENU by the convergence of
// meridians, and the drawn surface passes between them: each point raises all cells that a triangle with this corner can touch. Nothing when it has
// no point with a surface. Throws std::runtime_error when it is damaged.
std::optional<Heights> HeightsFromTerrain(std::string_view terrain_bin);

}  // namespace skyquilt::tour
