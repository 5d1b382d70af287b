// The texture of one tile from views in memory: what TextureBaker does once it has chosen the views.
#pragma once

#include <span>

#include "core/survey/photo_pictures.h"
#include "surface/surface_input.h"
#include "surface/texture/texture_baker.h"

namespace skyquilt::surface {

// The pointers must outlive it.
struct BakeSource {
  RayCaster caster;
  double voxel_m = 0.0;                     // of the fused surface
  const survey::Survey* survey = nullptr;   // needed for photos
  survey::PhotoPictures* photos = nullptr;  // of about a pixel per texel; null: all colours are the field's
};

// Colours are what the field shows from 4 voxels before the mesh to 6 behind it, and by the tile's error more on both sides. A texel counts as seen
// by a view whose depth there differs by less than 3 voxels and the tile's error.
BakedTile BakeTile(const MeshTile& mesh, std::span<const DepthView> views, const BakeSource& source, const BakeOptions& options,
                   base::ThreadPool& threads);

}  // namespace skyquilt::surface
