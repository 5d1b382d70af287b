// project.json of an exported tour.
#pragma once

#include <string>

namespace skyquilt::tour {

struct ExportedFiles {
  bool tiles = false, terrain = false, orthophoto = false, buildings = false;
};

// The viewer's project.json for a folder that is given away: only files that are in it, no exact frames, and none of the hints for the project's
// owner, which name folders of his machine. Throws std::logic_error when the text is no object.
std::string ExportedProjectJson(const std::string& project_json, const ExportedFiles& files);

}  // namespace skyquilt::tour
