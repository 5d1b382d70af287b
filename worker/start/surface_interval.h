// Surfaces as the trained context shows them: for the centre of every tile of every training photo the interval of the ray in which the transmittance
// falls. Blocks use it to choose their tiles and their initial occupancy.
#pragma once

#include <vector>

#include "core/base/thread_pool.h"
#include "core/brightness/luminance.h"
#include "core/brightness/response.h"
#include "core/render/trained_field.h"
#include "core/scene/background.h"
#include "core/survey/survey.h"
#include "worker/rays/ray_source.h"
#include "worker/start/point_ranges.h"

namespace skyquilt::worker {

// Metres along the ray; NaN when the transmittance stays above the threshold, and for held-out photos.
struct SurfaceInterval {
  float front = 0.0F;   // transmittance falls below 0.85
  float median = 0.0F;  // transmittance falls below 0.5
  float back = 0.0F;    // transmittance falls below 0.15
};

// Tiles of a photo.
constexpr size_t kTilesOfPhoto = static_cast<size_t>(kTileRows) * kTileColumns;

// Index of a tile in [photo][row][column], kTileRows x kTileColumns per photo.
constexpr size_t BandIndex(int photo, int row, int column) {
  return (static_cast<size_t>(photo) * kTileRows + static_cast<size_t>(row)) * kTileColumns + static_cast<size_t>(column);
}

// Results of a finished context in addition to its field.
struct ContextResults {
  std::vector<SurfaceInterval> bands;  // [photo][row][column], kTileRows x kTileColumns per photo
  scene::Background background;
};

// A trained context, as the training of blocks uses it.
struct LoadedContext {
  render::TrainedField field;
  brightness::Response response;
  brightness::Luminance luminance;
  brightness::LuminanceState luminance_state;
  std::vector<SurfaceInterval> bands;  // [photo][row][column] of the photos that were asked for; empty in old files
  // Per photo of the survey its place among those of `bands`, -1 for others; empty: `bands` has all photos.
  std::vector<int32_t> place_in_bands;

  // Of a photo that was asked for.
  const SurfaceInterval& Band(int photo, int row, int column) const {
    return bands[BandIndex(place_in_bands.empty() ? photo : place_in_bands[static_cast<size_t>(photo)], row, column)];
  }
  // Whether `bands` has an entry for every tile of the survey's photos that were asked for.
  bool HasSurfaceIntervals(const survey::Survey& survey) const {
    return place_in_bands.empty() ? bands.size() == survey.photos.size() * kTilesOfPhoto : place_in_bands.size() == survey.photos.size();
  }
};

// Renders the depth of the context at every tile centre of the training photos; those of held-out photos, from whose places nothing is rendered, are
// NaN. Calls context.BuildNetworks().
std::vector<SurfaceInterval> SurfaceIntervals(const RaySource& source, const survey::Survey& survey, render::TrainedField& context,
                                              base::ThreadPool& threads);

// Sets the tiles from which the source draws a block's rays: those of `tiles` whose surface is inside the block's ground plan, and as empty tiles
// those whose surface is behind the block. Without a context (null) all tiles whose centre ray crosses the block's box. Tiles in which the context
// shows no surface are inside when their ray leaves the box through its bottom, or where photos look level (`ranges` is not empty) when it crosses
// the box and does not show sky.
void ChooseTiles(const survey::Survey& survey, const std::vector<Tile>& tiles, const render::TrainedField& target, const LoadedContext* context,
                 const PointRanges& ranges, double empty_ray_share, RaySource& source, base::ThreadPool& threads);

}  // namespace skyquilt::worker
