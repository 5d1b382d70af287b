// The orthophoto that a simulated survey should lead to: every cell seen straight from above, in the light of the photos at normal exposure, without
// moving cars.
#pragma once

#include <filesystem>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/geo/enu_frame.h"
#include "core/gis/map_grid.h"
#include "simulate/flight.h"
#include "simulate/place_spec.h"
#include "simulate/world.h"

namespace skyquilt::simulate {

// A map in the UTM zone of the frame's origin, with edges at multiples of cell_m: the rectangle of what the photos see of the ground, as far as the
// place is built. takeoff_z_m: ENU height of the ground at take-off. Throws base::UsageError that names simulate.ortho_cell_m when the map would have
// more than 400 million cells.
gis::MapGrid PlanTrueOrthophoto(const PlaceSpec& place, const std::vector<PhotoPlan>& photos, double takeoff_z_m, const geo::EnuFrame& frame,
                                double cell_m);

// Writes an RGBA GeoTIFF with values like those of a photo; alpha is 0 where a cell is partly or all outside of what is built, else 255.
// samples_per_cell: 4 or 16 rays along the ellipsoid's normal, filtered as those of a photo's pixel of the cell's width. Keeps some hundred rows in
// memory. The same bytes for any number of threads. Throws base::InputError when the file cannot be written, and base::Interrupted.
void WriteTrueOrthophoto(const World& world, const gis::MapGrid& grid, const geo::EnuFrame& frame, int samples_per_cell, bool soft_shadows,
                         base::ThreadPool& threads, const std::filesystem::path& file);

}  // namespace skyquilt::simulate
