// Checks that the photos of a folder can be used and reads their EXIF and XMP tags. Which files are photos: input/list_files.h.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/survey/exif.h"

namespace skyquilt::prepare::input {

struct PhotoFile {
  std::string name;  // relative to the root, '/' separated
  int width = 0;     // pixels, as stored
  int height = 0;
  survey::PhotoTags tags = {};
  bool converted = false;  // COLMAP reads a copy of 8 bits without these tags (plain_photos.h)
  bool filled = false;     // that copy has no transparency any more (prepare.alpha)
  std::string mask = {};   // path of its mask (masks/masks.h); empty: none
};

struct PhotoSet {
  std::vector<PhotoFile> usable;        // in name order
  std::vector<std::string> unreadable;  // names of photos left out, each with a warning in the log
};

constexpr int kMinPhotos = 3;

// Reads sizes and tags and checks that JPEGs are complete. Photos that cannot be used are left out, with a warning that says how to fix it.
// Throws base::InputError when fewer than kMinPhotos remain.
PhotoSet ReadPhotos(const std::filesystem::path& root, const std::vector<std::string>& names, base::ThreadPool& threads);

}  // namespace skyquilt::prepare::input
