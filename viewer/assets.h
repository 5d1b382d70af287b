// The front end, built from web/ and embedded in the program.
#pragma once

#include <filesystem>
#include <vector>

#include "tour/export/export_parts.h"
#include "viewer/server/server.h"

namespace skyquilt::viewer {

// Empty when it was not built, because Node.js or its packages were missing.
std::vector<Asset> FrontEnd();
// The same files from a folder, for work on the front end and for its tests. Throws base::InputError.
std::vector<Asset> FrontEndFrom(const std::filesystem::path& folder);

// The page of an exported tour: index.html, tour.js, tour.css, licences.txt. From a folder, or when that is empty from the program. Throws
// base::InputError, or base::UsageError when the program was built without it.
std::vector<tour::PageFile> TourPage(const std::filesystem::path& folder);

}  // namespace skyquilt::viewer
