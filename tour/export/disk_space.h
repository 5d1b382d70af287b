// Whether there is room for files, before work begins.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace skyquilt::tour {

// Throws base::InputError when the disk of this folder (or of the nearest one above that exists) has fewer free bytes. what: "the tour". A disk that
// does not say how much is free counts as empty enough.
void RequireFreeSpace(const std::filesystem::path& folder, int64_t bytes, const std::string& what);

// "12.3 MB"
std::string MegabytesText(int64_t bytes);

}  // namespace skyquilt::tour
