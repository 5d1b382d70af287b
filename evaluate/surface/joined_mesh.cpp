#include "evaluate/surface/joined_mesh.h"

#include <algorithm>
#include <limits>

#include "core/base/errors.h"
#include "surface/tile_store.h"

namespace skyquilt::evaluate::surface {

SurfaceMesh::SurfaceMesh(std::vector<skyquilt::surface::TexturedTile> tiles, const std::vector<std::filesystem::path>& files) {
  SKYQUILT_CHECK(files.empty() || files.size() == tiles.size(), "one file per tile");
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
  for (size_t i = 0; i < tiles.size(); ++i) {
    skyquilt::surface::TexturedTile& tile = tiles[i];
    const auto first = static_cast<uint32_t>(position.size());
    Atlas& one = atlas.emplace_back();
    one.first_triangle = static_cast<uint32_t>(triangle.size());
    if (files.empty()) {
      one.jpeg = std::move(tile.atlas_jpeg);
    } else if (tile.atlas_width > 0) {
      one.file = files[i];
    }
    for (const Eigen::Vector3d& p : tile.position) position.push_back((p - middle).cast<float>());
    uv.insert(uv.end(), tile.uv.begin(), tile.uv.end());
    uv.resize(position.size(), Eigen::Vector2f::Zero());
    for (const skyquilt::surface::Triangle& corner : tile.triangle) {
      const bool usable =
          std::all_of(corner.begin(), corner.end(), [&](uint32_t c) { return c < tile.position.size() && tile.position[c].allFinite(); });
      if (!usable) continue;
      triangle.push_back({first + corner[0], first + corner[1], first + corner[2]});
      filled.push_back(std::any_of(corner.begin(), corner.end(), [&](uint32_t c) { return c < tile.filled.size() && tile.filled[c] != 0; }) ? 1 : 0);
    }
    tile = {};  // both together may not fit in memory
  }
}

SurfaceMesh SurfaceMesh::FromFiles(const std::vector<std::filesystem::path>& files) {
  std::vector<skyquilt::surface::TexturedTile> tiles;
  for (const std::filesystem::path& file : files) {
    skyquilt::surface::TexturedTile tile = skyquilt::surface::LoadBakedTile(file).tile;
    if (tile.atlas_jpeg.empty()) tile.atlas_width = 0;
    tile.atlas_jpeg = {};
    tile.normal = {};
    tiles.push_back(std::move(tile));
  }
  return SurfaceMesh(std::move(tiles), files);
}

std::vector<uint8_t> SurfaceMesh::JpegOf(size_t tile) const {
  const Atlas& one = atlas[tile];
  return one.file.empty() ? one.jpeg : skyquilt::surface::LoadBakedTile(one.file).tile.atlas_jpeg;
}

size_t SurfaceMesh::AtlasOf(uint32_t triangle_index) const {
  const auto next =
      std::upper_bound(atlas.begin(), atlas.end(), triangle_index, [](uint32_t index, const Atlas& one) { return index < one.first_triangle; });
  return static_cast<size_t>(next - atlas.begin()) - 1;
}

}  // namespace skyquilt::evaluate::surface
