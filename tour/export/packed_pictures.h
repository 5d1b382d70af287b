// The pictures of an exported tour's stops, in the size and quality that its limit allows.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "tour/pictures/picture_file.h"

namespace skyquilt::tour {

struct StopPictures {
  std::string stop;                       // its id
  std::filesystem::path still, panorama;  // files of MakePictures
};

struct PicturePlan {
  int shrink = 1;               // panoramas are this many times smaller than rendered: 1, 2, 4 ...
  int quality = 92;             // of all JPEG files
  bool lossless_stills = true;  // PNG instead
  int64_t bytes = 0;            // of all scripts
  bool fits = false;            // false: this is the least, and it is still too much
};

// The best that keeps to the limit: stills without loss where they take at most a third of it, then JPEG quality, then panoramas of half the size,
// down to 1024 pixels. Throws base::InputError, base::Interrupted.
PicturePlan FitPicturesOfStops(std::span<const StopPictures> stops, int64_t limit_bytes, base::ThreadPool& threads);

// Writes them below the folder as scripts "stops/<id>/still.jpg" (or .png), "still.depth", "panorama.jpg", "panorama.depth". A picture that shows no
// surface has no depth file, and depth_width 0. Returns the stops' part of manifest.json. on_bytes is called after each script.
nlohmann::json WritePicturesOfStops(std::span<const StopPictures> stops, const PicturePlan& plan, const std::filesystem::path& folder,
                                    const std::function<void(int64_t bytes)>& on_bytes);

// The picture with half the width and height, `shrink` a power of two.
StoredPicture Shrunk(const StoredPicture& picture, int shrink);

}  // namespace skyquilt::tour
