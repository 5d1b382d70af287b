// Writes the ground control of a simulated survey in the forms of several programs. Files in control/, coordinates in one system, marks of all
// points, check points included:
//   gcp_list.txt                       OpenDroneMap; origin of its pixels: the centre of the top-left one
//   ground_control_points.json         OpenSfM; WGS84, marks from the middle of the photo in units of its longer side
//   pix4d.csv, pix4d_marks.csv         Pix4D: label,x,y,z and photo,label,x,y; origin of the pixels: the photo's corner
//   metashape.csv, metashape_marks.xml Metashape: label,x,y,z under a header, and a chunk with the marks; the photo's corner
//   check_points.txt                   labels of the check points, one a line
//   truth.json                         true and given positions, which points and marks are wrong, true pixels (the photo's corner is (0, 0))
// Sources of the pixels' origins: opensfm/features.py (normalized_image_coordinates); the Metashape and Pix4D manuals.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/camera/camera.h"
#include "core/geo/enu_frame.h"
#include "simulate/control_marks.h"

namespace skyquilt::simulate {

struct ControlFiles {
  std::vector<SurveyedTarget> points;
  std::vector<std::string> photos;  // names, by index of the marks
  camera::Camera camera;
  std::string crs;  // what core/geo/crs.h understands, one line
};

// "EPSG:32632" of the place unless the option names another.
std::string ControlCrsOf(const std::string& option, const geo::Geodetic& place);
// folder: of the survey. Throws base::InputError when a file cannot be written, std::invalid_argument for a position that the system cannot express.
void WriteControlFiles(const ControlFiles& files, const geo::EnuFrame& frame, const std::filesystem::path& folder);

}  // namespace skyquilt::simulate
