// Control points of a made survey, as files of all formats. Also the seeds of fuzz targets.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/geo/geodetic.h"
#include "prepare/control/reading/read_control.h"

namespace skyquilt::test {

struct MadeMark {
  size_t photo = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // as in ControlMark
};

struct MadePoint {
  std::string label;
  geo::Geodetic place;
  std::vector<MadeMark> marks;
};

struct MadeControl {
  std::vector<prepare::control::PhotoSize> photos;
  std::vector<MadePoint> points;
};

// Five points in New York, each with three marks in four photos of two sizes.
MadeControl MakeControl();

// By file name. `crs`: of the coordinates; those of a system in feet without heights are written in its unit.
using ControlTexts = std::map<std::string, std::string>;
ControlTexts OdmFiles(const MadeControl& made, const std::string& crs);               // gcp_list.txt
ControlTexts OpensfmControlFiles(const MadeControl& made);                            // ground_control_points.json
ControlTexts Pix4dFiles(const MadeControl& made, const std::string& crs);             // points.csv, marks.csv
ControlTexts MetashapeControlFiles(const MadeControl& made, const std::string& crs);  // reference.csv, markers.xml

void WriteTexts(const ControlTexts& texts, const std::filesystem::path& folder);

}  // namespace skyquilt::test
