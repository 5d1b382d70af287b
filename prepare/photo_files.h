// The photos of a folder: found, looked over, and with their tags.
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
  survey::PhotoTags tags;  // gps, when present, has a finite height
};

struct PhotoSet {
  std::vector<PhotoFile> usable;        // in name order
  std::vector<std::string> unreadable;  // names of files dropped, each already warned about
};

constexpr int kMinPhotos = 3;

// By its extension: jpg, jpeg, png, tif, tiff in any case; hidden files are not photos.
bool LooksLikePhoto(const std::filesystem::path& file);
// All photos under `root` in name order; folders in `skip` and hidden ones are not entered. Throws base::InputError when there is none.
std::vector<std::string> ListPhotos(const std::filesystem::path& root, const std::vector<std::filesystem::path>& skip);
// Reads sizes and tags and checks that JPEGs are complete. Files that cannot be used are dropped with a warning that names file and how to fix it.
// Throws base::InputError when fewer than kMinPhotos remain.
PhotoSet ReadPhotos(const std::filesystem::path& root, const std::vector<std::string>& names, base::ThreadPool& threads);
// Tags without a height: taken from RelativeAltitude or 0 when most have none (with a warning), otherwise the tag is not used.
void ResolveHeights(std::vector<PhotoFile>& photos);
// masks/<name>.png per photo, empty where there is none. Throws base::InputError when no mask fits any photo or a mask has another size.
std::vector<std::string> FindMasks(const std::filesystem::path& masks, const std::vector<PhotoFile>& photos);

}  // namespace skyquilt::prepare
