// Checks that the photos of a folder can be used and reads their EXIF and XMP tags. Which files are photos: input/list_files.h.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/geo/transform.h"
#include "core/survey/exif.h"

namespace skyquilt::prepare::input {

// Where a camera is on the rig that took a photo.
struct RigPlace {
  std::string rig;            // file that describes it, for messages
  std::string shot;           // the same for all photos that were taken at once
  std::string camera;         // the same for all photos of one of the rig's cameras
  geo::Rigid3d cam_from_rig;  // metres
  // The photo has no distortion, this focal length in pixels and its principal point in the middle, as views have that were computed.
  std::optional<double> exact_focal_px = {};
};

struct PhotoFile {
  std::string name;  // relative to the root, '/' separated
  int width = 0;     // pixels, as stored
  int height = 0;
  survey::PhotoTags tags = {};
  bool converted = false;  // COLMAP reads a copy of 8 bits without these tags (plain_photos.h)
  bool filled = false;     // that copy has no transparency any more (prepare.alpha)
  std::string mask = {};   // path of its mask (masks/masks.h); empty: none
  std::optional<RigPlace> rig = {};
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
