// The coordinates of the files for people: those of the maps. Without geo-reference the local frame, enlarged by the scale bar where one was given,
// so that coordinates and measures have the same unit. (buildings.json and buildings.glb keep the coordinates of the survey.)
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "buildings/building.h"
#include "surface/map_frame.h"

namespace skyquilt::buildings {

class FileFrame {
 public:
  // Keeps a reference to the frame.
  FileFrame(const BuildingSet& set, const surface::MapFrame& frame);

  const surface::MapFrame& map() const { return map_; }
  bool metric() const { return metric_; }
  // Easting, northing, height, rounded to 0.1 mm. Throws std::logic_error when a coordinate is not finite.
  Eigen::Vector3d PositionOf(const Eigen::Vector3d& enu) const;
  // The vertices of a solid.
  std::vector<Eigen::Vector3d> PositionsOf(const Solid& solid) const;
  // Height of ENU z at this place.
  double HeightOf(const Eigen::Vector2d& enu, double z) const { return PositionOf({enu.x(), enu.y(), z}).z(); }
  // Factor that makes metres of lengths in the survey's frame: of the scale bar, else 1.
  double scale() const { return scale_; }

  // "EPSG:32632", "local frame, metres", "local frame, unknown scale".
  std::string CrsName() const;
  std::string VerticalName() const;

 private:
  const surface::MapFrame& map_;
  bool metric_;
  double scale_;
};

// Nearest multiple of 10^-digits; never -0.
double Rounded(double value, int digits);
// A finite number with its shortest digits, never in the form 1e-5.
std::string NumberText(double value);

}  // namespace skyquilt::buildings
