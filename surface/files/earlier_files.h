// The files of earlier calls in the folder of a surface.
#pragma once

#include <filesystem>

namespace skyquilt::surface {

// Removes what a killed process has left incomplete. Throws base::InputError, as does the other function.
void RemovePartialFiles(const std::filesystem::path& folder);
// Removes every file that SurfaceFiles may have written, so that files of different surfaces are not taken for one.
void RemoveEarlierFiles(const std::filesystem::path& folder);

}  // namespace skyquilt::surface
