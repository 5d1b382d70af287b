// `bench poses`: photo sets that are hard to find poses for, simulated, in both ways of prepare (prepare.poses), judged by the true poses; and how
// the time per photo grows with the number of photos.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/bench_page.h"
#include "bench/poses/judge_poses.h"
#include "bench/poses/photo_sets.h"
#include "prepare/poses/pose_options.h"
#include "simulate/simulate_options.h"

namespace skyquilt::bench {

inline constexpr const char* kFastWay = "fast";
inline constexpr const char* kColmapWay = "colmap";
// Time per photo of the largest survey relative to the smallest, at most.
constexpr double kMaxSlope = 1.3;

struct PosesRow {
  PhotoSet set = PhotoSet::kPlain;
  std::string way;
  size_t n_files = 0;   // photos of the set, intruders too
  std::string used;     // "tags and matches", "mapper", "more pairs", "more pairs, tagged focal", "COLMAP alone"; empty when there is no model
  std::string failure;  // why there is none
  PoseScore score;
  double seconds = 0.0;  // from photos to the model, features included

  double SecondsPerPhoto() const { return seconds / static_cast<double>(n_files); }
  // The fast way went on to COLMAP's own settings.
  bool FellBack() const { return used.starts_with("more pairs") || (used.empty() && way == kFastWay); }
};

// Both ways for one set of photos.
struct WayComparison {
  const PosesRow* fast = nullptr;
  const PosesRow* colmap = nullptr;
  bool NoFewer() const { return fast->score.registered >= colmap->score.registered; }
  bool Passed() const { return NoFewer() || fast->FellBack(); }
};

// The same set and way in two sizes.
struct PosesSlope {
  PhotoSet set = PhotoSet::kPlain;
  std::string way;
  size_t few = 0, many = 0;  // photos
  double ratio = 0.0;        // of the times per photo
};

struct PosesResult {
  std::string place;
  std::vector<PosesRow> rows;  // by set, number of photos and way
  double seconds = 0.0;        // simulation included

  std::vector<WayComparison> Comparisons() const;  // point into `rows`
  std::vector<PosesSlope> Slopes() const;          // of sets measured in several sizes
};

struct PosesBenchOptions {
  std::filesystem::path folder;        // surveys, photo sets and COLMAP's files are in its folder "poses_work"
  std::vector<PhotoSet> sets;          // empty: all
  std::vector<int> photos;             // simulated photos per set, >= 3; empty: as many as the place has. solar_farm has at most its 40
  std::vector<std::string> ways;       // kFastWay, kColmapWay; empty: both
  simulate::SimulateOptions simulate;  // of the place of all sets but solar_farm
  std::optional<std::string> place;    // its name; nothing: simulate.place, or a city when --photos asks for more than the town has
  prepare::poses::PoseOptions poses;   // of both ways, but for `fast`
  int threads = 0;                     // <= 0: every core
  bool keep = false;                   // the folder "poses_work"
  // Called after every row with the rows so far.
  std::function<void(const PosesResult&)> on_row = [](const PosesResult&) {};
};

// What was used to find a model that RunColmap put into `model`, for a job in `job`; see PosesRow::used.
std::string UsedWay(const std::filesystem::path& job, const std::filesystem::path& model, bool fast);

// Throws base::UsageError for photo numbers that the place cannot have, base::InputError when COLMAP is missing or fails, base::Interrupted.
PosesResult RunPosesBench(const PosesBenchOptions& options);

BenchPage PosesPage(const PosesResult& result, const std::string& command);
std::string PosesJson(const PosesResult& result, const std::string& command);

}  // namespace skyquilt::bench
