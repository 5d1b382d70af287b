#include "simulate/control_targets.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/base/cancel.h"
#include "core/base/progress.h"
#include "core/base/random.h"
#include "simulate/point_views.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr uint64_t kPlaceStream = 81;
constexpr double kSide_px = 8.0;
constexpr double kBorder_px = 12.0;  // of the photos: the whole target is inside
constexpr double kSteepest = 0.15;   // rise per metre
constexpr int kLeastCandidates = 1500, kCandidatesPerTarget = 40;
constexpr double kAround = 1.3;  // open ground reaches this many half sides beyond the centre

struct Ground {
  Vector3f position;
  Vector3f normal;
};

// The ground straight below the sky; nothing under roofs, trees, cars, bridges and water.
std::optional<Ground> OpenGround(const World& world, const Vector2d& at) {
  constexpr float kAbove_m = 1000.0F;
  const Vector3f from(static_cast<float>(at.x()), static_cast<float>(at.y()),
                      world.terrain().Height(static_cast<float>(at.x()), static_cast<float>(at.y())) + kAbove_m);
  raytrace::RayPacket ray;
  ray.valid.fill(0);
  ray.Set(0, from, -Vector3f::UnitZ(), 0.0F, 2.0F * kAbove_m);
  world.scene().Intersect(ray);
  const uint32_t triangle = ray.triangle[0];
  if (triangle == raytrace::kNoTriangle || world.mesh().tag[triangle].part != Part::kGround) return std::nullopt;
  const auto& corners = world.mesh().triangle[triangle];
  const Vector3f normal = world.mesh().FaceNormal(triangle);
  const Vector3f& corner = world.mesh().position[corners[0]];
  // From the plane of the triangle: exact to a fraction of a millimetre, which the long ray is not.
  const float z = corner.z() - (normal.x() * (from.x() - corner.x()) + normal.y() * (from.y() - corner.y())) / normal.z();
  return Ground{{from.x(), from.y(), z}, normal};
}

// Ground around the target, level and open.
bool IsOpen(const World& world, const ControlTarget& target, float z) {
  const double reach_m = kAround * 0.5 * target.side_m;
  for (const double x : {-1.0, 0.0, 1.0}) {
    for (const double y : {-1.0, 0.0, 1.0}) {
      const std::optional<Ground> ground = OpenGround(world, target.position.head<2>() + reach_m * Vector2d(x, y));
      if (!ground || std::abs(static_cast<double>(ground->position.z() - z)) > kSteepest * std::numbers::sqrt2 * reach_m) return false;
    }
  }
  return true;
}

std::optional<ControlTarget> TargetAt(const World& world, const camera::Camera& camera, const PointViews& views, const Vector2d& at) {
  const std::optional<Ground> ground = OpenGround(world, at);
  if (!ground) return std::nullopt;
  ControlTarget target;
  target.position = ground->position.cast<double>();
  target.photos = views.Seeing(ground->position, ground->normal, kBorder_px);
  if (target.photos.size() < kMinTargetViews) return std::nullopt;
  double distance_m = 0.0;
  for (const uint32_t photo : target.photos) distance_m += (views.Centre(photo) - target.position).norm();
  target.side_m = kSide_px * distance_m / (static_cast<double>(target.photos.size()) * camera.FocalX());
  if (!IsOpen(world, target, ground->position.z())) return std::nullopt;
  return target;
}

// At random, one in each cell of a grid over the area.
std::vector<Vector2d> Candidates(const PlaceSpec& place, int wanted, base::Random& random) {
  const Vector2d size = place.area_max - place.area_min;
  const double cell_m = std::sqrt(size.prod() / std::max(kLeastCandidates, kCandidatesPerTarget * wanted));
  const int columns = std::max(1, static_cast<int>(size.x() / cell_m));
  const int rows = std::max(1, static_cast<int>(size.y() / cell_m));
  std::vector<Vector2d> places;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double x = (i + random.UniformDouble()) / columns;
      const double y = (j + random.UniformDouble()) / rows;
      places.push_back(place.area_min + Vector2d(x, y).cwiseProduct(size));
    }
  }
  return places;
}

// Indices of `wanted` targets at most: the first is farthest from the middle, each later one farthest from those before it.
std::vector<size_t> FarthestPoints(const std::vector<ControlTarget>& targets, const Vector2d& middle, size_t wanted) {
  std::vector<double> distance(targets.size());
  for (size_t i = 0; i < targets.size(); ++i) distance[i] = (targets[i].position.head<2>() - middle).norm();
  std::vector<size_t> chosen;
  while (chosen.size() < std::min(wanted, targets.size())) {
    const auto farthest = static_cast<size_t>(std::max_element(distance.begin(), distance.end()) - distance.begin());
    if (!chosen.empty() && distance[farthest] < 3.0 * targets[farthest].side_m) break;
    for (size_t i = 0; i < targets.size(); ++i) {
      const double next = (targets[i].position - targets[farthest].position).head<2>().norm();
      distance[i] = chosen.empty() ? next : std::min(distance[i], next);
    }
    chosen.push_back(farthest);
  }
  return chosen;
}

}  // namespace

std::vector<ControlTarget> ChooseTargets(const World& world, const PlaceSpec& place, const std::vector<PhotoPlan>& photos, int n_control, int n_check,
                                         base::ThreadPool& threads) {
  const int wanted = n_control + n_check;
  if (wanted == 0) return {};
  base::Random random(place.seed, kPlaceStream);
  const std::vector<Vector2d> places = Candidates(place, wanted, random);
  const PointViews views(world, place.camera, photos);
  std::vector<std::optional<ControlTarget>> found(places.size());
  base::Progress progress("places of targets", static_cast<double>(places.size()), "places");
  threads.ParallelFor(static_cast<int64_t>(places.size()), [&](int64_t task, int /*thread*/) {
    base::ThrowIfCancelled();
    progress.Advance();
    found[static_cast<size_t>(task)] = TargetAt(world, place.camera, views, places[static_cast<size_t>(task)]);
  });
  progress.Finish();
  std::vector<ControlTarget> usable;
  for (std::optional<ControlTarget>& one : found) {
    if (one) usable.push_back(std::move(*one));
  }
  std::vector<ControlTarget> targets;
  int control = 0, check = 0;
  for (const size_t index : FarthestPoints(usable, 0.5 * (place.area_min + place.area_max), static_cast<size_t>(wanted))) {
    ControlTarget target = usable[index];
    // Keeps the share of check points among those chosen so far at that of all.
    target.check = (control + check + 1) * n_check / wanted > check;
    target.label = target.check ? "check" + std::to_string(++check) : "gcp" + std::to_string(++control);
    target.yaw_rad = random.Uniform(0.0, 0.5 * std::numbers::pi);
    targets.push_back(std::move(target));
  }
  return targets;
}

std::vector<PaintedTarget> PaintOf(const std::vector<ControlTarget>& targets) {
  std::vector<PaintedTarget> painted;
  painted.reserve(targets.size());
  for (const ControlTarget& target : targets) painted.push_back({target.position.head<2>(), target.side_m, target.yaw_rad});
  return painted;
}

}  // namespace skyquilt::simulate
