// Dominant directions of a place: up is known, and most walls, roof edges and streets of a district follow two horizontal directions at right angles
// to each other ("Atlanta world", Schindler and Dellaert 2004). Yaw: degrees counter-clockwise from east, in [0, 90), since all four directions of a
// right angle are alike.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <optional>
#include <vector>

namespace skyquilt::survey {

struct YawMode {
  double yaw_deg = 0.0;
  double sigma_deg = 0.0;   // standard error of yaw_deg
  double spread_deg = 0.0;  // standard deviation of its lines
  double share = 0.0;       // of the length of all lines, within kModeReach_deg of it
  int lines = 0;
};
constexpr double kModeReach_deg = 5.0;

// A square of the ground where one direction prevails.
struct YawCell {
  Eigen::Vector2d min_enu;  // its edge is DominantDirections::cell_m
  int mode = 0;             // index into modes
  double share = 0.0;       // of the length of the cell's lines
};

struct DominantDirections {
  std::vector<YawMode> modes;  // the largest share first; empty: the place has no dominant direction
  double concentration = 0.0;  // length of the mean of exp(4 i yaw) over all lines, 0 (any direction) to 1 (one direction)
  int lines = 0;
  int photos = 0;         // in which lines were searched
  double length_m = 0.0;  // of all lines
  double cell_m = 0.0;
  std::vector<YawCell> cells;
  std::array<double, 90> histogram = {};  // share of the length per degree

  // Index of the mode within kModeReach_deg of a yaw (any number of degrees), or -1.
  int ModeNear(double yaw_deg) const;
  // The yaw that prevails at a place, metres in ENU: that of its cell, if more than half of the cell's lines follow it.
  std::optional<double> YawAt(const Eigen::Vector2d& place_enu) const;
};

// Difference a - b of two yaws, -45 to 45 degrees.
double YawDifference(double a_deg, double b_deg);

// directions.json. Throw base::InputError. A missing file is read as no directions.
void SaveDirections(const DominantDirections& directions, const std::filesystem::path& file);
DominantDirections LoadDirections(const std::filesystem::path& file);

}  // namespace skyquilt::survey
