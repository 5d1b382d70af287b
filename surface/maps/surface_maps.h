// Maps from the mesh: surface height seen from above, bare ground (DTM), height above ground, hillshade, contours.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/gis/boundary.h"
#include "surface/map_frame.h"
#include "surface/maps/height_raster.h"
#include "surface/mesh.h"
#include "surface/surface_options.h"
#include "surface/written_file.h"

namespace skyquilt::surface {

// The grid of maps with this resolution over the tiles of level 0, outer edges at multiples of the resolution (so that cells coincide with the
// orthophoto's). Without any vertex it has no cells. Throws base::UsageError with advice when it would have more than 100 million cells.
gis::MapGrid PlanSurfaceGrid(std::span<const MeshTile> tiles, const MapFrame& frame, double resolution_m);
// The highest surface of the tiles of level 0 above each cell's centre. Walls and triangles between centres leave no trace. Throws base::Interrupted.
HeightRaster RasteriseSurface(std::span<const MeshTile> tiles, const MapFrame& frame, const gis::MapGrid& grid);

struct SurfaceMaps {
  HeightRaster terrain;            // without gaps inside the surface's outline; not cut by the boundary
  std::vector<WrittenFile> files;  // their paths are relative to the folder
};
// Writes into the folder, which is created:
//   dtm.tif                  float32 height of the ground in metres, no data -9999
//   height_above_ground.tif  float32 height of the surface above it in metres, at least 0, no data -9999
//   hillshade.tif            the surface in light from the north-west, 45 degrees high: 1 dark to 255 bright, no data 0
//   contours.gpkg            contour lines of the smoothed ground, see core/gis/contours.h
// Cells whose centre is outside the boundary have no data. Each file is complete or absent. A surface without cells gives no file, with a warning.
// Without options.maps only the terrain is found. Deterministic. Throws base::InputError, base::Interrupted.
SurfaceMaps MakeSurfaceMaps(const HeightRaster& surface, const MapFrame& frame, const std::optional<gis::Boundary>& boundary,
                            const SurfaceOptions& options, const std::filesystem::path& folder, base::ThreadPool& threads);

}  // namespace skyquilt::surface
