// What an exported tour has in common with the viewer: its page, and the project's files as the viewer shows them.
#pragma once

#include <filesystem>
#include <string>

#include "coordinator/project/project.h"
#include "tour/export/export_parts.h"

namespace skyquilt::viewer {

// front_end: folder with the files of the page; empty: those in the program. Throws as TourPage (assets.h).
tour::ExportParts TourParts(const coordinator::Project& project, const std::filesystem::path& front_end, const std::string& made_by);

}  // namespace skyquilt::viewer
