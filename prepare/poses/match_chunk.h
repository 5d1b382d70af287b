// A chunk of the matching: some pairs of photos and the file with their matches. Chunks do not depend on each other, and a finished one is a file, so
// that a run that was killed loses only the chunk it was working on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/survey/colmap_database.h"
#include "prepare/poses/feature_matcher.h"
#include "prepare/poses/feature_store.h"
#include "prepare/poses/pairs.h"

namespace skyquilt::prepare::poses {

// Identity of what a chunk's matches are made from; `input` identifies the features.
std::string ChunkKey(const std::string& input, std::span<const PhotoPair> pairs, const MatchRules& rules, size_t min_matches);

// Matches in the order of the pairs. Pairs with fewer than `min_matches` get none, as COLMAP would verify none of them. on_pair is called after each
// pair by any of the threads. Throws base::Interrupted, and base::InputError for a damaged database.
std::vector<survey::DatabaseMatches> MatchChunk(FeatureStore& features, std::span<const PhotoPair> pairs, const MatchRules& rules, size_t min_matches,
                                                const std::function<void()>& on_pair, base::ThreadPool& threads);

// Written whole or not at all. Throws base::InputError.
void SaveChunk(const std::filesystem::path& file, const std::string& key, std::span<const survey::DatabaseMatches> matches);
// Nothing when the file does not exist, is damaged, or has another key: then the chunk is to be matched (again).
std::optional<std::vector<survey::DatabaseMatches>> LoadChunk(const std::filesystem::path& file, const std::string& key);

}  // namespace skyquilt::prepare::poses
