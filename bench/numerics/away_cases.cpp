// The same training with the scene at increasing distances from the frame's origin: once with positions as the worker computes them, once from
// survey-wide coordinates in single precision.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "bench/numerics/groups.h"
#include "bench/numerics/synthetic_trainer.h"
#include "core/page/curve_chart.h"

namespace skyquilt::bench {
namespace {

struct AwayRun {
  int steps = 0, rays = 0, threads = 0;
};

// Held-out PSNR after a fixed training with the scene's centre at this position.
double PsnrAt(const Eigen::Vector3d& offset, bool naive, const AwayRun& run, bool* finite) {
  SyntheticOptions scene;
  scene.offset_enu = offset;
  scene.log2_table_size = 14;
  SyntheticTrainer trainer(scene, 3, run.threads);
  base::Random random(37);
  for (int step = 0; step < run.steps; ++step) {
    worker::RayBatch batch = trainer.Draw({.rays = run.rays}, random);
    if (naive) RepositionInFloat(trainer.target(), &batch);
    const double rate = 3e-2 * std::min(1.0, (step + 1) / 20.0) * std::pow(0.1, static_cast<double>(step) / run.steps);
    *finite = trainer.Train(std::move(batch), {.learning_rate = rate}).finite && *finite;
  }
  worker::RayBatch test = trainer.Draw({.rays = 4096}, random);
  if (naive) RepositionInFloat(trainer.target(), &test);
  *finite = *finite && AllFinite(trainer.state());
  return -10.0 * std::log10(trainer.GradientsOf(std::move(test), 0.0).result.squared_error);
}

struct AwayCurves {
  double home_db = kNoNumber;
  page::Curve ours{.name = "Skyquilt: double, then float in the block's frame", .points = {}, .emphasised = true, .marks = true};
  page::Curve naive{.name = "survey-wide float coordinates", .points = {}, .marks = true};
};

}  // namespace

NumericGroup AwayGroup(const NumericsOptions& options) {
  const AwayRun run{.steps = options.quick ? 120 : 300, .rays = 512, .threads = options.threads};
  const auto curves = std::make_shared<AwayCurves>();
  NumericGroup group{
      .id = "away",
      .title = "Away from the origin",
      .lead = fmt::format("One fixed training ({} steps of {} rays; a scene of 8 m with detail of half a metre, voxels of 0.1 m) with the "
                          "scene's centre at increasing distances from the frame's origin; held-out PSNR. Earth-centred coordinates are at 6400 km.",
                          run.steps, run.rays)};
  std::vector<double> distances = {0.0, 1e3, 1e4, 1e5, 1e6, 6.4e6};
  if (options.quick) distances = {0.0, 1e5, 6.4e6};
  for (const double distance : distances) {
    const Eigen::Vector3d offset = distance * Eigen::Vector3d(0.8, -0.6, 0.0);
    const std::string place = distance == 0.0 ? "at the origin" : fmt::format("{:g} km away", distance / 1e3);
    // A logarithmic axis cannot show zero.
    const double shown = std::max(distance, 10.0);
    group.cases.push_back({.name = "Training " + place,
                           .expected = "PSNR within 0.1 dB of the run at the origin",
                           .unit = "dB",
                           .limit = 0.1,
                           .run = [offset, run, curves, shown] {
                             bool finite = true;
                             const double psnr = PsnrAt(offset, false, run, &finite);
                             if (std::isnan(curves->home_db)) curves->home_db = psnr;
                             curves->ours.points.emplace_back(shown, psnr);
                             return CaseResult{.seen = fmt::format("{:.3f} dB", psnr), .worst = std::abs(psnr - curves->home_db), .holds = finite};
                           }});
  }
  for (const double distance : distances) {
    if (distance == 0.0) continue;
    const Eigen::Vector3d offset = distance * Eigen::Vector3d(0.8, -0.6, 0.0);
    group.cases.push_back({.name = fmt::format("Instead: survey-wide float, {:g} km away", distance / 1e3),
                           .expected = "the same training with positions in single precision",
                           .unit = "dB",
                           .for_comparison = true,
                           .run = [offset, run, curves, distance] {
                             bool finite = true;
                             const double psnr = PsnrAt(offset, true, run, &finite);
                             curves->naive.points.emplace_back(distance, psnr);
                             return CaseResult{.seen = fmt::format("{:.3f} dB", psnr), .worst = std::abs(psnr - curves->home_db), .holds = finite};
                           }});
  }
  group.charts = [curves] {
    return std::vector<std::string>{page::CurveChart({curves->ours, curves->naive}, {.title = "The same training at increasing distances",
                                                                                     .x_label = "distance from the origin, m (10 m: at the origin)",
                                                                                     .y_label = "held-out PSNR, dB",
                                                                                     .log_x = true})};
  };
  return group;
}

}  // namespace skyquilt::bench
