// COLMAP's part of finding poses after the features: its own matching, the verification of matches, and the model.
#pragma once

#include <filesystem>
#include <vector>

#include "prepare/input/photo_files.h"
#include "prepare/poses/colmap_step.h"
#include "prepare/poses/pose_options.h"

namespace skyquilt::prepare::poses {

// What all commands need. `fast`: FastColmapFlags instead of COLMAP's defaults. `hold_focal`: the mapper keeps the focal lengths of the tags.
// `hold_lens`: and all else of the lenses.
struct ColmapSettings {
  std::filesystem::path program;
  int n_threads = 1;
  bool fast = false;
  bool hold_focal = false;
  bool hold_lens = false;
};

// All throw base::InputError that names the log when COLMAP fails, base::Interrupted when asked to stop.

// COLMAP's own matching and verification: GPS neighbours when there are at least 60 photos and at least nine tenths of them have GPS in their EXIF
// tags, otherwise all pairs.
void MatchByColmap(const ColmapJob& job, const ColmapSettings& settings, const std::vector<input::PhotoFile>& photos, const PoseOptions& options);

// COLMAP's SiftMatching.min_num_inliers: it keeps no geometry of fewer matches.
constexpr size_t kMinVerified = 15;

// Which of the matches in the database agree with one geometry of the two views, for every pair that has enough of them. A later call goes on where
// one was stopped. Throws base::InputError when COLMAP left pairs out.
void VerifyMatches(const ColmapJob& job, const ColmapSettings& settings, const PoseOptions& options);

// Removes earlier models and makes new ones.
void MakeModels(const ColmapJob& job, const ColmapSettings& settings, size_t n_photos, const PoseOptions& options);

struct FoundModel {
  std::filesystem::path folder;
  size_t n_photos = 0;
};
// The mapper's models, the one with the most photos first. Throws NoModelError when there is none.
std::vector<FoundModel> FoundModels(const ColmapJob& job);

}  // namespace skyquilt::prepare::poses
