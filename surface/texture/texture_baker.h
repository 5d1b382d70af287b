// Gives a tile its texture: charts along dominant directions, packed into one atlas, with colours rendered from the field.
#pragma once

#include <vector>

#include "surface/mesh.h"
#include "surface/surface_input.h"
#include "surface/views/depth_views.h"

namespace skyquilt::surface {

struct BakeOptions {
  double texel_m = 0.0;  // size of a texel on the surface; made larger where the atlas would exceed max_atlas
  int max_atlas = 4096;  // pixels per side; exceeded only by more charts than fit with texels of any size
  int jpeg_quality = 88;
  double photo_detail = 0.0;     // share of the fine detail of photos, 0 to 1
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
  BakedTile Bake(const MeshTile& mesh, const BakeOptions& options, base::ThreadPool& threads) const;

 private:
  const SurfaceInput& input_;
  const DepthViews& views_;
  double voxel_m_;
};

}  // namespace skyquilt::surface
