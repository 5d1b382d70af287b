// Finds camera poses and sparse points by structure from motion: runs the COLMAP program for features, matches and mapping. Steps already finished
// for the same photos and options are skipped.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "prepare/photo_files.h"
#include "prepare/prepare_options.h"

namespace skyquilt::prepare {

struct ColmapJob {
  std::filesystem::path photo_root;  // names of photos are relative to it
  std::filesystem::path masks;       // empty: none
  std::filesystem::path folder;      // for COLMAP's database, models and log, and for our stamps of finished steps
  int n_threads = 1;
};

// Photos of the same size, maker, model and focal length have one camera together. GPS neighbours are matched when there are at least
// kMinSpatialPhotos photos and at least nine tenths of them have a GPS tag, otherwise all pairs. Returns the folder of the model with the most
// photos. Throws base::InputError that names the log when a step fails, base::Interrupted when asked to stop (a later call continues).
std::filesystem::path RunColmap(const ColmapJob& job, const std::vector<PhotoFile>& photos, const PrepareOptions& options);

constexpr size_t kMinSpatialPhotos = 60;

// Share of a step that is done after this line of COLMAP's output, in [0, 1]; negative when the line does not tell.
double ColmapLineProgress(const std::string& line, size_t n_photos);

}  // namespace skyquilt::prepare
