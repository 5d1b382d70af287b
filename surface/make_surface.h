// Stage surface: textured mesh, point cloud, 3D tiles and maps of a scene.
#pragma once

#include <optional>
#include <vector>

#include "surface/surface_input.h"
#include "surface/tile_store.h"
#include "surface/written_file.h"

namespace skyquilt::surface {

struct SurfaceResult {
  double voxel_m = 0.0;   // of the fused surface; larger than asked for where the memory is short
  int64_t triangles = 0;  // of the finest level
  double area_m2 = 0.0;
  double filled_m2 = 0.0;  // closed holes
  int64_t points = 0;      // of the cloud
  int photos = 0, virtual_views = 0;
  std::vector<WrittenFile> files;
  double seconds = 0.0;
  double fusing_s = 0.0;  // of them, in which pieces of the mesh were fused here, which other ranks could have done
};

// Steps, each finished before the next and not repeated by a later call with the same work folder: pictures of depth, mesh, levels, textures, files.
// A scene without any surface gives a result without files, with a warning. Throws base::UsageError (memory too small, boundary outside),
// base::InputError, base::Interrupted.
SurfaceResult MakeSurface(const SurfaceInput& input, base::ThreadPool& threads);

// The textured tiles of level 0 of a finished surface, for scores; empty when there is none. Their files, each for LoadBakedTile, or all in memory.
std::vector<std::filesystem::path> FinestTileFiles(const std::filesystem::path& work_folder);
std::vector<TexturedTile> LoadFinestTiles(const std::filesystem::path& work_folder);

}  // namespace skyquilt::surface
