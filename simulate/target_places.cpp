#include "simulate/target_places.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/progress.h"

namespace skyquilt::simulate {
namespace {

constexpr int kLeastCandidates = 1500, kCandidatesPerTarget = 40;

// At random, one in each cell of a grid over the area.
std::vector<Eigen::Vector2d> Candidates(const PlaceSpec& place, int wanted, base::Random& random) {
  const Eigen::Vector2d size = place.area_max - place.area_min;
  const double cell_m = std::sqrt(size.prod() / std::max(kLeastCandidates, kCandidatesPerTarget * wanted));
  const int columns = std::max(1, static_cast<int>(size.x() / cell_m));
  const int rows = std::max(1, static_cast<int>(size.y() / cell_m));
  std::vector<Eigen::Vector2d> places;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double x = (i + random.UniformDouble()) / columns;
      const double y = (j + random.UniformDouble()) / rows;
      places.push_back(place.area_min + Eigen::Vector2d(x, y).cwiseProduct(size));
    }
  }
  return places;
}

}  // namespace

std::optional<OpenGround> OpenGroundAt(const World& world, const Eigen::Vector2d& at) {
  constexpr float kAbove_m = 1000.0F;
  const Eigen::Vector3f from(static_cast<float>(at.x()), static_cast<float>(at.y()),
                             world.terrain().Height(static_cast<float>(at.x()), static_cast<float>(at.y())) + kAbove_m);
  raytrace::RayPacket ray;
  ray.valid.fill(0);
  ray.Set(0, from, -Eigen::Vector3f::UnitZ(), 0.0F, 2.0F * kAbove_m);
  world.scene().Intersect(ray);
  const uint32_t triangle = ray.triangle[0];
  if (triangle == raytrace::kNoTriangle || world.mesh().tag[triangle].part != Part::kGround) return std::nullopt;
  const auto& corners = world.mesh().triangle[triangle];
  const Eigen::Vector3f normal = world.mesh().FaceNormal(triangle);
  const Eigen::Vector3f& corner = world.mesh().position[corners[0]];
  // From the plane of the triangle: exact to a fraction of a millimetre, which the long ray is not.
  const float z = corner.z() - (normal.x() * (from.x() - corner.x()) + normal.y() * (from.y() - corner.y())) / normal.z();
  return OpenGround{{from.x(), from.y(), z}, normal};
}

std::optional<TargetPlace> TargetPlaceAt(const World& world, const camera::Camera& camera, const PointViews& views, const Eigen::Vector2d& at,
                                         double border_px) {
  const std::optional<OpenGround> ground = OpenGroundAt(world, at);
  if (!ground) return std::nullopt;
  TargetPlace place;
  place.ground = *ground;
  place.photos = views.Seeing(ground->position, ground->normal, border_px);
  if (place.photos.size() < kMinTargetViews) return std::nullopt;
  double distance_m = 0.0;
  for (const uint32_t photo : place.photos) distance_m += (views.Centre(photo) - ground->position.cast<double>()).norm();
  place.gsd_m = distance_m / (static_cast<double>(place.photos.size()) * camera.FocalX());
  return place;
}

std::vector<TargetPlace> FindTargetPlaces(const PlaceSpec& place, int wanted, base::Random& random, base::ThreadPool& threads,
                                          const std::function<std::optional<TargetPlace>(const Eigen::Vector2d& at)>& find) {
  const std::vector<Eigen::Vector2d> candidates = Candidates(place, wanted, random);
  std::vector<std::optional<TargetPlace>> found(candidates.size());
  base::Progress progress("places of targets", static_cast<double>(candidates.size()), "places");
  threads.ParallelFor(static_cast<int64_t>(candidates.size()), [&](int64_t task, int /*thread*/) {
    base::ThrowIfCancelled();
    progress.Advance();
    found[static_cast<size_t>(task)] = find(candidates[static_cast<size_t>(task)]);
  });
  progress.Finish();
  std::vector<TargetPlace> places;
  for (std::optional<TargetPlace>& one : found) {
    if (one) places.push_back(std::move(*one));
  }
  return places;
}

std::vector<size_t> FarthestPlaces(std::span<const TargetPlace> places, const PlaceSpec& place, size_t wanted) {
  const auto position = [&](size_t i) -> Eigen::Vector2d { return places[i].ground.position.cast<double>().head<2>(); };
  const Eigen::Vector2d middle = 0.5 * (place.area_min + place.area_max);
  std::vector<double> distance(places.size());
  for (size_t i = 0; i < places.size(); ++i) distance[i] = (position(i) - middle).norm();
  std::vector<size_t> chosen;
  while (chosen.size() < std::min(wanted, places.size())) {
    const auto farthest = static_cast<size_t>(std::max_element(distance.begin(), distance.end()) - distance.begin());
    if (!chosen.empty() && distance[farthest] < 3.0 * places[farthest].side_m) break;
    for (size_t i = 0; i < places.size(); ++i) {
      const double next = (position(i) - position(farthest)).norm();
      distance[i] = chosen.empty() ? next : std::min(distance[i], next);
    }
    chosen.push_back(farthest);
  }
  return chosen;
}

}  // namespace skyquilt::simulate
