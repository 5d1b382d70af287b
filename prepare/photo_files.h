// Lists the photos of a folder, checks that they can be used and reads their EXIF and XMP tags.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/survey/exif.h"

namespace skyquilt::prepare {

struct PhotoFile {
  std::string name;  // relative to the root, '/' separated
  int width = 0;     // pixels, as stored
  int height = 0;
  survey::PhotoTags tags;
  bool converted = false;  // COLMAP reads a copy of 8 bits without these tags (plain_photos.h)
};

struct PhotoSet {
  std::vector<PhotoFile> usable;        // in name order
  std::vector<std::string> unreadable;  // names of photos left out, each with a warning in the log
};

constexpr int kMinPhotos = 3;

// Decides by the extension: jpg, jpeg, png, tif or tiff in any case. Hidden files are not photos.
bool LooksLikePhoto(const std::filesystem::path& file);
// Names of all photos under `root`, sorted. Folders in `skip` and hidden folders are not searched. Throws base::InputError when there is none.
std::vector<std::string> ListPhotos(const std::filesystem::path& root, const std::vector<std::filesystem::path>& skip);
// Reads sizes and tags and checks that JPEGs are complete. Photos that cannot be used are left out, with a warning that says how to fix it.
// Throws base::InputError when fewer than kMinPhotos remain.
PhotoSet ReadPhotos(const std::filesystem::path& root, const std::vector<std::string>& names, base::ThreadPool& threads);
// Path of masks/<name>.png per photo, empty where there is none. Throws base::InputError when no photo has a mask or when a mask's size differs from
// its photo's.
std::vector<std::string> FindMasks(const std::filesystem::path& masks, const std::vector<PhotoFile>& photos);

}  // namespace skyquilt::prepare
