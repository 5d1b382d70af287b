#include "surface/texture/atlas_layout.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/base/errors.h"
#include "surface/texture/pack.h"

namespace skyquilt::surface {
namespace {

constexpr double kCoarser = 1.25;
constexpr int kMaxTries = 40;
constexpr int kLargestJpeg = 65520;  // pixels per side, a multiple of kAtlasMultiple

// The finest texel of the series texel_m * kCoarser^n with which the atlas could fit at all.
double FirstTexel(const TileGeometry& geometry, const ChartDirections& directions, double texel_m, int limit) {
  double area = 0.0;  // as projected
  for (size_t t = 0; t < geometry.triangle.size(); ++t) {
    const int best = BestDirection(directions, geometry.face_normal[t]);
    area += geometry.area[t] * geometry.face_normal[t].dot(directions[static_cast<size_t>(best)].out);
  }
  const double most = static_cast<double>(limit) * limit;
  // Charts may join triangles at a flatter angle, which takes fewer texels.
  while (area * kLeastChartCosine / (texel_m * texel_m) > most) texel_m *= kCoarser;
  return texel_m;
}

std::optional<Packing> Pack(const std::vector<Chart>& charts, int limit) {
  std::vector<Eigen::Vector2i> sizes;
  sizes.reserve(charts.size());
  for (const Chart& chart : charts) sizes.emplace_back(chart.size.array() + 2 * kGutterTexels);
  std::optional<Packing> packing = PackRows(sizes, limit);
  if (packing) {
    for (Eigen::Vector2i& corner : packing->corner) corner.array() += kGutterTexels;
  }
  return packing;
}

}  // namespace

AtlasLayout LayOutAtlas(const TileGeometry& geometry, double texel_m, int max_atlas) {
  SKYQUILT_CHECK(texel_m > 0.0 && std::isfinite(texel_m), "size of a texel: " + std::to_string(texel_m));
  AtlasLayout layout;
  layout.lattice.directions = DirectionsOf(geometry);
  layout.lattice.origin_enu = geometry.min_enu;
  layout.lattice.texel_m = texel_m;
  if (geometry.triangle.empty()) return layout;
  const int limit = std::clamp(max_atlas, kAtlasMultiple, kLargestJpeg);
  texel_m = FirstTexel(geometry, layout.lattice.directions, texel_m, limit);
  std::optional<Packing> packing;
  for (int tries = 0; !packing; ++tries, texel_m *= kCoarser) {
    layout.lattice.texel_m = texel_m;
    std::optional<std::vector<Chart>> charts = MakeCharts(geometry, layout.lattice, limit - 2 * kGutterTexels);
    if (!charts) continue;
    layout.charts = std::move(*charts);
    packing = Pack(layout.charts, limit);
    if (!packing && tries >= kMaxTries) {
      packing = Pack(layout.charts, kLargestJpeg);
      SKYQUILT_CHECK(packing, "too many charts for one texture: " + std::to_string(layout.charts.size()));
    }
  }
  layout.corner = std::move(packing->corner);
  layout.width = packing->width;
  layout.height = packing->height;
  return layout;
}

TexturedTile LaidOutTile(const MeshTile& mesh, const TileGeometry& geometry, const AtlasLayout& layout) {
  TexturedTile tile;
  tile.id = mesh.id;
  tile.error_m = mesh.error_m;
  tile.atlas_width = layout.width;
  tile.atlas_height = layout.height;
  tile.triangle.reserve(geometry.triangle.size());
  const Eigen::Vector2d scale(1.0 / std::max(layout.width, 1), 1.0 / std::max(layout.height, 1));
  std::vector<std::pair<uint32_t, uint32_t>> copy(mesh.mesh.position.size(), {std::numeric_limits<uint32_t>::max(), 0});  // last chart, vertex there
  for (size_t c = 0; c < layout.charts.size(); ++c) {
    for (const uint32_t t : layout.charts[c].triangle) {
      Triangle corners{};
      for (size_t i = 0; i < 3; ++i) {
        const uint32_t vertex = geometry.triangle[t][i];
        if (copy[vertex].first != c) {
          copy[vertex] = {static_cast<uint32_t>(c), static_cast<uint32_t>(tile.position.size())};
          const Eigen::Vector3d& x = mesh.mesh.position[vertex];
          tile.position.push_back(x);
          tile.normal.push_back(geometry.vertex_normal[vertex].cast<float>());
          tile.uv.push_back(layout.PixelOf(c, x).cwiseProduct(scale).cast<float>());
          tile.views.push_back(mesh.mesh.views[vertex]);
          tile.filled.push_back(mesh.mesh.filled[vertex]);
        }
        corners[i] = copy[vertex].second;
      }
      tile.triangle.push_back(corners);
    }
  }
  return tile;
}

}  // namespace skyquilt::surface
