// surface.json: what was made of a surface, as a table for people and programs.
#pragma once

#include <filesystem>

#include "surface/fuse_mesh.h"
#include "surface/make_surface.h"
#include "surface/map_frame.h"

namespace skyquilt::surface {

// Keys: triangles, edges, boundary_edges, non_manifold_edges, area_m2, filled_m2, voxel_m, points, photos, virtual_views, seconds, crs, vertical, and
// files: a list of the members of WrittenFile. Throws base::InputError.
void WriteSurfaceTable(const SurfaceResult& result, const EdgeCounts& edges, const MapFrame& frame, const std::filesystem::path& file);
// What later stages need of it: the size of a voxel, and how many triangles there are. Throw base::InputError when the file is missing or damaged.
double ReadVoxel(const std::filesystem::path& file);
int64_t ReadTriangles(const std::filesystem::path& file);

}  // namespace skyquilt::surface
