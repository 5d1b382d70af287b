// Priors where they have nothing to hold on to: planes of points that have none, patches across a step, normals of nothing, enormous weights.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/numerics/groups.h"
#include "bench/numerics/synthetic_trainer.h"
#include "worker/losses/normal_loss.h"
#include "worker/losses/robust_loss.h"
#include "worker/plane_fit.h"
#include "worker/point_planes.h"

namespace skyquilt::bench {
namespace {

using Eigen::Vector3d;

constexpr uint64_t kPriorSeed = 9;
constexpr int kSegmentRays = 6;
const Vector3d kFarAway(2e5, -3e5, 4e3);  // corner of a large survey

// Points without a plane: the fit finds none, here and far away.
CaseResult NoPlane(const std::vector<Vector3d>& points) {
  int found = 0;
  for (const Vector3d& offset : {Vector3d(Vector3d::Zero()), kFarAway}) {
    std::vector<Vector3d> moved = points;
    for (Vector3d& x : moved) x += offset;
    found += worker::FitPlane(moved).has_value() ? 1 : 0;
  }
  return {.seen = found == 0 ? "none" : "a plane", .holds = found == 0};
}

std::vector<Vector3d> Line(double thickness_m) {
  std::vector<Vector3d> points;
  for (int i = 0; i < 6; ++i) points.emplace_back(i, 2.0 * i, thickness_m * (i % 2 == 0 ? 1.0 : -1.0));
  return points;
}

// Half of a patch is on a roof, half on the ground below: the derivative of the robust loss, relative to that of a point half a voxel off its plane.
CaseResult PatchAtAStep(double step_m) {
  constexpr double kVoxel_m = 0.1;
  std::vector<Vector3d> points;
  for (int i = 0; i < kSegmentRays; ++i) points.emplace_back(0.3 * i, 0.2 * (i % 2), i < kSegmentRays / 2 ? 0.0 : step_m);
  const std::optional<worker::Plane> plane = worker::FitPlane(points);
  if (!plane) return {.seen = "no plane", .worst = 0.0};
  const double held = worker::RobustLoss(1.0, 0.5 * kVoxel_m, kVoxel_m).gradient;
  Worst worst;
  for (const Vector3d& x : points) {
    const double off = (x - plane->point).dot(plane->normal);
    // Points that are as far apart as the step is high may have a plane that leans; what is near it stays held.
    if (std::abs(off) < 5.0 * kVoxel_m) continue;
    worst.Take(std::abs(worker::RobustLoss(1.0, off, kVoxel_m).gradient) / held);
  }
  return {.seen = "the loss lets go", .worst = worst.value()};
}

CaseResult NormalsOfNothing() {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  const double tiny = std::numeric_limits<double>::denorm_min();
  Worst worst;
  for (const Vector3d& v : {Vector3d(0, 0, 0), Vector3d(tiny, tiny, tiny), Vector3d(1e-200, 0, 0), Vector3d(nan, 0, 1), Vector3d(0, inf, 0)}) {
    for (const auto& loss : {worker::NormalLoss<double>(1.0, v, Vector3d::UnitZ()), worker::OrientationLoss<double>(1.0, v, Vector3d::UnitZ())}) {
      worst.Take(std::abs(loss.value));
      worst.Take(loss.gradient.norm());
    }
  }
  const auto huge = worker::NormalLoss<double>(1.0, Vector3d(1e300, 1e300, 0), Vector3d::UnitZ());
  return {.seen = fmt::format("loss of a huge vector {}", huge.value), .worst = worst.value(), .holds = huge.gradient.norm() < 1e-290};
}

// Rays in groups of segments, some of them towards points that are near, beside and far behind their samples.
worker::RayBatch DrawWithPriors(const SyntheticTrainer& trainer, base::Random& random) {
  worker::RayBatch batch = trainer.Draw({.rays = 120, .least_width_m = 0.02, .most_width_m = 0.2}, random);
  for (const worker::Packet& packet : batch.packets) {
    for (int64_t k = 0; k < packet.n_rays; ++k) {
      worker::BatchRay& ray = batch.rays[static_cast<size_t>(packet.first_ray + k)];
      ray.segment = packet.first_ray + k / kSegmentRays;
      if (ray.ray.pixel_pitch == 0.0F) ray.ray.pixel_pitch = 1e-3F;
      const float sigmas[] = {1e-30F, 0.1F, 1e30F};
      ray.ray.point_sigma_m = sigmas[k % 3];
      ray.ray.point_distance_m = k % 5 == 0 ? 1e30F : batch.t[static_cast<size_t>(ray.begin)];
    }
  }
  return batch;
}

// Sparse points on the ground of the synthetic scene.
survey::Survey GroundPoints(const SyntheticOptions& scene) {
  survey::Survey survey;
  base::Random random(3);
  for (int i = 0; i < 400; ++i) {
    const Vector3d x(random.Uniform(-4.0, 4.0), random.Uniform(-4.0, 4.0), 0.02 * random.Normal());
    survey.points.push_back({scene.offset_enu + x, {}, 0.5F, 3});
  }
  return survey;
}

struct PriorStep {
  SyntheticOptions scene;
  double weight = 0.0;
  bool zero_tables = false;  // the density has no gradient anywhere
  int threads = 1;
  bool known = true;  // whether planes are known
};

// A few steps with all priors. The state after them, and whether every step was finite.
std::pair<TrainingState, bool> TrainWithPriors(const PriorStep& task) {
  SyntheticTrainer trainer(task.scene, kPriorSeed, task.threads);
  if (task.zero_tables) std::fill(trainer.state().parameters.grid.begin(), trainer.state().parameters.grid.end(), 0.0F);
  const survey::Survey survey = GroundPoints(task.scene);
  const worker::PointPlanes planes(survey, trainer.target().box, 0.03);
  worker::StepOptions options{.learning_rate = 1e-2, .network_l2 = 1e-6};
  if (task.known) options.priors = {.voxel_m = task.scene.voxel_m, .known_planes = &planes};
  for (double worker::StepPriors::*weight : {&worker::StepPriors::planar, &worker::StepPriors::upright, &worker::StepPriors::planes,
                                             &worker::StepPriors::points, &worker::StepPriors::normals, &worker::StepPriors::orientation})
    options.priors.*weight = task.weight;
  base::Random random(41);
  bool finite = true;
  for (int step = 0; step < 8; ++step) finite = trainer.Train(DrawWithPriors(trainer, random), options).finite && finite;
  return {trainer.state(), finite};
}

CaseResult FiniteSteps(const PriorStep& task) {
  const auto [state, finite] = TrainWithPriors(task);
  PriorStep threaded = task;
  threaded.threads = 3;
  const bool same = SameParameters(state, TrainWithPriors(threaded).first);
  return {.seen = fmt::format("{}, {}", finite && AllFinite(state) ? "finite" : "not finite", same ? "same bits" : "other bits"),
          .holds = finite && AllFinite(state) && same};
}

CaseResult OffChangesNothing(const SyntheticOptions& scene) {
  const auto without = TrainWithPriors({.scene = scene, .known = false}), off = TrainWithPriors({.scene = scene});
  const auto on = TrainWithPriors({.scene = scene, .weight = 1.0});
  const bool same = SameParameters(without.first, off.first), differs = !SameParameters(without.first, on.first);
  return {.seen = fmt::format("{}; with weight 1 {}", same ? "same bits" : "other bits", differs ? "other bits" : "same bits"),
          .holds = same && differs};
}

CaseResult DegeneratePoints() {
  survey::Survey survey;
  const auto add = [&survey](const Vector3d& x) { survey.points.push_back({kFarAway + x, {}, 0.5F, 3}); };
  for (int i = 0; i < 100; ++i) add(Vector3d::Zero());
  for (int i = 0; i < 100; ++i) add(0.1 * i * Vector3d::UnitX());
  for (int i = 0; i < 19; ++i) add(Vector3d(i % 5, i / 5, 50.0));
  geo::BlockBox box;
  box.min_enu = kFarAway - Vector3d::Constant(100.0);
  box.max_enu = kFarAway + Vector3d::Constant(100.0);
  const worker::PointPlanes planes(survey, box, 0.05);
  const bool nowhere = planes.At(Vector3d::Constant(kNoNumber), 1.0) == nullptr;
  return {.seen = fmt::format("{} planes", planes.planes().size()), .holds = planes.Empty() && nowhere};
}

}  // namespace

NumericGroup PriorsGroup(const NumericsOptions& options) {
  NumericGroup group{
      .id = "priors",
      .title = "Priors",
      .lead =
          "Losses of planes, points and normals where there is no plane, no normal, or an enormous weight. What they cannot hold on to "
          "they leave alone, and what is off changes no bit."};
  const auto add = [&group](const std::string& name, const std::string& expected, const std::function<CaseResult()>& run) {
    group.cases.push_back({.name = name, .expected = expected, .run = run});
  };
  const Vector3d x(1, 2, 3);
  add("Plane of three equal points", "none", [x] { return NoPlane({x, x, x}); });
  add("Plane of three points", "none: three always have one", [x] { return NoPlane({x, x + Vector3d::UnitX(), x + Vector3d::UnitY()}); });
  add("Plane of six equal points", "none", [x] { return NoPlane(std::vector<Vector3d>(6, x)); });
  add("Plane of a collinear patch", "none", [] { return NoPlane(Line(0.0)); });
  add("Plane of a nearly collinear patch, 1 mm wide", "none", [] { return NoPlane(Line(1e-3)); });
  add("Plane of points that are not finite", "none", [x] {
    return NoPlane({x, x + Vector3d::UnitX(), Vector3d(kNoNumber, 0, 0), x + Vector3d::UnitY(), Vector3d(kEver, 0, 0)});
  });
  for (const double step_m : {2.0, 5.0, 100.0}) {
    group.cases.push_back({.name = fmt::format("Patch across a step of {:g} m", step_m),
                           .expected = "pulled less than a tenth as much as half a voxel off a plane",
                           .unit = "relative",
                           .limit = 0.1,
                           .run = [step_m] { return PatchAtAStep(step_m); }});
  }
  group.cases.push_back({.name = "Normals of vectors of zero, denormal and infinite length",
                         .expected = "no loss, no gradient",
                         .unit = "absolute",
                         .limit = 0.0,
                         .run = NormalsOfNothing});
  add("Planes of equal points, of a line, of 19 points, at 10^5 m", "none", DegeneratePoints);
  const std::vector<std::pair<std::string, SyntheticOptions>> scenes = {{"points", {.normal_head = true}},
                                                                        {"cones", {.multisample = 1, .scale_features = true, .normal_head = true}},
                                                                        {"cones of 6", {.multisample = 6, .normal_head = true}}};
  for (const auto& [name, scene] : scenes) {
    if (options.quick && scene.multisample > 1) continue;
    add("Steps where the density has no gradient, " + name, "finite; same bits with 3 threads",
        [scene = scene] { return FiniteSteps({.scene = scene, .weight = 1.0, .zero_tables = true}); });
    for (const double weight : {1.0, 1e3}) {
      add(fmt::format("Steps with all priors at weight {:g}, {}", weight, name), "finite; same bits with 3 threads",
          [scene = scene, weight] { return FiniteSteps({.scene = scene, .weight = weight}); });
    }
    add("Steps with all priors off, " + name, "same bits as without priors", [scene = scene] { return OffChangesNothing(scene); });
  }
  return group;
}

}  // namespace skyquilt::bench
