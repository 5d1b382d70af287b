#include "bench/kernel_bench.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <stdexcept>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/order_statistics.h"
#include "core/base/progress.h"
#include "core/base/random.h"
#include "core/base/system.h"
#include "core/encoding/hash_grid.h"
#include "core/kernel/kernels.h"
#include "core/kernel/machine_limits.h"
#include "worker/step/field_step.h"
#include "worker/step/random_batch.h"

namespace skyquilt::bench {
namespace {

using Clock = std::chrono::steady_clock;

double Since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

render::TrainedField MakeField(const KernelBenchOptions& options) {
  render::TrainedField f;
  f.map = encoding::SpaceMap::Box(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones());
  f.step_m = 1.0 / options.samples_per_ray;
  f.config.grid.levels = options.levels;
  f.config.grid.features = options.features;
  f.config.grid.log2_table_size = options.log2_table_size;
  f.config.grid.base_resolution = 16;
  f.config.grid.finest_resolution = 2048;
  f.config.hidden = options.hidden;
  f.config.color_hidden_layers = options.color_hidden_layers;
  f.config.sh_degree = options.sh_degree;
  return f;
}

// Measures the limit with all threads working at once.
void MeasureLimits(const KernelBenchOptions& options, const field::HashField& field, base::ThreadPool& threads, KernelSpeed* speed) {
  const auto n = static_cast<size_t>(threads.size());
  std::vector<double> flops(n), gather(n), scatter(n);
  const double seconds = 0.2 * options.seconds;
  threads.ParallelFor(threads.size(), [&](int64_t task, int) { flops[static_cast<size_t>(task)] = kernel::MeasureFlops(seconds); });
  std::map<uint32_t, int> levels_of_size;
  const encoding::HashGrid grid(field.config().grid);
  for (int l = 0; l < grid.levels(); ++l) ++levels_of_size[grid.level(l).entries];
  double gather_s = 0.0, scatter_s = 0.0;
  for (const auto& [entries, count] : levels_of_size) {
    threads.ParallelFor(threads.size(), [&, entries = entries](int64_t task, int) {
      const kernel::AccessTimes times = kernel::MeasureAccess(entries, options.features, seconds / static_cast<double>(levels_of_size.size()));
      gather[static_cast<size_t>(task)] = times.gather_s;
      scatter[static_cast<size_t>(task)] = times.scatter_s;
    });
    // Rates of threads add up, so the mean is taken over rates and not over times.
    const auto mean = [&](const std::vector<double>& seconds_each) {
      double rate = 0.0;
      for (const double s : seconds_each) rate += 1.0 / s;
      return static_cast<double>(n) / rate;
    };
    gather_s += 8.0 * count * mean(gather);
    scatter_s += 8.0 * count * mean(scatter);
  }
  double total = 0.0;
  for (const double f : flops) total += f;
  const double per_thread = total / static_cast<double>(n);
  speed->gflops_per_thread = per_thread * 1e-9;
  speed->network_limit_s = field.TrainFlops() / per_thread;
  speed->gather_limit_s = gather_s;
  speed->scatter_limit_s = scatter_s;
  speed->roofline_train_samples_per_second = static_cast<double>(n) / (speed->network_limit_s + gather_s + scatter_s);
  speed->roofline_infer_samples_per_second = static_cast<double>(n) / (field.ForwardFlops() / per_thread + gather_s);
}

// Samples per second of `work`, which processes one batch; repeated for about `seconds`.
template <typename Work>
double Rate(int64_t batch_samples, double seconds, Work&& work) {
  const Clock::time_point start = Clock::now();
  int64_t batches = 0;
  do {
    base::ThrowIfCancelled();
    work();
    ++batches;
  } while (Since(start) < seconds);
  return static_cast<double>(batches * batch_samples) / Since(start);
}

KernelSpeed MeasureSpeed(const KernelBenchOptions& options, int n_threads, base::Progress& progress) {
  base::ThreadPool threads(n_threads);
  const render::TrainedField target = MakeField(options);
  const field::HashField field(target.config);
  field::Parameters parameters;
  parameters.Allocate(field);
  field::OptimizerState state;
  state.Allocate(field);
  base::Random random(11);
  field.Initialize(random, parameters.grid, parameters.networks);
  worker::PhaseTimes times(threads.size());
  worker::FieldStep step(target, field, nullptr, worker::LuminancePlan{}, threads, times);
  worker::RayBatch batch = worker::RandomBatch(options.batch_samples, options.samples_per_ray, field.FeatureRows(), 7);
  worker::StepOptions learning;
  learning.learning_rate = 1e-4;  // keeps densities low, so that no sample is hidden and skipped
  const int64_t samples = batch.n_samples;

  std::vector<KernelSpeed> rounds;
  std::vector<double> train, infer, roof_train, roof_infer;
  step.Train(batch, learning, parameters, state, nullptr);
  for (int round = 0; round < options.rounds; ++round) {
    KernelSpeed speed;
    MeasureLimits(options, field, threads, &speed);
    progress.Advance();
    times.Clear();
    const Clock::time_point start = Clock::now();
    speed.train_samples_per_second = Rate(samples, options.seconds, [&] { step.Train(batch, learning, parameters, state, nullptr); });
    const double thread_seconds = Since(start) * n_threads;
    const auto phases = times.Seconds();
    double busy = 0.0;
    for (size_t i = 0; i < phases.size(); ++i) {
      speed.train_share[i] = phases[i] / thread_seconds;
      busy += speed.train_share[i];
    }
    speed.waiting_share = std::max(0.0, 1.0 - busy);
    progress.Advance();
    speed.infer_samples_per_second = Rate(samples, 0.5 * options.seconds, [&] { step.Infer(batch, parameters); });
    progress.Advance();
    rounds.push_back(speed);
  }
  KernelSpeed result = rounds.front();
  result.threads = n_threads;
  const auto median = [&](auto member) {
    std::vector<double> values;
    values.reserve(rounds.size());
    for (const KernelSpeed& r : rounds) values.push_back(r.*member);
    result.*member = base::Median(values);
  };
  median(&KernelSpeed::train_samples_per_second);
  median(&KernelSpeed::infer_samples_per_second);
  median(&KernelSpeed::roofline_train_samples_per_second);
  median(&KernelSpeed::roofline_infer_samples_per_second);
  median(&KernelSpeed::gflops_per_thread);
  median(&KernelSpeed::network_limit_s);
  median(&KernelSpeed::gather_limit_s);
  median(&KernelSpeed::scatter_limit_s);
  median(&KernelSpeed::waiting_share);
  for (size_t i = 0; i < worker::kPhases; ++i) {
    std::vector<double> values;
    values.reserve(rounds.size());
    for (const KernelSpeed& r : rounds) values.push_back(r.train_share[i]);
    result.train_share[i] = base::Median(values);
  }
  return result;
}

}  // namespace

void KernelBenchOptions::Check() const {
  const auto require = [](bool ok, const char* flag, const std::string& rule) {
    if (!ok) throw base::UsageError(std::string(flag) + " must be " + rule);
  };
  require(threads >= 0 && threads <= 1024, "--threads", "0 (every core) to 1024");
  require(levels >= 1 && levels <= 16, "--levels", "1 to 16");
  require(features == 2 || features == 4, "--features", "2 or 4");
  require(levels * features % 4 == 0, "--levels", "such that levels times features is a multiple of 4");
  require(log2_table_size >= 1 && log2_table_size <= 24, "--log2-table-size", "1 to 24");
  require(hidden >= 4 && hidden <= 256 && hidden % 4 == 0, "--hidden", "a multiple of 4 up to 256");
  require(color_hidden_layers >= 1 && color_hidden_layers <= 3, "--color-hidden-layers", "1 to 3");
  require(sh_degree >= 1 && sh_degree <= 4, "--sh-degree", "1 to 4");
  require(samples_per_ray >= 1 && samples_per_ray <= 512, "--samples-per-ray", "1 to 512");
  require(batch_samples >= 1024 && batch_samples <= (int64_t{1} << 24), "--batch", "1024 to 16777216");
  require(seconds >= 0.01 && seconds <= 600.0, "--seconds", "0.01 to 600");
  require(rounds >= 1 && rounds <= 99, "--rounds", "1 to 99");
}

double KernelBenchResult::ScalingFraction() const {
  if (one_thread.empty()) return 1.0;
  const KernelSpeed& one = one_thread.front();
  return (all.train_samples_per_second / one.train_samples_per_second) /
         (all.roofline_train_samples_per_second / one.roofline_train_samples_per_second);
}

KernelBenchResult RunKernelBench(const KernelBenchOptions& options) {
  options.Check();
  if (!options.isa.empty()) {
    try {
      kernel::ForceInstructionSet(options.isa);
    } catch (const std::invalid_argument& error) {
      throw base::UsageError(std::string("--isa: ") + error.what());
    }
  }
  KernelBenchResult result;
  result.options = options;
  result.isa = kernel::ActiveInstructionSet();
  result.train_flops = field::HashField(MakeField(options).config).TrainFlops();
  const int threads = options.threads > 0 ? options.threads : base::UsableCores();
  const int runs = threads > 1 ? 2 : 1;
  base::Progress progress("bench kernel", 3.0 * options.rounds * runs + 1.0, "figures");
  result.all = MeasureSpeed(options, threads, progress);
  if (runs == 2) result.one_thread.push_back(MeasureSpeed(options, 1, progress));
  base::ThreadPool pool(threads);
  render::TrainedField field = MakeField(options);
  field.parameters.Allocate(field::HashField(field.config));
  result.samplers = MeasureSamplers(field, 0.25 * options.seconds, options.rounds, pool);
  progress.Advance();
  progress.Finish();
  return result;
}

}  // namespace skyquilt::bench
