#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/progress.h"
#include "surface/mesh/mesh_tools.h"
#include "surface/mesh/simplify.h"

namespace skyquilt::surface {
namespace {

// Only tiles around the origin; going up would not join them any more.
bool IsTop(const MeshTile& tile) {
  return (tile.id.column == -1 || tile.id.column == 0) && (tile.id.row == -1 || tile.id.row == 0);
}

int TileNumber(double coordinate_m, double tile_size_m) {
  constexpr double kLargest = 1 << 30;
  return static_cast<int>(std::clamp(std::floor(coordinate_m / tile_size_m), -kLargest, kLargest));
}

MeshTile JoinChildren(const TileId& id, const std::vector<const MeshTile*>& children, double max_error_m) {
  std::vector<Mesh> pieces;
  double children_error_m = 0.0, own_error_m = 0.0;
  for (const MeshTile* child : children) {
    pieces.push_back(child->mesh);
    children_error_m = std::max(children_error_m, child->error_m);
  }
  MeshTile tile{id, Simplify(MergeMeshes(std::move(pieces)), max_error_m, &own_error_m), 0.0};
  tile.error_m = children_error_m + own_error_m;
  return tile;
}

}  // namespace

std::vector<MeshTile> SplitIntoTiles(const Mesh& mesh, double tile_size_m) {
  SKYQUILT_CHECK(tile_size_m > 0.0 && std::isfinite(tile_size_m), "tile size " + std::to_string(tile_size_m));
  std::map<TileId, std::vector<size_t>> triangles;
  for (size_t i = 0; i < mesh.triangle.size(); ++i) {
    const Triangle& t = mesh.triangle[i];
    const Eigen::Vector3d middle = (mesh.position[t[0]] + mesh.position[t[1]] + mesh.position[t[2]]) / 3.0;
    if (!middle.allFinite()) continue;
    triangles[{0, TileNumber(middle.x(), tile_size_m), TileNumber(middle.y(), tile_size_m)}].push_back(i);
  }
  std::vector<MeshTile> tiles;
  tiles.reserve(triangles.size());
  for (const auto& [id, of_tile] : triangles) {
    MeshTile tile{id, {}, 0.0};
    std::vector<uint32_t> vertices;
    for (const size_t i : of_tile) vertices.insert(vertices.end(), mesh.triangle[i].begin(), mesh.triangle[i].end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    tile.mesh.position.reserve(vertices.size());
    tile.mesh.key.reserve(vertices.size());
    tile.mesh.views.reserve(vertices.size());
    tile.mesh.filled.reserve(vertices.size());
    tile.mesh.triangle.reserve(of_tile.size());
    for (const uint32_t v : vertices) {
      tile.mesh.position.push_back(mesh.position[v]);
      tile.mesh.key.push_back(mesh.key[v]);
      tile.mesh.views.push_back(mesh.views[v]);
      tile.mesh.filled.push_back(mesh.filled[v]);
    }
    const auto index_of = [&](uint32_t v) { return static_cast<uint32_t>(std::lower_bound(vertices.begin(), vertices.end(), v) - vertices.begin()); };
    for (const size_t i : of_tile) {
      const Triangle& t = mesh.triangle[i];
      tile.mesh.triangle.push_back({index_of(t[0]), index_of(t[1]), index_of(t[2])});
    }
    tiles.push_back(std::move(tile));
  }
  return tiles;
}

std::vector<MeshTile> BuildLevels(std::vector<MeshTile> finest, double max_error_m, base::ThreadPool& threads) {
  std::vector<MeshTile> all = std::move(finest);
  std::erase_if(all, [](const MeshTile& tile) { return tile.mesh.triangle.empty(); });
  std::sort(all.begin(), all.end(), [](const MeshTile& a, const MeshTile& b) { return a.id < b.id; });
  base::Progress progress("surface levels", 0.0, "tiles");
  size_t level_begin = 0;
  while (all.size() - level_begin > 1 && !std::all_of(all.begin() + static_cast<std::ptrdiff_t>(level_begin), all.end(), IsTop)) {
    std::map<TileId, std::vector<const MeshTile*>> children;
    for (size_t i = level_begin; i < all.size(); ++i) children[all[i].id.Parent()].push_back(&all[i]);
    const std::vector<std::pair<TileId, std::vector<const MeshTile*>>> parents(children.begin(), children.end());
    std::vector<MeshTile> coarser(parents.size());
    threads.ParallelFor(static_cast<int64_t>(parents.size()), [&](int64_t i, int) {
      if (base::CancelRequested()) return;
      const auto& [id, of_parent] = parents[static_cast<size_t>(i)];
      coarser[static_cast<size_t>(i)] = JoinChildren(id, of_parent, std::ldexp(max_error_m, id.level));
      progress.Advance();
    });
    base::ThrowIfCancelled();
    level_begin = all.size();
    all.insert(all.end(), std::make_move_iterator(coarser.begin()), std::make_move_iterator(coarser.end()));
  }
  progress.Finish();
  return all;
}

}  // namespace skyquilt::surface
