// How much of a run's time rank 0 works alone, while other ranks wait, for several numbers of ranks: from the times of the stages of a run of one
// process. Rays of the scene, tiles of orthophotos and pieces of meshes are divided evenly among the other ranks, blocks as the scheduler divides
// them (schedule_bench.h); all else is rank 0's own work: decoding, choosing points, the context, textures, what an orthophoto needs before its
// tiles, scores.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/bench_page.h"

namespace skyquilt::bench {

struct StageWork {
  std::string name;
  double own_s = 0.0;      // of rank 0
  double divided_s = 0.0;  // of any ranks
};

struct MeasuredRun {
  std::vector<StageWork> stages;      // in their order; "train" without its blocks, and the context apart
  std::vector<double> block_seconds;  // of one process, per block
};

// From the files that a project's stages have left (.state/, train.json). Throws base::InputError when there is no finished training and when the
// training had several ranks, whose times are not those of one.
MeasuredRun ReadMeasuredRun(const std::filesystem::path& project);

struct RankShareOptions {
  std::vector<int> ranks = {1, 2, 4, 16, 64};
  // A survey of the same kind with so many blocks; all other work grows as the number of blocks. 0: the survey itself.
  int blocks = 0;
  double cost_error = 0.2, speed_spread = 0.05;  // as in ScheduleBenchOptions
  uint64_t seed = 1;
};

struct RankShareRow {
  int ranks = 1;
  double own_s = 0.0;      // rank 0 alone
  double divided_s = 0.0;  // rays, while other ranks work
  double blocks_s = 0.0;   // training of blocks
  double WallSeconds() const { return own_s + divided_s + blocks_s; }
  double Share() const { return own_s / WallSeconds(); }
};

struct RankShares {
  MeasuredRun run;  // of the survey that is asked for
  int measured_blocks = 0;
  std::vector<RankShareRow> rows;  // by number of ranks, ascending
};

// Throws base::UsageError for numbers out of range. With one rank, that one does everything.
RankShares ShareAmongRanks(const MeasuredRun& run, const RankShareOptions& options);

// At this number of ranks rank 0's share should be below this.
constexpr int kShareRanks = 16;
constexpr double kMostShare = 0.2;

BenchPage RankSharesPage(const RankShares& shares, const std::string& command);
std::string RankSharesJson(const RankShares& shares, const std::string& command);

}  // namespace skyquilt::bench
