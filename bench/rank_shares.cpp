#include "bench/rank_shares.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>
#include <optional>

#include "bench/schedule_bench.h"
#include "coordinator/project/project.h"
#include "coordinator/project/stamp.h"
#include "core/base/errors.h"
#include "core/scene/train_report.h"

namespace skyquilt::bench {
namespace {

constexpr const char* kContext = "train: context";
constexpr const char* kTrainOwn = "train: all but fields";

// Of the stages that render. The search for poses is divided too where COLMAP's features and own matches are made, but a project does not say how
// long these took.
constexpr const char* kStagesInOrder[] = {"prepare", "masks", "partition", "train", "merge", "products", "surface", "buildings", "evaluate", "tour"};

double SumOf(const std::vector<double>& seconds) {
  return std::accumulate(seconds.begin(), seconds.end(), 0.0);
}

void AddTraining(const scene::TrainReport& report, double stage_s, MeasuredRun* run) {
  double context_s = 0.0;
  for (const scene::FieldTraining& field : report.fields) {
    if (field.block < 0) {
      context_s += field.seconds;
    } else if (field.ok && field.seconds > 0.0) {
      run->block_seconds.push_back(field.seconds);
    }
  }
  run->stages.push_back({kTrainOwn, std::max(0.0, stage_s - context_s - SumOf(run->block_seconds)), 0.0});
  run->stages.push_back({kContext, context_s, 0.0});
}

// Seconds until the last of the blocks is trained.
double BlocksSeconds(const MeasuredRun& run, int ranks, const RankShareOptions& options) {
  const double all_s = SumOf(run.block_seconds);
  if (ranks == 1 || run.block_seconds.empty()) return all_s;
  const auto n = static_cast<int>(run.block_seconds.size());
  ScheduleBenchOptions schedule;
  schedule.blocks = n;
  schedule.ranks = ranks;
  schedule.block_seconds = all_s / n;
  schedule.measured_seconds = run.block_seconds;
  schedule.cost_error = options.cost_error;
  schedule.speed_spread = options.speed_spread;
  schedule.stragglers = schedule.failing = 0.0;
  schedule.seed = options.seed;
  return RunScheduleBench(schedule).undisturbed.wall_s;
}

// A survey with so many blocks, each like one of those measured.
MeasuredRun Grown(const MeasuredRun& run, int blocks) {
  if (blocks <= 0) return run;
  MeasuredRun grown = run;
  const double factor = static_cast<double>(blocks) / static_cast<double>(run.block_seconds.size());
  for (StageWork& stage : grown.stages) {
    stage.own_s *= factor;
    stage.divided_s *= factor;
  }
  grown.block_seconds.resize(static_cast<size_t>(blocks));
  for (size_t i = 0; i < grown.block_seconds.size(); ++i) grown.block_seconds[i] = run.block_seconds[i % run.block_seconds.size()];
  return grown;
}

}  // namespace

MeasuredRun ReadMeasuredRun(const std::filesystem::path& folder) {
  const coordinator::Project project{folder};
  const scene::TrainReport report = scene::ReadTrainReport(project.TrainReport());
  if (report.ranks > 1) {
    throw base::InputError(project.TrainReport(), fmt::format("is of a training with {} ranks", report.ranks),
                           "Give a project that was made without mpirun, so that the times are those of one process");
  }
  MeasuredRun run;
  for (const char* name : kStagesInOrder) {
    const std::optional<coordinator::StageStamp> stamp = coordinator::LoadStamp(project, name);
    if (!stamp || stamp->state != coordinator::StageStamp::kDone) continue;
    if (stamp->stage == "train") {
      AddTraining(report, stamp->seconds, &run);
    } else {
      run.stages.push_back({name, std::max(0.0, stamp->seconds - stamp->rendering_seconds), std::min(stamp->seconds, stamp->rendering_seconds)});
    }
  }
  if (run.block_seconds.empty()) {
    throw base::InputError(project.TrainReport(), "contains no block of a finished training", "Give the folder of a finished `skyquilt run`");
  }
  return run;
}

RankShares ShareAmongRanks(const MeasuredRun& run, const RankShareOptions& options) {
  if (options.blocks < 0 || options.blocks > 1'000'000) throw base::UsageError("--blocks must be from 1 to 1000000");
  std::vector<int> counts = options.ranks;
  std::sort(counts.begin(), counts.end());
  if (counts.empty() || counts.front() < 1 || std::adjacent_find(counts.begin(), counts.end()) != counts.end()) {
    throw base::UsageError("--rank-counts needs different numbers, 1 or more each");
  }
  RankShares shares{.run = Grown(run, options.blocks), .measured_blocks = static_cast<int>(run.block_seconds.size()), .rows = {}};
  double own_s = 0.0, divided_s = 0.0;
  for (const StageWork& stage : shares.run.stages) {
    own_s += stage.own_s;
    divided_s += stage.divided_s;
  }
  for (const int ranks : counts) {
    shares.rows.push_back(
        {.ranks = ranks, .own_s = own_s, .divided_s = divided_s / std::max(1, ranks - 1), .blocks_s = BlocksSeconds(shares.run, ranks, options)});
  }
  return shares;
}

}  // namespace skyquilt::bench
