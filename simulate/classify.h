// Says to which class of surface (core/survey/surface_class.h) a point of a simulated place belongs.
#pragma once

#include <Eigen/Core>

#include "core/survey/surface_class.h"
#include "simulate/city_layout.h"
#include "simulate/salt_marsh.h"
#include "simulate/tagged_mesh.h"

namespace skyquilt::simulate {

// tag: of the triangle that the point is on, in the static scene. position: ENU metres; the layout decides between ground and road there. city,
// marsh: null where there is none.
survey::SurfaceClass ClassOf(const Tag& tag, const Eigen::Vector3f& position, const CityLayout* city, const SaltMarsh* marsh = nullptr);

// tag: of a triangle of what moves.
survey::SurfaceClass ClassOfMoving(const Tag& tag);

}  // namespace skyquilt::simulate
