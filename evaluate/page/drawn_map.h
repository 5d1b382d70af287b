// A map of the report as it is drawn: converts east and north to pixels of the drawing, north up.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

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

  Eigen::Vector2d Pixel(const Eigen::Vector3d& x_in_enu) const { return {X(x_in_enu.x()), Y(x_in_enu.y())}; }
  double X(double east_m) const { return (east_m - west_) * scale_; }
  double Y(double north_m) const { return (north_ - north_m) * scale_; }
  double scale() const { return scale_; }  // pixels per metre
  double width_px() const { return width_px_; }
  double height_px() const { return height_px_; }

 private:
  double scale_ = 1.0, width_px_ = 1.0, height_px_ = 1.0, west_ = 0.0, north_ = 0.0;
};

// A picture under a map, north up.
struct MapBackground {
  std::string image;                                  // relative to the page
  Eigen::Vector2d min_enu = Eigen::Vector2d::Zero();  // metres
  Eigen::Vector2d max_enu = Eigen::Vector2d::Zero();
  std::string preview = {};  // what a preview of the orthophoto was made from; empty for the orthophoto
};

// What follows is HTML and SVG. Names of files are escaped here, titles and legends are HTML.
// Opens a figure and its drawing. css_class: in addition to that of all maps. spoken: for screen readers.
std::string MapFigureBegin(const DrawnMap& map, const std::string& css_class, const char* spoken);
// Closes them. legend: made by LegendEntry. note: nothing for none.
std::string MapFigureEnd(const std::string& legend, const std::string& note = "");
std::string BackgroundImage(const DrawnMap& map, const MapBackground& background, const char* css_class = "");
// A line through places of the drawing.
std::string TrackLine(const char* css_class, const std::vector<Eigen::Vector2d>& points_px, const std::string& title);
// Without a geo-reference the bar is in units of unknown length, and no direction is north.
std::string ScaleBarAndNorth(const DrawnMap& frame, bool georeferenced);
// Path data in SVG syntax: a line, with an arrow head at its end unless it is very short.
std::string ArrowPath(const Eigen::Vector2d& start_px, const Eigen::Vector2d& end_px);

}  // namespace skyquilt::evaluate::page
