// Structure from motion by COLMAP as a program: features, matches, mapper. Steps that are finished for the same photos and options are skipped.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "prepare/photo_files.h"
#include "prepare/prepare_options.h"

namespace skyquilt::prepare {

struct ColmapJob {
  std::filesystem::path photo_root;
  std::filesystem::path masks;   // empty: none
  std::filesystem::path folder;  // database, models, stamps and log
  int n_threads = 1;
};

// Photos that share size, maker, model and focal length share one camera. Matching goes by GPS neighbours when there are at least
// kMinSpatialPhotos photos and most of them are tagged, by all pairs otherwise. Returns the folder of the model with the most photos.
// Throws base::InputError naming the log when a step fails, base::Interrupted when asked to stop (a later call continues).
std::filesystem::path RunColmap(const ColmapJob& job, const std::vector<PhotoFile>& photos, const PrepareOptions& options);

constexpr size_t kMinSpatialPhotos = 60;

// The share of a step done after this line of COLMAP's output, in [0, 1]; negative when the line says nothing about it.
double ColmapLineProgress(const std::string& line, size_t n_photos);

}  // namespace skyquilt::prepare
