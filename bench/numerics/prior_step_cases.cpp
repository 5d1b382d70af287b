#include "bench/numerics/prior_step_cases.h"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "bench/numerics/prior_reference.h"
#include "bench/numerics/synthetic_trainer.h"
#include "worker/planes/point_planes.h"

namespace skyquilt::bench {
namespace {

using Eigen::Vector3d;
using worker::StepPriors;

constexpr uint64_t kPriorSeed = 9;
constexpr double kPointsGsd_m = 0.03;
// Of a field in which rays end where they enter, so that every prior has something to hold on to.
constexpr double kDense = 1.0;

struct Prior {
  const char* name;
  double StepPriors::*weight;
};
constexpr Prior kPriors[] = {{"planar", &StepPriors::planar}, {"upright", &StepPriors::upright}, {"planes", &StepPriors::planes},
                             {"points", &StepPriors::points}, {"normals", &StepPriors::normals}, {"orientation", &StepPriors::orientation}};

StepPriors AllAt(double weight) {
  StepPriors priors;
  for (const Prior& prior : kPriors) priors.*prior.weight = weight;
  return priors;
}
StepPriors Only(const Prior& prior, double weight) {
  StepPriors priors;
  priors.*prior.weight = weight;
  return priors;
}

// Rays in groups of segments, towards points that are in front of, among and far behind their samples and known as well as never.
worker::RayBatch DrawWithPriors(const SyntheticTrainer& trainer, int rays, base::Random& random) {
  worker::RayBatch batch = trainer.Draw({.rays = rays, .least_width_m = 0.02, .most_width_m = 0.2}, random);
  for (const worker::Packet& packet : batch.packets) {
    for (int64_t k = 0; k < packet.n_rays; ++k) {
      worker::BatchRay& ray = batch.rays[static_cast<size_t>(packet.first_ray + k)];
      ray.segment = packet.first_ray + k / worker::kSegmentRays;
      if (ray.ray.pixel_pitch == 0.0F) ray.ray.pixel_pitch = 1e-3F;
      const float sigmas_m[] = {1e-30F, 0.1F, 1e30F};
      const float distances_m[] = {1e30F, 0.0F};
      ray.ray.point_sigma_m = sigmas_m[k % 3];
      ray.ray.point_distance_m = k % 5 < 2 ? distances_m[k % 5] : batch.t[static_cast<size_t>(ray.begin)];
    }
  }
  return batch;
}

// Where rays of a dense field end.
double EndHeight_m(const SyntheticOptions& scene) {
  return scene.height_m - 0.5 - scene.voxel_m;
}

enum class Tables {
  kRandom,  // the density changes from place to place
  kZero,    // it has no gradient anywhere
};

struct PriorTask {
  SyntheticOptions scene;
  StepPriors priors = {};  // weights
  Tables tables = Tables::kRandom;
  int threads = 1;
  bool planes = true;  // whether a plane of points is known
  int steps = 4;
};

struct PriorRun {
  TrainingState state;
  double first_loss = 0.0;
  bool finite = true;
};

PriorRun TrainWithPriors(const PriorTask& task) {
  SyntheticTrainer trainer(task.scene, kPriorSeed, task.threads);
  base::Random random(41);
  for (float& value : trainer.state().parameters.grid) value = task.tables == Tables::kZero ? 0.0F : random.Uniform() - 0.5F;
  const survey::Survey survey = LevelPoints(task.scene, EndHeight_m(task.scene));
  const worker::PointPlanes planes(survey, trainer.target().box, kPointsGsd_m);
  worker::StepOptions options{.learning_rate = 1e-2, .network_l2 = 1e-6, .priors = task.priors};
  if (task.planes || options.priors.Distances()) options.priors.voxel_m = task.scene.voxel_m;
  if (task.planes) options.priors.known_planes = &planes;
  PriorRun run;
  for (int step = 0; step < task.steps; ++step) {
    const worker::StepResult result = trainer.Train(DrawWithPriors(trainer, 120, random), options);
    if (step == 0) run.first_loss = result.loss;
    run.finite = run.finite && result.finite;
  }
  run.state = trainer.state();
  run.finite = run.finite && AllFinite(run.state);
  return run;
}

bool SameRun(const PriorRun& a, const PriorRun& b) {
  return a.first_loss == b.first_loss && SameParameters(a.state, b.state);
}

// Without it, no other case would say anything.
CaseResult EachActs(const SyntheticOptions& scene) {
  const PriorRun off = TrainWithPriors({.scene = scene});
  std::string acting;
  int count = 0;
  for (const Prior& prior : kPriors) {
    const PriorRun run = TrainWithPriors({.scene = scene, .priors = Only(prior, 1.0)});
    if (!run.finite || SameParameters(run.state, off.state) || !(run.first_loss > off.first_loss)) continue;
    acting += (count++ > 0 ? ", " : "") + std::string(prior.name);
  }
  return {.seen = acting, .holds = count == static_cast<int>(std::size(kPriors))};
}

CaseResult FiniteSteps(PriorTask task) {
  const PriorRun run = TrainWithPriors(task);
  task.threads = 3;
  const bool same = SameRun(run, TrainWithPriors(task));
  return {.seen = fmt::format("{}, {}", run.finite ? "finite" : "not finite", same ? "same bits" : "other bits"), .holds = run.finite && same};
}

CaseResult OffChangesNothing(const SyntheticOptions& scene) {
  const PriorRun without = TrainWithPriors({.scene = scene, .planes = false}), off = TrainWithPriors({.scene = scene});
  const bool same = SameRun(without, off);
  return {.seen = same ? "same bits" : "other bits", .holds = same};
}

// Where the density has no gradient, its normal has no loss and the head no target; distances have a loss all the same.
CaseResult NoGradient(const SyntheticOptions& scene, double weight) {
  const auto run = [&scene](const StepPriors& priors) {
    return TrainWithPriors({.scene = scene, .priors = priors, .tables = Tables::kZero, .planes = false, .steps = 1});
  };
  StepPriors normals;
  normals.normals = normals.orientation = weight;
  const PriorRun off = run({}), with_normals = run(normals), planar = run(Only(kPriors[0], weight));
  const bool same = SameRun(off, with_normals), planar_acts = planar.first_loss > off.first_loss;
  return {.seen = fmt::format("normals: {}; planar: {}", same ? "same bits" : "other bits", planar_acts ? "a loss" : "no loss"),
          .holds = same && planar_acts && off.finite && planar.finite};
}

// What a prior adds to a step's gradient by every parameter of a small field, against central differences of its loss in double.
CaseResult Differences(const Prior& prior, int multisample) {
  constexpr double kStep = 1e-5;
  SyntheticOptions scene{.voxel_m = 0.5, .levels = 2, .log2_table_size = 4, .hidden = 4, .density_bias = kDense, .multisample = multisample};
  SyntheticTrainer trainer(scene, kPriorSeed, 1);
  base::Random random(47);
  for (float& value : trainer.state().parameters.grid) value = random.Uniform() - 0.5F;
  const worker::RayBatch batch = DrawWithPriors(trainer, 48, random);
  const survey::Survey survey = LevelPoints(scene, EndHeight_m(scene));
  const worker::PointPlanes planes(survey, trainer.target().box, kPointsGsd_m);
  StepPriors priors = Only(prior, 10.0);
  priors.voxel_m = scene.voxel_m;
  priors.known_planes = &planes;
  const SyntheticTrainer::Gradients with = trainer.GradientsOf(batch, priors), without = trainer.GradientsOf(batch, StepPriors{});
  const ReferenceField field(trainer.field());
  ReferenceState state = ReferenceState::From(trainer.state());
  const PriorReference reference(trainer.target(), field, batch, priors, state);
  Worst worst, worst_loss;
  const double loss = reference.Loss(state);
  worst_loss.Take(std::abs((with.result.loss - without.result.loss) / loss - 1.0));
  const auto compare = [&](const std::vector<double>& a, const std::vector<double>& b, std::vector<double>& values) {
    std::vector<double> seen, exact;
    for (size_t i = 0; i < values.size(); ++i) {
      const double at = values[i];
      values[i] = at + kStep;
      const double above = reference.Loss(state);
      values[i] = at - kStep;
      exact.push_back((above - reference.Loss(state)) / (2.0 * kStep));
      values[i] = at;
      seen.push_back(a[i] - b[i]);
    }
    worst.Take(RelativeDistance(seen, exact));
  };
  compare(with.grid, without.grid, state.grid);
  compare(with.networks, without.networks, state.networks);
  return {.seen = fmt::format("{} rays, {} losses of distance, {} of normals; loss to {}", batch.rays.size(), reference.pulls(), reference.normals(),
                              FormatError(worst_loss.value(), "")),
          .worst = worst.value(),
          .holds = loss > 0.0 && worst_loss.value() <= 1e-4};
}

}  // namespace

survey::Survey LevelPoints(const SyntheticOptions& scene, double height_m) {
  survey::Survey survey;
  base::Random random(3);
  const double half = 0.5 * scene.edge_m;
  for (int i = 0; i < 400; ++i) {
    const double up = height_m + 0.02 * random.Normal(), north = random.Uniform(-half, half), east = random.Uniform(-half, half);
    const Vector3d x(east, north, up);
    survey.points.push_back({scene.offset_enu + x, {}, 0.5F, 3});
  }
  return survey;
}

std::vector<NumericCase> PriorStepCases(bool quick) {
  std::vector<NumericCase> cases;
  const auto add = [&cases](const std::string& name, const std::string& expected, const std::function<CaseResult()>& run) {
    cases.push_back({.name = name, .expected = expected, .run = run});
  };
  const std::vector<std::pair<std::string, SyntheticOptions>> scenes = {
      {"points", {.density_bias = kDense, .normal_head = true}},
      {"cones", {.density_bias = kDense, .multisample = 1, .scale_features = true, .normal_head = true}},
      {"cones of 6", {.density_bias = kDense, .multisample = 6, .normal_head = true}}};
  for (const auto& [name, scene] : scenes) {
    if (quick && scene.multisample > 1) continue;
    add("Steps with each prior alone, " + name, "all six add to the loss and change the parameters", [scene = scene] { return EachActs(scene); });
    for (const double weight : {1.0, 1e3}) {
      const StepPriors all = AllAt(weight);
      add(fmt::format("Steps with all priors at weight {:g}, {}", weight, name), "finite; same bits with 3 threads",
          [scene = scene, all] { return FiniteSteps({.scene = scene, .priors = all}); });
      add(fmt::format("Steps from a density without gradient, all priors at weight {:g}, {}", weight, name), "finite; same bits with 3 threads",
          [scene = scene, all] { return FiniteSteps({.scene = scene, .priors = all, .tables = Tables::kZero}); });
    }
    add("One step from a density without gradient, " + name, "normals: same bits as without; planar: a loss",
        [scene = scene] { return NoGradient(scene, 1e3); });
    add("Steps with all priors off, " + name, "same bits as without planes and voxels", [scene = scene] { return OffChangesNothing(scene); });
  }
  const SyntheticOptions tall{.edge_m = 64.0, .height_m = 40.0, .voxel_m = 0.4, .density_bias = kDense, .normal_head = true};
  add("Steps of rays that begin and end inside the field, all priors at weight 1000", "finite; same bits with 3 threads",
      [tall] { return FiniteSteps({.scene = tall, .priors = AllAt(1e3), .steps = 20}); });
  for (const int multisample : {0, 1}) {
    for (const Prior& prior : kPriors) {
      cases.push_back({.name = fmt::format("Gradients of {} against differences in double, {}", prior.name, multisample > 0 ? "cones" : "points"),
                       .expected = "loss to 10^-4; every parameter's, as vectors of grid and networks",
                       .unit = "relative",
                       .limit = 1e-4,
                       .run = [&prior, multisample] { return Differences(prior, multisample); }});
    }
  }
  return cases;
}

}  // namespace skyquilt::bench
