#include "surface/texture/bake_tile.h"

#include <algorithm>
#include <cmath>

#include "surface/texture/cloud_points.h"
#include "surface/texture/field_light.h"
#include "surface/texture/paint_atlas.h"
#include "surface/texture/photo_texture.h"

namespace skyquilt::surface {
namespace {

constexpr double kVoxelsBefore = 4.0;
constexpr double kVoxelsBehind = 6.0;
constexpr double kVoxelsSeen = 3.0;

struct ColorOptions {
  RayWindow window;
  double texel_m = 0.0, seen_m = 0.0;
};

TexelColors ColorsOf(const TileGeometry& geometry, const AtlasLayout& layout, const AtlasTexels& texels, std::span<const TexelBlock> blocks,
                     std::span<const DepthView> views, const BakeSource& source, const ColorOptions& options, base::ThreadPool& threads) {
  const size_t n = texels.texel.size();
  PhotoTexture photo;
  photo.cell.assign(n, -1);
  TexelColors field;  // of the photo's cells
  if (source.photos && source.survey) {
    const TexturePhotos photos(geometry, layout, texels, blocks, views, *source.survey, *source.photos, options.seen_m);
    photo = photos.Colors(threads);
    std::vector<TexelRay> middles;
    for (const PhotoCell& cell : photo.cells) middles.push_back({cell.middle, cell.view, static_cast<float>(kPhotoCellTexels * options.texel_m)});
    field = RenderTexels(geometry, texels, middles, views, source.caster, options.window, threads);
    photos.ReplaceStrangers(threads, &photo, &field);
    BringIntoFieldLight(layout, texels, field, threads, &photo);
  }
  std::vector<TexelRay> others;
  for (const TexelBlock& block : blocks) {
    for (const uint32_t i : block.texel) {
      if (photo.cell[i] < 0) others.push_back({i, block.view[0], static_cast<float>(options.texel_m)});
    }
  }
  const TexelColors rendered = RenderTexels(geometry, texels, others, views, source.caster, options.window, threads);
  TexelColors colors;
  colors.rgb_srgb = std::move(photo.rgb_srgb);
  colors.rgb_srgb.resize(n);
  colors.known.assign(n, 1);
  for (size_t k = 0; k < others.size(); ++k) {
    colors.rgb_srgb[others[k].texel] = rendered.rgb_srgb[k];
    colors.known[others[k].texel] = rendered.known[k];
  }
  return colors;
}

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
  const std::vector<TexelBlock> blocks = ChooseViews(geometry, layout, texels, views, seen_m, threads);
  const TexelColors colors = ColorsOf(geometry, layout, texels, blocks, views, source, {window, texel_m, seen_m}, threads);
  const image::Image8 atlas = PaintAtlas(layout, texels, colors, threads);
  baked.tile = LaidOutTile(mesh, geometry, layout);
  baked.tile.atlas_jpeg = image::EncodeJpeg(atlas, options.jpeg_quality);
  baked.points = PointsOf(geometry, layout, texels, atlas, options.point_spacing_m);
  return baked;
}

}  // namespace skyquilt::surface
