// Masks that a transforms.json names (nerfstudio: frames[].mask_path, relative to the file).
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace skyquilt::prepare::input {

// Paths of masks by the names of their photos. Files that are no such JSON are passed over: whoever reads the model tells what is wrong. Masks that
// are not there are left out with a warning.
std::map<std::string, std::filesystem::path> NamedMasks(const std::filesystem::path& photo_root, const std::vector<std::string>& photos,
                                                        const std::vector<std::filesystem::path>& transforms);

}  // namespace skyquilt::prepare::input
