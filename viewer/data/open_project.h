// A project as the viewer shows it: what there is, and for what is missing the reason and the command that helps.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "coordinator/project/project.h"
#include "core/geo/utm.h"
#include "core/survey/survey.h"
#include "viewer/data/file_look.h"
#include "viewer/data/survey_place.h"

namespace skyquilt::viewer {

struct OpenedProject {
  coordinator::Project project;
  std::shared_ptr<const survey::Survey> survey;  // null when it cannot be read
  FileLook survey_state;                         // of survey.json on disk when it was read
  geo::Geodetic origin;
  bool georeferenced = false;
  geo::UtmZone zone;                // of the maps, when geo-referenced
  std::set<std::string> tiles;      // names of files in surface/tiles; empty: there is no finished surface
  std::set<std::string> buildings;  // names of files in buildings/; empty: there are none that can be shown
  bool terrain = false, orthophoto = false, contours = false;
  nlohmann::json description;  // project.json without "before" and "revision"
};

// Reads as much as there is. Never throws for what is missing or damaged. earlier: the same project when it was opened before, whose survey is used
// again if its file is still the same.
OpenedProject OpenProject(const coordinator::Project& project, const OpenedProject* earlier = nullptr);

// The file of a photo; empty when its name leads out of the folder of the photos.
std::filesystem::path PhotoFile(const survey::Survey& survey, const survey::Photo& photo);

// "enu_from_before" of project.json: 16 numbers, row-major. The identity when either is without geo-reference.
nlohmann::json EnuFromOther(const OpenedProject& main, const OpenedProject& other);

}  // namespace skyquilt::viewer
