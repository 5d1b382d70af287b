#include "bench/schedule_bench.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>

#include "bench/simulated_ranks.h"
#include "coordinator/scheduler/block_queue.h"
#include "coordinator/scheduler/coordinate.h"
#include "core/base/errors.h"
#include "core/base/progress.h"
#include "core/base/random.h"
#include "core/base/system.h"
#include "core/scene/train_report.h"

namespace skyquilt::bench {
namespace {

// One stream of random numbers per quantity, so that changing one option does not change the random numbers of the others.
enum Stream : uint64_t { kCost = 1, kError = 2, kSpeed = 3, kStraggler = 4, kFailure = 5 };

double CpuSeconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

struct Cluster {
  std::vector<double> work_s;  // seconds of every block on a rank of speed 1
  std::vector<double> cost;    // estimated cost of every block
  std::vector<double> speed;
  std::vector<double> fails_at_s;
  double Work() const { return std::accumulate(work_s.begin(), work_s.end(), 0.0); }
};

Cluster MakeCluster(const ScheduleBenchOptions& o) {
  Cluster cluster;
  base::Random cost(o.seed, kCost), error(o.seed, kError), speed(o.seed, kSpeed), straggler(o.seed, kStraggler), failure(o.seed, kFailure);
  for (int i = 0; i < o.blocks; ++i) {
    const auto n = static_cast<uint32_t>(o.measured_seconds.size());
    cluster.work_s.push_back(n > 0 ? o.measured_seconds[cost.Below(n)] : std::exp(o.cost_spread * cost.Normal()));
  }
  const double scale = o.block_seconds * o.blocks / cluster.Work();
  for (double& work : cluster.work_s) {
    work *= scale;
    cluster.cost.push_back(work * std::exp(o.cost_error * error.Normal()));
  }
  for (int i = 0; i < o.ranks; ++i) {
    const double half = straggler.UniformDouble() < o.stragglers ? 0.5 : 1.0;
    cluster.speed.push_back(half * std::exp(o.speed_spread * speed.Normal()));
  }
  const double span_s = cluster.Work() / o.ranks;
  for (int i = 0; i < std::lround(o.failing * o.ranks); ++i) cluster.fails_at_s.push_back(failure.Uniform(0.0, span_s));
  std::sort(cluster.fails_at_s.begin(), cluster.fails_at_s.end());
  return cluster;
}

ScheduleRun Simulate(const ScheduleBenchOptions& o, const Cluster& cluster, const std::vector<double>& fails_at_s, base::Progress& progress) {
  ScheduleRun run;
  std::vector<double> left_s = cluster.work_s;
  std::vector<bool> counted(left_s.size(), false);
  const double cpu_before = CpuSeconds();
  double now_s = 0.0;
  int64_t messages = 0, bytes = 0;
  std::vector<coordinator::QueueBlock> blocks;
  blocks.reserve(static_cast<size_t>(o.blocks));
  for (int i = 0; i < o.blocks; ++i) blocks.push_back({i, "block_" + std::to_string(i), cluster.cost[static_cast<size_t>(i)], 0.0});
  for (bool done = false; !done;) {
    const std::vector<double> ahead(fails_at_s.begin() + std::min<ptrdiff_t>(run.restarts, std::ssize(fails_at_s)), fails_at_s.end());
    SimulatedRanks ranks(cluster.speed, cluster.work_s, left_s, ahead, o.skip_s, o.move_s, o.status_every_s, now_s);
    coordinator::BlockQueue queue(blocks, {.steps = 1, .n_workers = o.ranks - 1, .seed = o.seed});
    coordinator::CoordinateHooks hooks;
    hooks.now_s = [&ranks] { return ranks.now_s(); };
    hooks.handed_out = [](const coordinator::FieldJob&, int) {};
    hooks.status = [](const coordinator::FieldJob&, const worker::TrainStatus&) {};
    hooks.moved = [&run](const coordinator::FieldJob&, int, int) { ++run.moves; };
    hooks.finished = [&](const coordinator::FieldOutcome& outcome, bool) {
      const auto block = static_cast<size_t>(outcome.job.block);
      if (!counted[block]) progress.Advance();
      counted[block] = true;
    };
    try {
      coordinator::CoordinateBlocks(ranks, queue, {}, 1, hooks);
      done = true;
    } catch (const RankLost&) {
      ++run.restarts;
      left_s = ranks.LeftAfterLoss(o.checkpoint_every_s);
    }
    now_s = ranks.now_s() + (done ? 0.0 : o.restart_s);
    messages += ranks.messages();
    bytes += ranks.bytes_sent();
  }
  run.wall_s = now_s;
  run.efficiency = cluster.Work() / (o.ranks * now_s);
  run.messages_per_second = static_cast<double>(messages) / now_s;
  run.bytes_per_second = static_cast<double>(bytes) / now_s;
  run.coordinator_load = (CpuSeconds() - cpu_before) / now_s;
  return run;
}

}  // namespace

void ScheduleBenchOptions::Check() const {
  if (blocks < 1 || blocks > 10'000'000) throw base::UsageError("--blocks must be from 1 to 10000000");
  if (ranks < 2 || ranks > 1'000'000) throw base::UsageError("--ranks must be from 2 to 1000000: rank 0 hands out blocks, the others train");
  if (!(block_seconds > 0.0) || !(checkpoint_every_s > 0.0) || !(status_every_s > 0.0)) {
    throw base::UsageError("--block-seconds, --checkpoint-every and --status-every must be positive");
  }
  if (!(cost_spread >= 0.0) || !(cost_error >= 0.0) || !(speed_spread >= 0.0) || !(restart_s >= 0.0) || !(skip_s >= 0.0) || !(move_s >= 0.0)) {
    throw base::UsageError("--cost-spread, --cost-error, --speed-spread, --restart-seconds, --skip-seconds and --move-seconds must not be negative");
  }
  if (!(stragglers >= 0.0 && stragglers <= 1.0) || !(failing >= 0.0 && failing <= 1.0)) {
    throw base::UsageError("--stragglers and --failing must be from 0 to 1");
  }
}

ScheduleBenchResult RunScheduleBench(const ScheduleBenchOptions& options) {
  options.Check();
  const int64_t rss_before = base::PeakRssBytes();
  ScheduleBenchResult result;
  result.options = options;
  const Cluster cluster = MakeCluster(options);
  result.work_s = cluster.Work();
  result.longest_s = *std::max_element(cluster.work_s.begin(), cluster.work_s.end());
  base::Progress progress("schedule", 2.0 * options.blocks, "blocks");
  result.undisturbed = Simulate(options, cluster, {}, progress);
  result.failing = Simulate(options, cluster, cluster.fails_at_s, progress);
  progress.Finish();
  result.coordinator_bytes = base::PeakRssBytes() - rss_before;
  return result;
}

std::vector<double> MeasuredBlockSeconds(const std::string& train_json) {
  std::vector<double> seconds;
  for (const scene::FieldTraining& field : scene::ReadTrainReport(train_json).fields) {
    if (field.block >= 0 && field.ok) seconds.push_back(field.seconds);
  }
  std::erase_if(seconds, [](double s) { return !(s > 0.0); });
  if (seconds.empty()) throw base::InputError(train_json, "contains no trained block", "Give the train.json of a finished training");
  return seconds;
}

}  // namespace skyquilt::bench
