// Matches the features of all pairs in chunks and writes the matches into COLMAP's database.
#pragma once

#include <filesystem>
#include <string>

#include "core/base/thread_pool.h"
#include "prepare/poses/colmap_commands.h"
#include "prepare/poses/feature_store.h"
#include "prepare/poses/match_chunk.h"
#include "prepare/poses/pose_task.h"

namespace skyquilt::prepare::poses {

struct MatchJob {
  std::filesystem::path folder;  // for the files of chunks; made if needed
  std::string input;             // identifies the features: chunks made from others are not used
  MatchRules rules = {};
  size_t min_matches = kMinVerified;
  size_t pairs_per_chunk = 256;  // half a minute or less on two cores
};

// `pairs` are sorted, so that a chunk meets the same photos again and again. Finished chunks of an earlier call are not repeated. Afterwards the
// database has the matches of these pairs and no others, and no geometries. Shows progress in pairs. Throws base::Interrupted (a later call goes on),
// base::InputError for a damaged database and for files that cannot be written. `ranks`: processes
// that match the chunks, which are smaller where there are few pairs for each; null: this one does, with the same result.
void MatchPairs(const MatchJob& job, FeatureStore& features, const PhotoPairs& pairs, base::ThreadPool& threads, RemoteTasks* ranks = nullptr);

// Removes the files of chunks: once the matches are in the database nobody needs them.
void RemoveChunks(const MatchJob& job);

}  // namespace skyquilt::prepare::poses
