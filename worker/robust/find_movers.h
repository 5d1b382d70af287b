// Finds pixels that show what was there in one photo only: cars and people that moved, and their shadows; with RobustOptions::prefer also what later
// flights no longer show. After the context is trained and before blocks are, from the photos alone: a place on the context's surface is looked up in
// the photos around. A cell of a photo is rejected when
//   - at least three other photos see the place, two thirds of them differ from its colour by more than any pixel around can explain, and as
//     many agree with each other (of later flights: or show there what it does not);
//   - and no other distance along its ray makes most of them agree, as it does for lamps, branches and roofs that the context does not have.
// Cells beside such ones that differ by half as much belong to the same thing. Things that are nowhere two cells wide are left alone. As
// RobustNeRF (Sabour et al. 2023) and its gates against taking thin things and parked cars for movers, but by photos in place of residuals of the
// field: a field that was trained on the movers shows them, too.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/thread_pool.h"
#include "worker/robust/photo_views.h"
#include "worker/robust/rejected_pixels.h"
#include "worker/robust/robust_options.h"

namespace skyquilt::worker {

// Side of a cell in pixels of the cached photos: a cell is about a fifth of a car's width, but two pixels at least. gsd_m: of these photos; NaN when
// there is no scale. Larger where all photos would take more than `bytes`.
int CellPixels(const survey::Survey& survey, const image::PixelCache& pixels, double gsd_m, double bytes);

struct Movers {
  RejectedPixels pixels;
  // Shares of the cells of training photos, 0 to 1.
  double compared = 0.0;  // enough photos see them
  double moved = 0.0;     // differ from photos around; before the limit of 3 % of a photo
  double replaced = 0.0;  // of the photos that later flights overlap: differ from these
  bool unclear = false;   // photos disagree about too much to tell what moved: with movers = auto nothing is rejected for it then
};

// Same result for any number of threads. Throws base::Interrupted.
Movers FindMovers(const survey::Survey& survey, const RaySource& source, const PhotoViews& views, const RobustOptions& options, int cell_px,
                  base::ThreadPool& threads);

}  // namespace skyquilt::worker
