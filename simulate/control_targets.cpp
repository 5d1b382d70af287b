#include "simulate/control_targets.h"

#include <cmath>
#include <numbers>
#include <optional>

#include "core/base/random.h"
#include "simulate/target_places.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;

constexpr uint64_t kPlaceStream = 81;
constexpr double kSide_px = 8.0;
constexpr double kBorder_px = 12.0;  // of the photos: the whole target is inside
constexpr double kSteepest = 0.15;   // rise per metre
constexpr double kAround = 1.3;      // open ground reaches this many half sides beyond the centre

// Ground around the place, level and open.
bool IsOpen(const World& world, const TargetPlace& place) {
  const double reach_m = kAround * 0.5 * place.side_m;
  const Vector2d middle = place.ground.position.cast<double>().head<2>();
  for (const double x : {-1.0, 0.0, 1.0}) {
    for (const double y : {-1.0, 0.0, 1.0}) {
      const std::optional<OpenGround> ground = OpenGroundAt(world, middle + reach_m * Vector2d(x, y));
      const float z = place.ground.position.z();
      if (!ground || std::abs(static_cast<double>(ground->position.z() - z)) > kSteepest * std::numbers::sqrt2 * reach_m) return false;
    }
  }
  return true;
}

}  // namespace

std::vector<ControlTarget> ChooseTargets(const World& world, const PlaceSpec& place, const std::vector<PhotoPlan>& photos, int n_control, int n_check,
                                         base::ThreadPool& threads) {
  const int wanted = n_control + n_check;
  if (wanted == 0) return {};
  base::Random random(place.seed, kPlaceStream);
  const PointViews views(world, place.camera, photos);
  const std::vector<TargetPlace> places = FindTargetPlaces(place, wanted, random, threads, [&](const Vector2d& at) {
    std::optional<TargetPlace> found = TargetPlaceAt(world, place.camera, views, at, kBorder_px);
    if (!found) return found;
    found->side_m = kSide_px * found->gsd_m;
    if (!IsOpen(world, *found)) found.reset();
    return found;
  });
  std::vector<ControlTarget> targets;
  int control = 0, check = 0;
  for (const size_t index : FarthestPlaces(places, place, static_cast<size_t>(wanted))) {
    ControlTarget target;
    target.position = places[index].ground.position.cast<double>();
    target.side_m = places[index].side_m;
    target.photos = places[index].photos;
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
