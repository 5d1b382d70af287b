// Where the context sees surfaces: for the centre of every tile of every photo the interval of the ray in which the light ends.
// Blocks choose their pixels by it and start their occupancy from it.
#pragma once

#include <vector>

#include "core/base/thread_pool.h"
#include "core/brightness/luminance.h"
#include "core/brightness/response.h"
#include "core/render/trained_field.h"
#include "core/scene/background.h"
#include "core/survey/survey.h"
#include "worker/ray_source.h"

namespace skyquilt::worker {

// Metres along the ray; NaN where the light never gets that faint.
struct SurfaceBand {
  float front = 0.0F;   // transmittance passes 0.85
  float median = 0.0F;  // 0.5
  float back = 0.0F;    // 0.15
};

// What the context stage finds out beside its field.
struct ContextFindings {
  std::vector<SurfaceBand> bands;  // [photo][row][column], kTileRows x kTileColumns per photo
  scene::Background background;
};

struct LoadedContext {
  render::TrainedField field;
  brightness::Response response;
  brightness::Luminance luminance;
  brightness::LuminanceState luminance_state;
  std::vector<SurfaceBand> bands;  // [photo][row][column], kTileRows x kTileColumns per photo; empty in old files

  const SurfaceBand& Band(int photo, int row, int column) const {
    return bands[(static_cast<size_t>(photo) * kTileRows + static_cast<size_t>(row)) * kTileColumns + static_cast<size_t>(column)];
  }
  bool KnowsBands(const survey::Survey& survey) const { return bands.size() == survey.photos.size() * kTileRows * kTileColumns; }
};

// Renders the context through every tile centre of all photos. Calls context.BuildNetworks().
std::vector<SurfaceBand> SurfaceBands(const RaySource& source, const survey::Survey& survey, render::TrainedField& context,
                                      base::ThreadPool& threads);

// Gives the source the block's part of `tiles`: those whose surface lies over the block's ground plan, and those that end behind the block and
// teach emptiness only. Without a context (null) every tile whose ray crosses the box.
void ChooseTiles(const survey::Survey& survey, const std::vector<Tile>& tiles, const render::TrainedField& target, const LoadedContext* context,
                 double empty_ray_share, RaySource& source);

}  // namespace skyquilt::worker
