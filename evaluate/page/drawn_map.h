// A map of the report as it is drawn: converts east and north to pixels of the drawing, north up.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>

namespace skyquilt::evaluate::page {

// Bounds of what a map shows: east and north in metres.
struct MapBounds {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;

  void Include(const Eigen::Vector2d& x);  // unless it is not finite
  // Widens them to the shape of a drawing on the page, unless they are empty.
  void MakeRoom();
  bool Empty() const { return !(high.array() >= low.array()).all(); }
};

class DrawnMap {
 public:
  // With some room around the bounds; 2 m by 2 m about the origin when they are empty.
  explicit DrawnMap(const MapBounds& bounds);

  double X(double east_m) const { return (east_m - west_) * scale_; }
  double Y(double north_m) const { return (north_ - north_m) * scale_; }
  double scale() const { return scale_; }  // pixels per metre
  double width_px() const { return width_px_; }
  double height_px() const { return height_px_; }

 private:
  double scale_ = 1.0, width_px_ = 1.0, height_px_ = 1.0, west_ = 0.0, north_ = 0.0;
};

// SVG. Without a geo-reference the bar is in units of unknown length, and no direction is north.
std::string ScaleBarAndNorth(const DrawnMap& frame, bool georeferenced);

// Path data in SVG syntax: a line, with an arrow head at its end unless it is very short.
std::string ArrowPath(const Eigen::Vector2d& start_px, const Eigen::Vector2d& end_px);

}  // namespace skyquilt::evaluate::page
