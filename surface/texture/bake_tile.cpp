#include "surface/texture/bake_tile.h"

#include <algorithm>
#include <cmath>

#include "surface/texture/cloud_points.h"
#include "surface/texture/paint_atlas.h"
#include "surface/texture/photo_detail.h"

namespace skyquilt::surface {
namespace {

constexpr double kVoxelsBefore = 4.0;
constexpr double kVoxelsBehind = 6.0;
constexpr double kVoxelsSeen = 3.0;

}  // namespace

BakedTile BakeTile(const MeshTile& mesh, std::span<const DepthView> views, const BakeSource& source, const BakeOptions& options,
                   base::ThreadPool& threads) {
  BakedTile baked;
  baked.tile.id = mesh.id;
  baked.tile.error_m = mesh.error_m;
  const TileGeometry geometry = GeometryOf(mesh.mesh);
  if (geometry.triangle.empty()) return baked;
  const AtlasLayout layout = LayOutAtlas(geometry, options.texel_m, options.max_atlas);
  const double texel_m = layout.lattice.texel_m;
  const double error_m = std::isfinite(mesh.error_m) ? std::max(mesh.error_m, 0.0) : 0.0;
  const double seen_m = kVoxelsSeen * source.voxel_m + error_m;
  const RayWindow window{kVoxelsBefore * source.voxel_m + error_m, kVoxelsBehind * source.voxel_m + error_m};

  const AtlasTexels texels = FindTexels(geometry, layout, threads);
  const std::vector<int32_t> view = ChooseViews(geometry, layout, texels, views, seen_m, threads);
  TexelColors colors = RenderTexels(geometry, texels, view, views, source.caster, window, texel_m, threads);
  if (options.photo_detail > 0.0 && source.photos && source.survey) {
    AddPhotoDetail(geometry, texels, view, views, *source.survey, *source.photos, options.photo_detail, texel_m, seen_m, threads, &colors);
  }
  const image::Image8 atlas = PaintAtlas(layout, texels, colors, threads);
  baked.tile = LaidOutTile(mesh, geometry, layout);
  baked.tile.atlas_jpeg = image::EncodeJpeg(atlas, options.jpeg_quality);
  baked.points = PointsOf(geometry, layout, texels, atlas, options.point_spacing_m);
  return baked;
}

}  // namespace skyquilt::surface
