// Reads ground control points and check points: OpenDroneMap's gcp_list.txt, OpenSfM's ground_control_points.json, tables of Pix4D, Metashape and
// others with a second file of marks (a table or Metashape's XML). The format is recognised from the content. docs/control_points.md describes the
// formats, their columns and where they count pixels from.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "prepare/control/reading/control_photos.h"
#include "prepare/control/reading/control_points.h"

namespace skyquilt::prepare::control {

// What the user gives; only `points` is required.
struct ControlFiles {
  std::filesystem::path points = {};
  std::filesystem::path marks = {};  // pixels of the points, if `points` does not have them
  std::string crs = {};              // coordinate system; overrides the one in the file
  std::string columns = {};          // what the columns of a table of points are: "label,east,north,up", see control_columns.h
  std::string heights = {};          // "crs" (or empty), "ellipsoid", "egm96": what the heights are above, see point_places.h
  std::string check_points = {};     // labels of points that are only compared, separated by commas, or a file with one per line
};

// Points in file order, those that `check_points` or the file names marked as such. Photos that are not there, points with fewer than three marks,
// marks without a point and assumptions about heights become warnings; nothing is logged. Throws
//   base::InputError  a file that cannot be read or understood, with the line: coordinates outside their system, a mark outside its photo, two marks
//   of a
//                     point in one photo, one label with different coordinates, no marks at all
//   base::UsageError  crs, columns, heights or check_points that cannot be meant
ControlPoints ReadControl(const ControlFiles& files, const std::vector<PhotoSize>& photos);

// The places that a file of marks alone has, in the order of their first marks; their coordinates are NaN. Photos that are not there and places with
// fewer than three marks become warnings. Throws as ReadControl does for marks.
ControlPoints ReadMarkedPlaces(const std::filesystem::path& marks, const std::vector<PhotoSize>& photos);

}  // namespace skyquilt::prepare::control
