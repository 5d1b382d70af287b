// The trainer against its double-precision reference: same start, same batches, same losses.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "bench/numerics/groups.h"
#include "bench/numerics/reference_trainer.h"
#include "bench/numerics/synthetic_trainer.h"
#include "core/page/curve_chart.h"

namespace skyquilt::bench {
namespace {

constexpr uint64_t kTrainerSeed = 5;
constexpr double kTrainerDistortion = 1e-2;
const SyntheticRays kTrainerRays{.rays = 96, .empty_share = 0.05F, .most_stops = 1.0F};

double PsnrDb(double squared_error) {
  return -10.0 * std::log10(squared_error);
}

// Gradients at the start and after some steps, each time at the same parameters.
CaseResult GradientFinding(const SyntheticOptions& scene, int steps_between) {
  SyntheticTrainer trainer(scene, kTrainerSeed, 1);
  const ReferenceTrainer reference(trainer.target(), trainer.field());
  base::Random random(11);
  Worst worst, worst_loss;
  for (int round = 0; round < 2; ++round) {
    const worker::RayBatch batch = trainer.Draw(kTrainerRays, random);
    const SyntheticTrainer::Gradients seen = trainer.GradientsOf(batch, kTrainerDistortion);
    std::vector<double> grid, networks, codes;
    const ReferenceState state = ReferenceState::From(trainer.state(), trainer.codes().state());
    const ReferenceResult exact = reference.Gradient(batch, state, kTrainerDistortion, &grid, &networks, &codes);
    worst.Take(RelativeDistance(seen.grid, grid));
    worst.Take(RelativeDistance(seen.networks, networks));
    if (!codes.empty()) worst.Take(RelativeDistance(seen.codes, codes));
    worst_loss.Take(std::abs(seen.result.loss / exact.loss - 1.0));
    for (int step = 0; round == 0 && step < steps_between; ++step) {
      trainer.Train(trainer.Draw(kTrainerRays, random), {.learning_rate = 1e-2, .network_l2 = 1e-6, .distortion = kTrainerDistortion});
    }
  }
  return {.seen = fmt::format("at the start and after {} steps; loss to {}", steps_between, FormatError(worst_loss.value(), "")),
          .worst = worst.value(),
          .holds = worst_loss.value() <= 1e-5};
}

NumericCase GradientCase(const std::string& name, const SyntheticOptions& scene, int steps) {
  return {.name = name,
          .expected = "loss to 10^-5; gradients of grid, networks and codes, each as a vector, to 10^-4",
          .unit = "relative",
          .limit = 1e-4,
          .run = [scene, steps] { return GradientFinding(scene, steps); }};
}

// Differences between two runs of the same training, step by step.
struct Runs {
  std::vector<std::pair<double, double>> parameters, loss;  // step, relative difference
  double psnr_gap_db = 0.0, psnr_db = 0.0;
  bool finite = true;
};

// Distance between two sets of parameters, divided by the distance from the start.
double ShareOfWay(const ReferenceState& a, const ReferenceState& b, const ReferenceState& start) {
  double apart = 0.0, way = 0.0;
  const auto add = [&](const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& from) {
    for (size_t i = 0; i < x.size(); ++i) {
      apart += (x[i] - y[i]) * (x[i] - y[i]);
      way += (y[i] - from[i]) * (y[i] - from[i]);
    }
  };
  add(a.grid, b.grid, start.grid);
  add(a.networks, b.networks, start.networks);
  return std::sqrt(apart / way);
}

worker::StepOptions FreeRunOptions(int step) {
  return {.learning_rate = 1e-2 * std::min(1.0, (step + 1) / 10.0), .network_l2 = 1e-6, .distortion = kTrainerDistortion};
}

// Runs the reference and the trainer side by side (disturbed = false), or the reference twice, once from parameters changed by a factor of
// 1 +- 2^-24, the size of one rounding to float.
Runs FreeRun(int steps, bool disturbed) {
  SyntheticTrainer trainer({}, kTrainerSeed, 1);
  const ReferenceTrainer reference(trainer.target(), trainer.field());
  const ReferenceState start = ReferenceState::From(trainer.state());
  ReferenceState exact = start, other = start;
  base::Random random(13), noise(19);
  if (disturbed) {
    for (auto* values : {&other.grid, &other.networks}) {
      for (double& value : *values) value *= 1.0 + std::exp2(-24.0) * (noise.Uniform() < 0.5F ? -1.0 : 1.0);
    }
  }
  Runs runs;
  for (int step = 0; step < steps; ++step) {
    const worker::RayBatch batch = trainer.Draw(kTrainerRays, random);
    const worker::StepOptions options = FreeRunOptions(step);
    const ReferenceResult wanted = reference.Step(batch, options, exact);
    double loss = 0.0;
    if (disturbed) {
      loss = reference.Step(batch, options, other).loss;
    } else {
      const worker::StepResult seen = trainer.Train(batch, options);
      runs.finite = runs.finite && seen.finite;
      loss = seen.loss;
      other = ReferenceState::From(trainer.state());
    }
    runs.loss.emplace_back(step + 1, std::abs(loss / wanted.loss - 1.0));
    runs.parameters.emplace_back(step + 1, ShareOfWay(other, exact, start));
  }
  SyntheticRays held_out;
  held_out.rays = 500;
  const worker::RayBatch test = trainer.Draw(held_out, random);
  runs.psnr_db = PsnrDb(reference.Gradient(test, exact, 0.0, nullptr, nullptr).squared_error);
  // Parameters of the trainer are scored with the trainer's own forward pass.
  const double other_error =
      disturbed ? reference.Gradient(test, other, 0.0, nullptr, nullptr).squared_error : trainer.GradientsOf(test, 0.0).result.squared_error;
  runs.psnr_gap_db = std::abs(PsnrDb(other_error) - runs.psnr_db);
  return runs;
}

double LargestOf(const std::vector<std::pair<double, double>>& points) {
  Worst worst;
  for (const auto& [step, value] : points) worst.Take(value);
  return worst.value();
}

std::string RunsText(const Runs& runs) {
  return fmt::format("loss of a step differs by at most {}, parameters by {} of their distance from the start, held-out PSNR {:.3f} dB",
                     FormatError(LargestOf(runs.loss), ""), FormatError(LargestOf(runs.parameters), ""), runs.psnr_db);
}

CaseResult EmptyBatch() {
  SyntheticTrainer trainer({}, kTrainerSeed, 1);
  const TrainingState before = trainer.state();
  worker::RayBatch batch;
  batch.LayOutFeatures(trainer.field().FeatureRows());
  const worker::StepResult result = trainer.Train(batch, {.learning_rate = 1e-2, .network_l2 = 0.0, .distortion = kTrainerDistortion});
  return {.seen = fmt::format("loss {}, {} samples, {}", result.loss, result.n_samples, result.finite ? "finite" : "not finite"),
          .worst = result.loss,
          .holds = result.finite && SameParameters(before, trainer.state())};
}

// One ray with none, one or all of its samples.
CaseResult OneRay() {
  Worst worst;
  bool holds = true;
  std::string counts;
  base::Random random(29);
  for (const int64_t most : {0, 1, 1000}) {
    SyntheticTrainer trainer({}, kTrainerSeed, 1);
    const worker::RayBatch full = trainer.Draw({.rays = 1}, random);
    worker::RayBatch batch;
    worker::BatchRay ray = full.rays.at(0);
    ray.count = std::min(ray.count, most);
    batch.Append(ray, full.x.data(), full.y.data(), full.z.data(), full.sharpness.data(), full.t.data(), full.unit_length.data(), full.cell.data());
    batch.LayOutFeatures(trainer.field().FeatureRows());
    const ReferenceTrainer reference(trainer.target(), trainer.field());
    std::vector<double> grid, networks;
    const ReferenceResult exact = reference.Gradient(batch, ReferenceState::From(trainer.state()), 0.0, &grid, &networks);
    const SyntheticTrainer::Gradients seen = trainer.GradientsOf(batch, 0.0);
    worst.Take(std::abs(seen.result.loss / exact.loss - 1.0));
    if (ray.count > 0) worst.Take(RelativeDistance(seen.networks, networks));
    holds = holds && seen.result.finite && seen.result.n_rays == 1;
    counts += fmt::format("{}{}", counts.empty() ? "" : ", ", ray.count);
  }
  return {.seen = counts + " samples", .worst = worst.value(), .holds = holds};
}

}  // namespace

NumericGroup TrainerGroup(const NumericsOptions& options) {
  const int steps = options.quick ? 20 : 50;
  const auto curves = std::make_shared<std::vector<page::Curve>>();
  const auto keep = [curves](const Runs& runs, const std::string& name, bool emphasised) {
    curves->push_back({.name = name, .points = runs.parameters, .emphasised = emphasised});
  };
  SyntheticOptions tiny, deep, fine, softplus, relu, codes;
  tiny.log2_table_size = 1;
  deep.color_hidden_layers = 3;
  deep.features = 4;
  deep.hidden = 24;
  fine.voxel_m = 0.004;  // 2000 cells along an edge: positions within a cell lose eleven bits
  fine.log2_table_size = 14;
  softplus.density_activation = field::DensityActivation::kSoftplus;
  relu.density_activation = field::DensityActivation::kRelu;
  codes.appearance = 5;
  NumericGroup group{
      .id = "trainer",
      .title = "Trainer",
      .lead =
          "The worker's training step (float, batched, vectorised) against a reference trainer that does the same ray by ray in double: "
          "encoding, networks, compositing, losses with distortion and empty rays, exposures of plus and minus one stop, Adam with untouched "
          "entries. Rays and samples are the same."};
  group.cases = {
      GradientCase("Gradients", {}, steps),
      GradientCase("Gradients, table of 2^1", tiny, steps),
      GradientCase("Gradients, four features and three colour layers", deep, steps),
      GradientCase("Gradients, 2000 cells along an edge", fine, std::min(steps, 20)),
      GradientCase("Gradients, density by softplus", softplus, steps),
      GradientCase("Gradients, density by relu", relu, steps),
      GradientCase("Gradients, a code of five numbers per photo", codes, steps),
      {.name = "A batch of no rays", .expected = "loss 0, nothing changes", .unit = "loss", .limit = 0.0, .run = EmptyBatch},
      {.name = "A batch of one ray", .expected = "loss and gradients as the reference", .unit = "relative", .limit = 1e-4, .run = OneRay},
      {.name = fmt::format("{} steps of training", steps),
       .expected = "held-out PSNR within 0.01 dB, loss of every step within 0.1 %",
       .unit = "dB",
       .limit = 0.01,
       .run =
           [steps, keep] {
             const Runs runs = FreeRun(steps, false);
             keep(runs, "float trainer against double", true);
             return CaseResult{.seen = RunsText(runs), .worst = runs.psnr_gap_db, .holds = runs.finite && LargestOf(runs.loss) <= 1e-3};
           }},
      {.name = "Instead: the double trainer against itself",
       .expected = "started once from parameters changed by one rounding to float: a difference that no float trainer can avoid",
       .unit = "dB",
       .for_comparison = true,
       .run =
           [steps, keep] {
             const Runs runs = FreeRun(steps, true);
             keep(runs, "double against itself, disturbed by one rounding", false);
             return CaseResult{.seen = RunsText(runs), .worst = runs.psnr_gap_db};
           }},
  };
  group.charts = [curves] {
    return std::vector<std::string>{page::CurveChart(*curves, {.title = "Difference between runs of the same training",
                                                               .x_label = "step",
                                                               .y_label = "parameter difference / distance from the start",
                                                               .log_y = true})};
  };
  return group;
}

}  // namespace skyquilt::bench
