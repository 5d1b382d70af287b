// From photos to verified matches in COLMAP's database, with pairs and matching of our own.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "prepare/input/photo_files.h"
#include "prepare/poses/colmap_commands.h"
#include "prepare/poses/feature_store.h"
#include "prepare/poses/pairs.h"
#include "prepare/poses/pose_task.h"

namespace skyquilt::prepare::poses {

// What the steps depend on: when a hash changes, that step and the later ones are repeated.
struct DatabaseHashes {
  std::string features, matches;
};

// Pairs of the given photos, as numbers in their list and in that of `features`.
using PairChooser = std::function<PhotoPairs(const std::vector<input::PhotoFile>& photos, FeatureStore& features)>;

// Steps that are finished are skipped. Photos that COLMAP cannot read are left out with a warning. `ranks`: processes that find features and matches;
// null: this one does, with the same result. Throws base::InputError that names the log when a step fails, base::Interrupted (a later call goes on).
void FillDatabase(const ColmapJob& job, const ColmapSettings& settings, const std::vector<input::PhotoFile>& photos, const PoseOptions& options,
                  const DatabaseHashes& hashes, const PairChooser& choose, base::ThreadPool& threads, RemoteTasks* ranks);

// The first step alone: for matches by COLMAP.
void FillFeatures(const ColmapJob& job, const ColmapSettings& settings, const std::vector<input::PhotoFile>& photos, const PoseOptions& options,
                  const std::string& hash, RemoteTasks* ranks);

}  // namespace skyquilt::prepare::poses
