// Joins databases of COLMAP (colmap_database.h) that have the features of some photos each.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace skyquilt::survey {

struct DatabasePart {
  std::filesystem::path file;      // with one camera
  uint32_t camera_id = 1;          // in the joined database; parts with the same id have the first one's camera
  std::vector<std::string> names;  // of images
};

// Writes cameras, images, keypoints and descriptors of the parts to `file`, whole or not at all; an earlier file is replaced. Images get ids from 1
// in the order of the parts and of their names, whatever their ids were: COLMAP numbers images in the order in which its threads happen to finish.
// Names that a part does not have are left out. The parts are not changed. There must be one at least. Throws base::InputError, base::Interrupted.
void MergeFeatures(std::span<const DatabasePart> parts, const std::filesystem::path& file);

// With the journals that SQLite may have left beside it.
void RemoveDatabase(const std::filesystem::path& file);

}  // namespace skyquilt::survey
