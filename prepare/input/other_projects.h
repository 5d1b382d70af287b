// Recognises the folders of photogrammetry projects by what lies in them: their pictures are results, or copies of photos.
#pragma once

#include <filesystem>
#include <set>
#include <string>

namespace skyquilt::prepare::input {

// As in "a Skyquilt project"; empty when the folder is none: Skyquilt, OpenDroneMap, OpenSfM, COLMAP, nerfstudio, Pix4D. Looks for files and folders,
// and reads none.
std::string ProjectKind(const std::filesystem::path& folder);

// Why no photos are in a folder: by its name and by what lies beside it. Empty when there may be some. `siblings`: names of files and folders of its
// parent, which may be a project itself (`parent_kind`, by ProjectKind).
std::string ResultFolder(const std::string& name, const std::set<std::string>& siblings, const std::string& parent_kind);

}  // namespace skyquilt::prepare::input
