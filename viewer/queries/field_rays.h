// What the queries share: the field they ask, vertical rays, and rays in batches.
#pragma once

#include <functional>
#include <vector>

#include "viewer/queries/query.h"

namespace skyquilt::viewer {

// Renders rays of this project. Throws BadMessage when it has no field.
const RayCaster& CasterFor(const FieldAccess& access, Which project);
// access.gsd_m, or a usual one when that is not a length.
double GsdOf(const FieldAccess& access);

// Rays straight down through the whole height of the scene. Not finite boxes are refused by BadMessage.
class VerticalRays {
 public:
  explicit VerticalRays(const FieldAccess& access);
  // width_m: of the column of which the surface is wanted.
  render::Ray At(const Eigen::Vector2d& place, double width_m) const;
  // z of the surface; NaN where there is none.
  double Height(const render::RayColor& color) const;

 private:
  double top_ = 0.0, length_ = 0.0;
};

// Renders the rays number `done` to at most done + batch, of `count`. make: ray of a number; take: receives its result. Returns the new `done`.
size_t CastSome(const RayCaster& caster, size_t batch, size_t done, size_t count, const std::function<render::Ray(size_t)>& make,
                const std::function<void(size_t, const render::RayColor&)>& take);

}  // namespace skyquilt::viewer
