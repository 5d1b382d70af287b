// Priors where they have nothing to hold on to: planes of points that have none, patches across a step, normals of nothing, enormous weights.
#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "bench/numerics/groups.h"
#include "bench/numerics/prior_step_cases.h"
#include "core/base/random.h"
#include "worker/losses/loss.h"
#include "worker/losses/normal_loss.h"
#include "worker/planes/plane_fit.h"
#include "worker/planes/point_planes.h"
#include "worker/rays/ray_source.h"

namespace skyquilt::bench {
namespace {

using Eigen::Vector3d;

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

// Points that differ by roundings of coordinates far away may seem to have any plane, but it is one, and they are on it.
CaseResult PlanesOfRoundings() {
  base::Random random(5);
  Worst worst;
  int found = 0;
  for (int i = 0; i < 1000; ++i) {
    std::vector<Vector3d> points;
    for (int k = 0; k < 6; ++k) {
      const double z = 0.1 * random.Normal(), y = random.Normal(), x = random.Normal();
      points.emplace_back(kFarAway + 1e-10 * Vector3d(x, y, z));
    }
    const std::optional<worker::Plane> plane = worker::FitPlane(points);
    if (!plane) continue;
    ++found;
    worst.Take(std::abs(plane->normal.norm() - 1.0));
    for (const Vector3d& x : points) worst.Take(std::abs(plane->normal.dot(x - plane->point)));
  }
  return {.seen = fmt::format("{} of 1000 sets have a plane", found), .worst = worst.value(), .holds = found > 0};
}

// A survey from 60 m height with 3 cm per pixel.
constexpr double kPatchHeight_m = 60.0, kPatchGsd_m = 0.03, kPatchVoxel_m = 0.06;

// The derivative of the planar loss by the distance at which a ray ends, relative to that one voxel above a plane that is seen from above.
double PullOf(const worker::Plane& plane, const Vector3d& x, const Vector3d& direction) {
  constexpr double kVoxel_gsd = kPatchVoxel_m / kPatchGsd_m;
  const double off_gsd = (x - plane.point).dot(plane.normal) / kPatchGsd_m;
  return std::abs(worker::RobustLoss(1.0, off_gsd, kVoxel_gsd).gradient * plane.normal.dot(direction)) /
         worker::RobustLoss(1.0, kVoxel_gsd, kVoxel_gsd).gradient;
}

// The middle of a plane of roof points, and points below.
CaseResult PointsBelowAPlane() {
  Worst worst;
  for (const double below_m : {1.0, 5.0, 1e3, 1e30, 1e150})
    worst.Take(PullOf({Vector3d::Zero(), Vector3d::UnitZ()}, {0, 0, -below_m}, -Vector3d::UnitZ()));
  return {.seen = "1 m to 10^150 m below", .worst = worst.value()};
}

// Pixels of one patch, seen at up to 45 degrees: three rays end on a roof, three beyond its edge, lower by the step. Points that are so few have a
// plane nearly always, and when the step is high it stands along the rays: what moves along a ray hardly leaves it.
CaseResult PatchesAtAStep(double step_m, bool planes_expected) {
  base::Random random(5);
  Worst worst;
  std::vector<double> pulls;
  constexpr int kPatches = 5000;
  int upright = 0;
  for (int i = 0; i < kPatches; ++i) {
    const double tilt = random.Uniform(0.0, 0.25 * std::numbers::pi), edge = random.Uniform(0.0, 2.0 * std::numbers::pi);
    const Vector3d ahead(std::sin(tilt), 0.0, -std::cos(tilt)), right = Vector3d::UnitY(), up = right.cross(ahead);
    const Vector3d camera = kPatchHeight_m / ahead.z() * ahead;
    const double pitch = kPatchGsd_m / camera.norm();
    struct Pixel {
      double beyond_edge = 0.0;
      Vector3d direction = Vector3d::Zero(), end = Vector3d::Zero();
    };
    std::vector<Pixel> pixels;
    for (int k = 0; k < worker::kSegmentRays; ++k) {
      const int column = static_cast<int>(random.Below(worker::kSegmentReach + 1)), row = static_cast<int>(random.Below(worker::kSegmentReach + 1));
      pixels.push_back({column * std::cos(edge) + row * std::sin(edge), (ahead + pitch * (column * right + row * up)).normalized()});
    }
    std::sort(pixels.begin(), pixels.end(), [](const Pixel& a, const Pixel& b) { return a.beyond_edge < b.beyond_edge; });
    std::vector<Vector3d> ends;
    for (size_t k = 0; k < pixels.size(); ++k) {
      const double height_m = 2 * k < pixels.size() ? 0.0 : -step_m;
      pixels[k].end = camera + (camera.z() - height_m) / -pixels[k].direction.z() * pixels[k].direction;
      ends.push_back(pixels[k].end);
    }
    const std::optional<worker::Plane> plane = worker::FitPlane(ends);
    if (!plane) continue;
    const std::optional<worker::Plane> wall = worker::UprightPlane(*plane);
    upright += wall ? 1 : 0;
    double pull = 0.0;
    for (const Pixel& pixel : pixels) {
      pull = std::max(pull, PullOf(*plane, pixel.end, pixel.direction));
      if (wall) pull = std::max(pull, PullOf(*wall, pixel.end, pixel.direction));
    }
    pulls.push_back(pull);
    worst.Take(pull);
  }
  std::sort(pulls.begin(), pulls.end());
  return {
      .seen = fmt::format("{:.0f} % have a plane, {:.0f} % one that is upright; median {:.2g}", 100.0 * static_cast<double>(pulls.size()) / kPatches,
                          100.0 * upright / kPatches, pulls.empty() ? 0.0 : pulls[pulls.size() / 2]),
      .worst = worst.value(),
      .holds = pulls.empty() != planes_expected};
}

CaseResult NormalsOfNothing() {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  const double tiny = std::numeric_limits<double>::denorm_min();
  Worst worst;
  for (const Vector3d& v : {Vector3d(0, 0, 0), Vector3d(tiny, tiny, -tiny), Vector3d(0, 0, -1e-200), Vector3d(nan, 0, -1), Vector3d(0, inf, -1)}) {
    for (const auto& loss : {worker::NormalLoss<double>(1.0, v, Vector3d::UnitZ()), worker::OrientationLoss<double>(1.0, v, Vector3d::UnitZ())}) {
      worst.Take(std::abs(loss.value));
      worst.Take(loss.gradient.norm());
    }
  }
  return {.seen = "5 vectors", .worst = worst.value()};
}

// The loss depends on the direction only, and its gradient times the length does not depend on the length.
CaseResult NormalsOfAnyLength() {
  const Vector3d direction = Vector3d(3, -4, -12) / 13.0, target = Vector3d::UnitZ();
  Worst worst;
  for (const double length : {1e-11, 1e-3, 1e3, 1e150, 1e300}) {
    const Vector3d v = length * direction;
    for (const bool of_normal : {true, false}) {
      const auto loss_of = [&](const Vector3d& of) {
        return of_normal ? worker::NormalLoss<double>(1.0, of, target) : worker::OrientationLoss<double>(1.0, of, target);
      };
      const worker::VectorLoss<double> loss = loss_of(v), unit = loss_of(direction);
      worst.Take(std::abs(loss.value / unit.value - 1.0));
      worst.Take((length * loss.gradient - unit.gradient).norm() / unit.gradient.norm());
    }
  }
  return {.seen = "lengths of 10^-11 to 10^300", .worst = worst.value()};
}

geo::BlockBox BoxAround(const Vector3d& middle) {
  geo::BlockBox box;
  box.min_enu = middle - Vector3d::Constant(100.0);
  box.max_enu = middle + Vector3d::Constant(100.0);
  return box;
}

CaseResult DegeneratePoints(const std::vector<Vector3d>& points) {
  survey::Survey survey;
  for (const Vector3d& x : points) survey.points.push_back({kFarAway + x, {}, 0.5F, 3});
  const worker::PointPlanes planes(survey, BoxAround(kFarAway), 0.05);
  const bool nowhere = planes.At(kFarAway, 1.0) == nullptr;
  return {.seen = fmt::format("{} planes", planes.planes().size()), .holds = planes.Empty() && nowhere};
}

// Hundreds of points have the same plane far away as here, and no other place has it.
CaseResult LevelGround() {
  Worst worst;
  bool holds = true;
  int planes_found = 0;
  for (const Vector3d& middle : {Vector3d(Vector3d::Zero()), kFarAway}) {
    survey::Survey survey = LevelPoints({.offset_enu = middle}, 0.0);
    const worker::PointPlanes planes(survey, BoxAround(middle), 0.03);
    holds = holds && planes.planes().size() == 1 && planes.At(middle, 0.1) == planes.planes().data();
    planes_found += static_cast<int>(planes.planes().size());
    for (const worker::PointPlane& plane : planes.planes()) {
      worst.Take((plane.normal - Vector3d::UnitZ()).norm());
      worst.Take(std::abs(plane.point.z() - middle.z()));
    }
    const double inf = kEver;
    for (const Vector3d& x : {Vector3d(kNoNumber, 0, 0), Vector3d(0, 0, kNoNumber), Vector3d(inf, 0, 0), Vector3d(0, 0, -inf)}) {
      holds = holds && planes.At(middle + x, 0.1) == nullptr;
    }
    for (const double reach_m : {0.0, -1.0, kNoNumber}) holds = holds && planes.At(middle, reach_m) == nullptr;
  }
  return {.seen = fmt::format("{} planes", planes_found), .worst = worst.value(), .holds = holds};
}

}  // namespace

NumericGroup PriorsGroup(const NumericsOptions& options) {
  NumericGroup group{
      .id = "priors",
      .title = "Priors",
      .lead =
          "Losses of planes, points and normals where there is no plane, no normal, or an enormous weight, and their gradients against differences "
          "in double. What they cannot hold on to they leave alone, and what is off changes no bit."};
  const auto add = [&group](const std::string& name, const std::string& expected, const std::function<CaseResult()>& run) {
    group.cases.push_back({.name = name, .expected = expected, .run = run});
  };
  const auto add_within = [&group](const std::string& name, const std::string& expected, const std::string& unit, double limit,
                                   const std::function<CaseResult()>& run) {
    group.cases.push_back({.name = name, .expected = expected, .unit = unit, .limit = limit, .run = run});
  };
  const Vector3d x(1, 2, 3);
  add("Plane of three equal points", "none", [x] { return NoPlane({x, x, x}); });
  add("Plane of three points", "none: three always have one", [x] { return NoPlane({x, x + Vector3d::UnitX(), x + Vector3d::UnitY()}); });
  add("Plane of six equal points", "none", [x] { return NoPlane(std::vector<Vector3d>(6, x)); });
  add("Plane of a thousand equal points", "none", [] { return NoPlane(std::vector<Vector3d>(1000, {0.1, 0.2, 0.3})); });
  add("Plane of a collinear patch", "none", [] { return NoPlane(Line(0.0)); });
  add("Plane of a nearly collinear patch, 1 mm wide", "none", [] { return NoPlane(Line(1e-3)); });
  add("Plane of points that are not finite", "none", [x] {
    return NoPlane({x, x + Vector3d::UnitX(), Vector3d(kNoNumber, 0, 0), x + Vector3d::UnitY(), Vector3d(kEver, 0, 0)});
  });
  add_within("Planes of points that differ by roundings, at 10^5 m", "none, or a unit normal and a plane through the points", "absolute", 1e-9,
             PlanesOfRoundings);
  add_within("Points 1 m and more below their plane", "pulled less than 1 % as much as one voxel off it", "relative", 0.01, PointsBelowAPlane);
  // With the step, the plane along the rays becomes steeper.
  for (const auto& [step_m, limit] : {std::pair(2.0, 0.5), std::pair(5.0, 0.2)}) {
    add_within(fmt::format("Patches across a step of {:g} m", step_m), fmt::format("pulled less than {:g} of that one voxel off a plane", limit),
               "relative", limit, [step = step_m] { return PatchesAtAStep(step, true); });
  }
  add_within("Patches across a step of 20 m", "no plane", "relative", 0.0, [] { return PatchesAtAStep(20.0, false); });
  add_within("Normals of vectors of zero, denormal and infinite length", "no loss, no gradient", "absolute", 0.0, NormalsOfNothing);
  add_within("Normals of vectors of any length", "the loss of their direction", "relative", 1e-12, NormalsOfAnyLength);
  add("Planes of a hundred equal points, at 10^5 m", "none", [] { return DegeneratePoints(std::vector<Vector3d>(100, Vector3d::Zero())); });
  add("Planes of points on a line, at 10^5 m", "none", [] {
    std::vector<Vector3d> line;
    for (int i = 0; i < 100; ++i) line.emplace_back(0.1 * i, 0.0, 0.0);
    return DegeneratePoints(line);
  });
  add("Planes of 19 points, at 10^5 m", "none", [] {
    std::vector<Vector3d> few;
    for (int i = 0; i < 19; ++i) few.emplace_back(i % 5, i / 5, 0.0);
    return DegeneratePoints(few);
  });
  add_within("Plane of level points, here and at 10^5 m", "one, level; none where the place or the reach is NaN, infinite or 0", "absolute", 0.01,
             LevelGround);
  std::vector<NumericCase> steps = PriorStepCases(options.quick);
  std::move(steps.begin(), steps.end(), std::back_inserter(group.cases));
  return group;
}

}  // namespace skyquilt::bench
