// Ground control points and check points: places on the ground with surveyed coordinates, and their marks on photos.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/geo/geodetic.h"

namespace skyquilt::prepare::control {

// Where a point shows in a photo.
struct ControlMark {
  std::string photo;                                // name of the photo, path relative to the photo folder as in survey::Photo::name
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // of the stored photo, see core/camera/camera.h: centre of the top-left pixel is (0.5, 0.5)
  int line = 0;                                     // in the file it comes from, from 1; 0: unknown
  // Where it is in the stored photo if the file's marks were made in upright pictures; only where that is another place and the file itself does not
  // tell. What the photos' poses say of it: prepare/control/fit/mark_reading.h.
  std::optional<Eigen::Vector2d> if_upright = {};
};

struct ControlPoint {
  std::string label;                                          // unique
  Eigen::Vector3d given = Eigen::Vector3d::Zero();            // x y z as in the file, in the units of its system; z is NaN when it has no height
  geo::Geodetic place;                                        // WGS84 with ellipsoidal height; the height is NaN when it has none
  double horizontal_sigma_m = 0.01, vertical_sigma_m = 0.02;  // accuracy of the coordinates, one standard deviation per axis
  bool check = false;                                         // only compared with the result, never used to make it
  std::vector<ControlMark> marks;                             // at most one per photo
  int line = 0;                                               // in the file of the coordinates, from 1
};

// Points of one file (or of a file with coordinates and one with marks), checked: labels differ, coordinates are on Earth, marks are inside their
// photos.
struct ControlPoints {
  std::string file;                   // of the coordinates, for messages
  std::string crs;                    // name of the file's coordinate system, horizontal and vertical
  std::string heights;                // what its heights were taken for: "ellipsoid", "egm96", or the name of its vertical system
  std::vector<ControlPoint> points;   // in file order
  std::vector<std::string> warnings;  // lines to be logged: photos that are not there, points with fewer than three marks, ...
  std::string crs_definition = {};    // what PROJ resolves to `crs`
};

}  // namespace skyquilt::prepare::control
