#include "prepare/poses/match_pairs.h"

#include <algorithm>
#include <span>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/progress.h"

namespace skyquilt::prepare::poses {
namespace {

namespace fs = std::filesystem;

struct Chunk {
  fs::path file;
  std::string key;
  std::span<const PhotoPair> pairs;
};

// Chunks for each of several processes, so that all end at about the same time.
constexpr size_t kChunksPerProcess = 4, kSmallestChunk = 8;

size_t PairsPerChunk(const MatchJob& job, size_t n_pairs, RemoteTasks* ranks) {
  if (ranks == nullptr) return job.pairs_per_chunk;
  const size_t n_chunks = kChunksPerProcess * static_cast<size_t>(ranks->size());
  return std::min(job.pairs_per_chunk, std::max(kSmallestChunk, (n_pairs + n_chunks - 1) / n_chunks));
}

std::vector<Chunk> SplitIntoChunks(const MatchJob& job, const PhotoPairs& pairs, size_t pairs_per_chunk) {
  std::vector<Chunk> chunks;
  for (size_t first = 0; first < pairs.size(); first += pairs_per_chunk) {
    const std::span some = std::span(pairs).subspan(first, std::min(pairs_per_chunk, pairs.size() - first));
    chunks.push_back({job.folder / fmt::format("chunk_{:05}.bin", chunks.size()), ChunkKey(job.input, some, job.rules, job.min_matches), some});
  }
  return chunks;
}

MatchTask TaskOf(const Chunk& chunk, const MatchJob& job, const FeatureStore& features) {
  MatchTask task{.database = features.file(),
                 .pairs = {},
                 .rules = job.rules,
                 .min_matches = job.min_matches,
                 .file = fs::absolute(chunk.file),
                 .key = chunk.key};
  for (const PhotoPair& pair : chunk.pairs) task.pairs.emplace_back(features.ImageId(pair.a), features.ImageId(pair.b));
  return task;
}

}  // namespace

void MatchPairs(const MatchJob& job, FeatureStore& features, const PhotoPairs& pairs, base::ThreadPool& threads, RemoteTasks* ranks) {
  base::RequireWritableFolder(job.folder);
  const std::vector<Chunk> chunks = SplitIntoChunks(job, pairs, PairsPerChunk(job, pairs.size(), ranks));
  size_t n_done = 0;
  std::vector<const Chunk*> missing;
  for (const Chunk& chunk : chunks) {
    if (LoadChunk(chunk.file, chunk.key)) {
      n_done += chunk.pairs.size();
    } else {
      missing.push_back(&chunk);
    }
  }
  if (n_done > 0) base::LogInfo("{} of {} pairs are already matched", n_done, pairs.size());
  if (!missing.empty()) {
    base::Progress progress("match features", static_cast<double>(pairs.size() - n_done), "pairs");
    std::vector<PoseTask> tasks;
    for (const Chunk* some : missing) {
      if (ranks != nullptr) {
        tasks.emplace_back(TaskOf(*some, job, features));
        continue;
      }
      SaveChunk(some->file, some->key,
                MatchChunk(
                    features, some->pairs, job.rules, job.min_matches, [&] { progress.Advance(); }, threads));
    }
    if (ranks != nullptr) {
      features.database().UseOneFile();
      ranks->Run(tasks, [&progress](double more) { progress.Advance(more); });
    }
    progress.Finish();
  }

  // One chunk at a time: the matches of a large survey need not fit in memory.
  auto chunk = chunks.begin();
  std::vector<survey::DatabaseMatches> loaded;
  size_t next = 0, n_matches = 0, n_matched = 0;
  features.database().ReplaceMatches([&](survey::DatabaseMatches& matches) {
    while (next == loaded.size()) {
      if (chunk == chunks.end()) return false;
      base::ThrowIfCancelled();
      auto read = LoadChunk(chunk->file, chunk->key);
      if (!read) throw base::InputError(chunk->file, "was changed while it was in use", "Run the same command again");
      loaded = std::move(*read);
      next = 0;
      ++chunk;
    }
    matches = std::move(loaded[next++]);
    n_matches += matches.features.size();
    n_matched += matches.features.empty() ? 0 : 1;
    return true;
  });
  base::LogInfo("matches: {} of {} pairs of photos have some, {} on average", n_matched, pairs.size(), n_matched == 0 ? 0 : n_matches / n_matched);
}

void RemoveChunks(const MatchJob& job) {
  std::error_code ignored;
  fs::remove_all(job.folder, ignored);
}

}  // namespace skyquilt::prepare::poses
