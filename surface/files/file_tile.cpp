#include "surface/files/file_tile.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/errors.h"

namespace skyquilt::surface {
namespace {

Eigen::Vector3f UnitNormal(const Eigen::Vector3f& normal) {
  const Eigen::Vector3d exact = normal.cast<double>();
  const double length = exact.norm();
  if (!(length > 1e-12 && std::isfinite(length))) return Eigen::Vector3f::UnitZ();
  return (exact / length).cast<float>();
}

}  // namespace

TexturedTile CleanTile(const TexturedTile& tile) {
  const size_t n = tile.position.size();
  SKYQUILT_CHECK(tile.normal.size() == n && tile.uv.size() == n && tile.views.size() == n && tile.filled.size() == n,
                 "the vertices of tile " + tile.id.Name() + " lack values");
  constexpr uint32_t kUnused = std::numeric_limits<uint32_t>::max();
  SKYQUILT_CHECK(n < kUnused, "tile " + tile.id.Name() + " has too many vertices");
  TexturedTile clean;
  clean.id = tile.id;
  clean.error_m = std::isfinite(tile.error_m) ? std::max(tile.error_m, 0.0) : 0.0;
  std::vector<uint32_t> new_index(n, kUnused);
  for (const Triangle& triangle : tile.triangle) {
    SKYQUILT_CHECK(triangle[0] < n && triangle[1] < n && triangle[2] < n, "a triangle of tile " + tile.id.Name() + " has no such vertex");
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) continue;
    if (!tile.position[triangle[0]].allFinite() || !tile.position[triangle[1]].allFinite() || !tile.position[triangle[2]].allFinite()) continue;
    Triangle renumbered;
    for (size_t corner = 0; corner < 3; ++corner) {
      const uint32_t old = triangle[corner];
      if (new_index[old] == kUnused) {
        new_index[old] = static_cast<uint32_t>(clean.position.size());
        clean.position.push_back(tile.position[old]);
        clean.normal.push_back(UnitNormal(tile.normal[old]));
        clean.uv.push_back(tile.uv[old].allFinite() ? tile.uv[old] : Eigen::Vector2f::Zero());
        clean.views.push_back(tile.views[old]);
        clean.filled.push_back(tile.filled[old]);
      }
      renumbered[corner] = new_index[old];
    }
    clean.triangle.push_back(renumbered);
  }
  if (clean.triangle.empty()) return clean;
  clean.atlas_width = tile.atlas_width;
  clean.atlas_height = tile.atlas_height;
  clean.atlas_jpeg = tile.atlas_jpeg;
  return clean;
}

MapVertices VerticesInMap(const TexturedTile& tile, const MapFrame& frame) {
  MapVertices vertices;
  vertices.position.reserve(tile.position.size());
  vertices.normal.reserve(tile.normal.size());
  for (const Eigen::Vector3d& position : tile.position) vertices.position.emplace_back(frame.MapFromEnu(position) - frame.offset());
  for (const Eigen::Vector3f& normal : tile.normal) vertices.normal.push_back(frame.MapDirection(normal));
  return vertices;
}

std::vector<CloudPoint> PointsInMap(std::span<const CloudPoint> points, const MapFrame& frame) {
  std::vector<CloudPoint> in_map;
  in_map.reserve(points.size());
  for (const CloudPoint& point : points) {
    if (!point.position.allFinite()) continue;
    CloudPoint& moved = in_map.emplace_back(point);
    moved.position = frame.MapFromEnu(point.position);
    moved.normal = frame.MapDirection(UnitNormal(point.normal));
  }
  return in_map;
}

double TexelSize(const TexturedTile& tile) {
  if (tile.atlas_jpeg.empty()) return 0.0;
  double surface_m2 = 0.0;
  double texels = 0.0;
  const Eigen::Array2d atlas(tile.atlas_width, tile.atlas_height);
  for (const Triangle& t : tile.triangle) {
    surface_m2 += 0.5 * (tile.position[t[1]] - tile.position[t[0]]).cross(tile.position[t[2]] - tile.position[t[0]]).norm();
    const Eigen::Array2d a = (tile.uv[t[1]] - tile.uv[t[0]]).cast<double>().array() * atlas;
    const Eigen::Array2d b = (tile.uv[t[2]] - tile.uv[t[0]]).cast<double>().array() * atlas;
    texels += 0.5 * std::abs(a.x() * b.y() - a.y() * b.x());
  }
  const double texel_m = std::sqrt(surface_m2 / texels);
  return std::isfinite(texel_m) ? texel_m : 0.0;
}

}  // namespace skyquilt::surface
