#include "surface/texture/cloud_points.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::surface {
namespace {

// Of a row of texels, `density` (at most 1) points per texel, evenly.
bool IsPicked(int texel, double density) {
  return std::floor((texel + 1) * density) > std::floor(texel * density);
}

CloudPoint PointAt(const TileGeometry& geometry, const AtlasTexels& texels, const image::Image8& atlas, size_t i) {
  const Texel& texel = texels.texel[i];
  const Triangle& corners = geometry.triangle[texel.triangle];
  const float b0 = 1.0F - texel.b1 - texel.b2;
  const uint32_t nearest = b0 >= texel.b1 && b0 >= texel.b2 ? corners[0] : texel.b1 >= texel.b2 ? corners[1] : corners[2];
  const uint8_t* rgb = atlas.At(texel.x, texel.y);
  CloudPoint point{};
  point.position = texels.PositionOf(geometry, i);
  point.normal = texels.NormalOf(geometry, i).cast<float>();
  point.rgb = {rgb[0], rgb[1], rgb[2]};
  point.views = geometry.mesh->views[nearest];
  for (const uint32_t corner : corners) point.filled = std::max(point.filled, geometry.mesh->filled[corner]);
  point.las_class = 1;
  return point;
}

}  // namespace

std::vector<CloudPoint> PointsOf(const TileGeometry& geometry, const AtlasLayout& layout, const AtlasTexels& texels, const image::Image8& atlas,
                                 double spacing_m) {
  std::vector<CloudPoint> points;
  if (!(spacing_m > 0.0)) return points;
  const double texel_m = layout.lattice.texel_m;
  for (size_t c = 0; c < layout.charts.size(); ++c) {
    const Chart& chart = layout.charts[c];
    const Eigen::Vector3d& out = layout.lattice.directions[static_cast<size_t>(chart.direction)].out;
    double area = 0.0;
    double projected = 0.0;
    for (const uint32_t t : chart.triangle) {
      area += geometry.area[t];
      projected += geometry.area[t] * geometry.face_normal[t].dot(out);
    }
    const double stretch = projected > 0.0 ? area / projected : 1.0;
    const double density = std::min(1.0, texel_m / spacing_m * std::sqrt(stretch));
    const size_t before = points.size();
    for (size_t i = texels.first[c]; i < texels.first[c + 1]; ++i) {
      const Texel& texel = texels.texel[i];
      const Eigen::Vector2i on_lattice = Eigen::Vector2i(texel.x, texel.y) - layout.corner[c] + chart.corner;
      if (!texel.border && IsPicked(on_lattice.x(), density) && IsPicked(on_lattice.y(), density))
        points.push_back(PointAt(geometry, texels, atlas, i));
    }
    const size_t n = texels.first[c + 1] - texels.first[c];
    if (points.size() == before && n > 0 && area >= 0.5 * spacing_m * spacing_m) {
      points.push_back(PointAt(geometry, texels, atlas, texels.first[c] + n / 2));
    }
  }
  return points;
}

}  // namespace skyquilt::surface
