// Places on the ground where targets can lie: open, and seen by several photos.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/base/random.h"
#include "core/base/thread_pool.h"
#include "simulate/flight.h"
#include "simulate/place_spec.h"
#include "simulate/point_views.h"
#include "simulate/world.h"

namespace skyquilt::simulate {

inline constexpr size_t kMinTargetViews = 5;  // photos that must see a target

struct OpenGround {
  Eigen::Vector3f position;  // ENU metres
  Eigen::Vector3f normal;    // of the terrain's triangle
};

// The ground straight below the sky; nothing under roofs, trees, cars, bridges and water.
std::optional<OpenGround> OpenGroundAt(const World& world, const Eigen::Vector2d& at);

struct TargetPlace {
  OpenGround ground;             // in the middle
  std::vector<uint32_t> photos;  // that see the middle; indices, ascending
  double gsd_m = 0.0;            // mean width of their pixels there
  double side_m = 0.0;           // of the square for a target
};

// Nothing where fewer than kMinTargetViews photos see the place at least border_px inside. Without side_m.
std::optional<TargetPlace> TargetPlaceAt(const World& world, const camera::Camera& camera, const PointViews& views, const Eigen::Vector2d& at,
                                         double border_px);
// Places for which `find` returns something, of at least 40 times `wanted` that are tried, at random, one in each cell of a grid over the area. The
// same for any number of threads.
std::vector<TargetPlace> FindTargetPlaces(const PlaceSpec& place, int wanted, base::Random& random, base::ThreadPool& threads,
                                          const std::function<std::optional<TargetPlace>(const Eigen::Vector2d& at)>& find);
// Indices of `wanted` places at most: the first is farthest from the middle of the area, each later one farthest from those before it.
std::vector<size_t> FarthestPlaces(std::span<const TargetPlace> places, const PlaceSpec& place, size_t wanted);

}  // namespace skyquilt::simulate
