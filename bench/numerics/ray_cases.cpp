// Intersections of rays and boxes, and samples along rays. The reference does not use the slab method: it intersects the six planes one by one in
// long double and keeps the intersections that are on the box.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "bench/numerics/groups.h"
#include "bench/numerics/synthetic_scene.h"
#include "core/base/random.h"
#include "core/geo/ray_box.h"
#include "core/render/march.h"

namespace skyquilt::bench {
namespace {

struct RayCase {
  std::string name;
  Eigen::Vector3d origin, direction;
  double t_near, t_far;  // expected interval, metres; both 0: a miss
};

// Against the box [0, 10] x [0, 20] x [0, 5].
const std::vector<RayCase>& RayCases() {
  constexpr double kHalf = 0.70710678118654752;
  static const std::vector<RayCase> cases = {
      {"Starts inside", {5, 10, 2}, {0, 0, -1}, 0.0, 2.0},
      {"Starts inside, tilted", {5, 10, 2}, {kHalf, 0, -kHalf}, 0.0, 2.0 / kHalf},
      {"Hits from above", {5, 10, 100}, {0, 0, -1}, 95.0, 100.0},
      {"Looks away", {5, 10, 100}, {0, 0, 1}, 0.0, 0.0},
      {"Passes by", {-5, 10, 100}, {0, 0, -1}, 0.0, 0.0},
      {"Touches an edge only", {-1, 10, 1}, {kHalf, 0, -kHalf}, 0.0, 0.0},
      {"Touches a corner only", {-1, 1, 5}, {kHalf, -kHalf, 0}, 0.0, 0.0},
      {"Runs along a face", {0, -10, 2}, {0, 1, 0}, 10.0, 30.0},
      {"Runs along the far face", {10, -10, 2}, {0, 1, 0}, 10.0, 30.0},
      {"Runs along an edge", {0, -10, 5}, {0, 1, 0}, 10.0, 30.0},
      {"Runs beside a face", {-1e-12, -10, 2}, {0, 1, 0}, 0.0, 0.0},
      {"Zero components of either sign", {5, 10, 100}, {-0.0, 0.0, -1}, 95.0, 100.0},
      {"Starts on a face and enters", {5, 10, 5}, {0, 0, -1}, 0.0, 5.0},
      {"Starts on a face and leaves", {5, 10, 5}, {0, 0, 1}, 0.0, 0.0},
      {"Nearly parallel to a face", {5, 10, 2}, {1e-300, 1, 0}, 0.0, 10.0},
      {"From 100 km away", {-1e5, 10, 2}, {1, 0, 0}, 1e5, 1e5 + 10.0},
  };
  return cases;
}

NumericCase BoxCase(const RayCase& ray) {
  return {.name = ray.name,
          .expected = ray.t_far > ray.t_near ? fmt::format("inside from {:.4g} to {:.4g} m", ray.t_near, ray.t_far) : "an empty interval",
          .unit = "m",
          .limit = 1e-10,
          .run = [ray] {
            const geo::Interval interval = geo::RayBox(ray.origin, ray.direction, {0, 0, 0}, {10, 20, 5});
            Worst worst;
            worst.Take(std::abs(interval.t_near - ray.t_near));
            worst.Take(std::abs(interval.t_far - ray.t_far));
            return CaseResult{.seen = interval.Empty() ? "empty" : fmt::format("{:.4g} to {:.4g} m", interval.t_near, interval.t_far),
                              .worst = worst.value(),
                              .holds = interval.Empty() == !(ray.t_far > ray.t_near)};
          }};
}

struct Span {
  long double t_near, t_far;
};

// Empty when the ray misses. Intersections within 1e-12 m outside the box count too, because those on an edge are rounded to either side. For a ray
// at an angle of 1e-4 to a face this is 1e-8 m along the ray, the accuracy that is required of such rays.
std::optional<Span> ReferenceSpan(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, const Eigen::Vector3d& low,
                                  const Eigen::Vector3d& high) {
  constexpr long double kSlack = 1e-12L;
  std::vector<long double> crossings;
  bool inside = true;
  for (int axis = 0; axis < 3; ++axis) {
    inside = inside && origin[axis] >= low[axis] && origin[axis] <= high[axis];
    if (direction[axis] == 0.0) continue;
    for (const double face : {low[axis], high[axis]}) {
      const long double t = (static_cast<long double>(face) - static_cast<long double>(origin[axis])) / static_cast<long double>(direction[axis]);
      bool on_box = t >= 0.0L;
      for (int other = 0; other < 3; ++other) {
        if (other == axis) continue;
        const long double p = static_cast<long double>(origin[other]) + t * static_cast<long double>(direction[other]);
        on_box = on_box && p >= static_cast<long double>(low[other]) - kSlack && p <= static_cast<long double>(high[other]) + kSlack;
      }
      if (on_box) crossings.push_back(t);
    }
  }
  if (crossings.empty()) return std::nullopt;
  const auto [first, last] = std::minmax_element(crossings.begin(), crossings.end());
  return Span{inside ? 0.0L : *first, *last};
}

// Random boxes up to 100 km from the origin, random rays, a third of them with zero components.
CaseResult RandomBoxes(int rays) {
  base::Random random(53);
  Worst worst;
  int wrong = 0, hits = 0;
  for (int i = 0; i < rays; ++i) {
    const double far = i % 2 == 0 ? 0.0 : 1e5;
    Eigen::Vector3d low, high, origin, direction;
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = random.Uniform(-far, far);
      high[axis] = low[axis] + std::pow(10.0, random.Uniform(-1.0, 2.5));
      const double reach = (high[axis] - low[axis]) * 1.5;
      origin[axis] = random.Uniform(low[axis] - reach, high[axis] + reach);
      direction[axis] = i % 3 == 0 && random.Uniform() < 0.5F ? 0.0 : random.Normal();
    }
    if (i % 4 == 0) {  // towards the box
      for (int axis = 0; axis < 3; ++axis) direction[axis] = random.Uniform(low[axis], high[axis]) - origin[axis];
    }
    if (!(direction.norm() > 0.0)) continue;
    direction.normalize();
    const geo::Interval interval = geo::RayBox(origin, direction, low, high);
    const std::optional<Span> exact = ReferenceSpan(origin, direction, low, high);
    const long double length = exact ? exact->t_far - exact->t_near : 0.0L;
    if (interval.Empty()) {
      // An interval shorter than the rounding error may be a hit or a miss.
      if (length > 1e-9L) ++wrong;
      continue;
    }
    ++hits;
    if (!exact) {
      if (interval.t_far - interval.t_near > 1e-9) ++wrong;
      continue;
    }
    worst.Take(static_cast<double>(std::abs(static_cast<long double>(interval.t_near) - exact->t_near)));
    worst.Take(static_cast<double>(std::abs(static_cast<long double>(interval.t_far) - exact->t_far)));
  }
  return {
      .seen = fmt::format("{} rays, {} hits, {} judged wrongly", rays, hits, wrong), .worst = worst.value(), .holds = wrong == 0 && hits > rays / 4};
}

// Samples of random rays through a block: inside the interval, ascending, in the box, and one for each step.
CaseResult MarchedSamples(int rays) {
  const render::TrainedField field = SyntheticField({.offset_enu = {7e4, -3e4, 0.0}});
  base::Random random(59);
  Worst worst;
  int64_t samples = 0;
  int wrong = 0;
  const Eigen::Vector3d size = field.map.max_enu() - field.map.min_enu();
  for (int i = 0; i < rays; ++i) {
    Eigen::Vector3d origin, direction;
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis] = field.map.min_enu()[axis] + random.Uniform(-1.0, 2.0) * size[axis];
      direction[axis] = random.Uniform() < 0.2F ? 0.0 : random.Normal();
    }
    if (i % 5 == 0) origin.x() = field.map.min_enu().x();  // on a face
    if (i % 10 == 0) direction.x() = 0.0;                  // along it
    if (!(direction.norm() > 0.0)) continue;
    direction.normalize();
    const geo::Interval interval = render::FieldInterval(field.map, origin, direction);
    const render::UnitRay unit(field.map, origin, direction);
    double last = -kEver;
    int64_t count = 0;
    render::March(field, origin, direction, interval, field.step_m, random.Uniform(), [&](double t, double length, double, int64_t cell) {
      const Eigen::Vector3f p = unit.At(t);
      for (int axis = 0; axis < 3; ++axis) {
        worst.Take(std::max(-static_cast<double>(p[axis]), static_cast<double>(p[axis]) - field.map.extent()[axis]));
      }
      if (!(t > last && t >= interval.t_near && t <= interval.t_far && length == field.step_m && cell >= 0 && cell < field.occupancy.CellCount()))
        ++wrong;
      last = t;
      ++count;
      return true;
    });
    const double fit = interval.Empty() ? 0.0 : (interval.t_far - interval.t_near) / field.step_m;
    if (std::abs(static_cast<double>(count) - fit) > 1.0 + 1e-9) ++wrong;
    samples += count;
  }
  return {.seen = fmt::format("{} samples, {} rays or samples out of order", samples, wrong),
          .worst = worst.value(),
          .holds = wrong == 0 && samples > rays};
}

CaseResult ZeroLengthInterval() {
  const render::TrainedField field = SyntheticField({});
  int visits = 0;
  const Eigen::Vector3d origin(0.0, 0.0, 20.0), direction(0.0, 0.0, -1.0);
  const geo::Interval empty[3] = {{3.0, 3.0}, {5.0, 3.0}, {0.0, std::nan("")}};
  for (const geo::Interval& interval : empty) {
    render::March(field, origin, direction, interval, field.step_m, 0.5F, [&](double, double, double, int64_t) { return ++visits < 10; });
    render::MarchCoarse(field, origin, direction, interval, field.step_m, 0.5F, [&](double, double, double) { return ++visits < 10; });
  }
  return {.seen = fmt::format("{} samples", visits), .worst = static_cast<double>(visits)};
}

}  // namespace

NumericGroup RayGroup(const NumericsOptions& options) {
  const int rays = options.quick ? 20000 : 200000;
  NumericGroup group{.id = "rays",
                     .title = "Rays and boxes",
                     .lead =
                         "The interval of a ray inside a box, in metres along the ray. The named rays are tested with the box [0, 10] x [0, 20] x "
                         "[0, 5]; random rays are compared with plane by plane intersections in long double."};
  for (const RayCase& ray : RayCases()) group.cases.push_back(BoxCase(ray));
  group.cases.push_back({.name = "Random boxes and rays",
                         .expected = "as in long double, to 10 nm at 100 km from the origin",
                         .unit = "m",
                         .limit = 1e-8,
                         .run = [rays] { return RandomBoxes(rays); }});
  group.cases.push_back({.name = "Samples marched through a block",
                         .expected = "in order, in the box to one float step of it, one per step",
                         .unit = "unit lengths",
                         .limit = 1.2e-7,
                         .run = [rays] { return MarchedSamples(rays / 20); }});
  group.cases.push_back(
      {.name = "Intervals without length, reversed or NaN", .expected = "no sample", .unit = "samples", .limit = 0.0, .run = ZeroLengthInterval});
  return group;
}

}  // namespace skyquilt::bench
