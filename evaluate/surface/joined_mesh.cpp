#include "evaluate/surface/joined_mesh.h"

#include <algorithm>
#include <limits>

#include "core/base/errors.h"

namespace skyquilt::evaluate::surface {

SurfaceMesh::SurfaceMesh(std::vector<skyquilt::surface::TexturedTile> tiles) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  size_t positions = 0;
  for (const skyquilt::surface::TexturedTile& tile : tiles) {
    positions += tile.position.size();
    for (const Eigen::Vector3d& p : tile.position) {
      if (!p.allFinite()) continue;
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  SKYQUILT_CHECK(positions < std::numeric_limits<uint32_t>::max(), "too many vertices for indices of 32 bits");
  if ((low.array() <= high.array()).all()) middle = 0.5 * (low + high);
  position.reserve(positions);
  uv.reserve(positions);
  for (skyquilt::surface::TexturedTile& tile : tiles) {
    const auto first = static_cast<uint32_t>(position.size());
    atlas.push_back({.jpeg = std::move(tile.atlas_jpeg), .first_triangle = static_cast<uint32_t>(triangle.size())});
    for (const Eigen::Vector3d& p : tile.position) position.push_back((p - middle).cast<float>());
    uv.insert(uv.end(), tile.uv.begin(), tile.uv.end());
    uv.resize(position.size(), Eigen::Vector2f::Zero());
    for (const skyquilt::surface::Triangle& corner : tile.triangle) {
      const bool usable =
          std::all_of(corner.begin(), corner.end(), [&](uint32_t c) { return c < tile.position.size() && tile.position[c].allFinite(); });
      if (usable) triangle.push_back({first + corner[0], first + corner[1], first + corner[2]});
    }
    tile = {};  // both together may not fit in memory
  }
}

size_t SurfaceMesh::AtlasOf(uint32_t triangle_index) const {
  const auto next =
      std::upper_bound(atlas.begin(), atlas.end(), triangle_index, [](uint32_t index, const Atlas& one) { return index < one.first_triangle; });
  return static_cast<size_t>(next - atlas.begin()) - 1;
}

}  // namespace skyquilt::evaluate::surface
