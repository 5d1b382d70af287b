// Gives a tile its texture: charts along dominant directions, packed into one atlas, with colours from photos and the field.
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/survey/photo_pictures.h"
#include "surface/mesh.h"
#include "surface/surface_input.h"
#include "surface/views/depth_views.h"

namespace skyquilt::surface {

struct BakeOptions {
  double texel_m = 0.0;  // size of a texel on the surface; made larger where the atlas would exceed max_atlas
  int max_atlas = 4096;  // pixels per side; exceeded only by more charts than fit with texels of any size
  int jpeg_quality = 88;
  double point_spacing_m = 0.0;  // of the cloud's points; 0: none
};

struct BakedTile {
  TexturedTile tile;
  std::vector<CloudPoint> points;  // las_class is not set yet
};

class TextureBaker {
 public:
  // voxel_m: of the fused surface. Keeps references to input and views.
  TextureBaker(const SurfaceInput& input, const DepthViews& views, double voxel_m);
  // Triangles without an area or with corners that are not finite are left out. Vertex normals do not know the triangles of other tiles, so that
  // shading has a small step at borders of tiles. An empty mesh gives an empty tile. Call it from one thread: the caster may use the same pool. Same
  // bits for any number of threads. Throws base::Interrupted and what the caster throws.
  BakedTile Bake(const MeshTile& mesh, const BakeOptions& options, base::ThreadPool& threads);

  // Why photos could not be read so far, each once.
  std::set<std::string> Failures() const;

 private:
  // The photos with about a pixel per texel, kept from tile to tile.
  survey::PhotoPictures* PhotosFor(double texel_m);

  const SurfaceInput& input_;
  const DepthViews& views_;
  double voxel_m_;
  double photo_texel_m_ = 0.0;  // of photos_
  std::unique_ptr<survey::PhotoPictures> photos_;
  std::set<std::string> failures_;  // of earlier photos_
};

}  // namespace skyquilt::surface
