// Writes the true surface of a simulated place as a mesh, for comparisons in space and for any mesh viewer.
#pragma once

#include <filesystem>

#include "simulate/world.h"

namespace skyquilt::simulate {

// The static scene (no moving cars) in ENU metres as binary little-endian PLY: per vertex float x y z; per face a list of three int indices,
// counter-clockwise seen from outside, and uchar class (core/survey/surface_class.h). Everything that is modelled: the surveyed area and its
// surround, hidden parts such as foundations and the ground under buildings included. A face of the ground is a road when its middle is on one, so
// the borders of roads are as coarse as the terrain's triangles. Writes atomically; throws base::InputError.
void WriteSurfaceMesh(const World& world, const std::filesystem::path& file);

}  // namespace skyquilt::simulate
