#include "surface/fuse_mesh.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>

#include "core/base/amounts.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/survey/view_kind.h"
#include "surface/fill_gaps.h"
#include "surface/fusion/fuse.h"
#include "surface/mesh/simplify.h"
#include "surface/piece_fuser.h"
#include "surface/views/render_depth_views.h"
#include "surface/views/see_through.h"

namespace skyquilt::surface {
namespace {

constexpr double kLargestGrowth = 3.0;       // of voxels when the memory is short
constexpr double kOffPlaneVoxels = 3.0;      // of the border of a hole that is closed in its plane
constexpr double kLevelIslandVoxels = 12.0;  // edge of the smallest square piece that is kept where photos look level

constexpr size_t kPiecesPerMaker = 4;  // where several ranks make them, so that none waits long for the last

// The whole mesh is joined, cleaned and cut into tiles in memory. At most as many copies of it exist at a time: pieces and what they are joined to,
// or the mesh, its edges and its tiles.
constexpr double kMeshCopies = 3.0;
constexpr double kLargestMeshGrowth = 8.0;  // of voxels when the whole mesh does not fit
constexpr double kLeastStep = 1.15, kLargestStep = 2.0;

// Thrown while pieces are fused; how many times the memory that meshes may take the whole mesh will need.
struct MeshTooLarge {
  double times = 1.0;
};

int FloorDivide(int value, int by) {
  return value >= 0 ? value / by : -((by - 1 - value) / by);
}

// The cell of a vertex from its key, see VertexKey.
Eigen::Vector3i CellOf(uint64_t key) {
  const auto value = [](uint64_t bits, unsigned n) {
    const uint64_t sign = uint64_t{1} << (n - 1);
    return static_cast<int>(static_cast<int64_t>((bits & ((uint64_t{1} << n) - 1)) ^ sign) - static_cast<int64_t>(sign));
  };
  return {value(key >> 44U, 20), value(key >> 24U, 20), value(key >> 6U, 18)};
}

LatticeBox BoxOf(const scene::SceneInfo& info, double voxel_m) {
  const SurfaceBox bounds = SurfaceBoxOf(info);
  LatticeBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.min[axis] = static_cast<int>(std::floor(bounds.min_enu[axis] / voxel_m)) - 1;
    box.max[axis] = static_cast<int>(std::ceil(bounds.max_enu[axis] / voxel_m)) + 2;
  }
  return box;
}

FuseOptions FuseOptionsOf(const SurfaceOptions& options, double voxel_m, bool coarse) {
  FuseOptions fuse;
  fuse.voxel_m = voxel_m;
  fuse.min_views = options.min_views;
  fuse.min_photos = 1;
  fuse.tile_voxels = kTileVoxels;
  fuse.max_angle_deg = kMaxAngle_deg;
  fuse.coarse = coarse;
  return fuse;
}

// How many pieces other ranks get at a time; 0: there are none.
size_t PiecesTogether(const SurfaceInput& input) {
  return input.pieces == nullptr ? 0 : kPiecesPerMaker * static_cast<size_t>(std::max(0, input.pieces->Makers()));
}

// Pieces that fit in memory, of larger voxels if they must be.
PiecePlan MakePlan(const SurfaceInput& input, const DepthViews& views, double voxel_m, bool coarse, base::ThreadPool& threads) {
  PieceWishes wishes;
  if (const size_t together = PiecesTogether(input); together > 0) wishes = {together, input.pieces->MemoryBytes()};
  double voxel = voxel_m;
  while (true) {
    PiecePlan plan{.fuse = FuseOptionsOf(input.options, voxel, coarse), .pieces = {}};
    try {
      plan.pieces = PlanPieces(views.All(), BoxOf(*input.info, voxel), plan.fuse, input.memory_bytes, threads, wishes, &plan.needs_bytes);
      if (voxel > voxel_m) {
        base::LogWarning(
            "the surface is fused in voxels of {:.3g} m instead of {:.3g} m, because a piece of it would not fit into the memory limit; a "
            "larger --memory, with --restart, gives the finer surface",
            voxel, voxel_m);
      }
      return plan;
    } catch (const TooLittleMemory&) {
      if (coarse || !(voxel < kLargestGrowth * voxel_m)) throw;
      voxel = std::min(1.25 * voxel, kLargestGrowth * voxel_m);
    }
  }
}

// What other ranks can make of the pieces from `first` on, while this one waits; those that they leave are made by FusePieces.
void MakeElsewhere(const SurfaceInput& input, const PieceFuser& fuser, const std::string& views_key, size_t first) {
  if (!(fuser.plan().needs_bytes <= input.pieces->MemoryBytes())) return;
  std::vector<size_t> missing;
  for (size_t piece = first; piece < std::min(fuser.plan().pieces.size(), first + PiecesTogether(input)); ++piece) {
    if (!fuser.IsMade(piece)) missing.push_back(piece);
  }
  if (missing.size() < 2) return;
  const std::filesystem::path job = input.work_folder / "pieces.job";
  fuser.Write(job, views_key);
  base::Progress progress("surface mesh on other ranks", static_cast<double>(missing.size()), "pieces");
  input.pieces->Make(job, missing, [&](size_t) { progress.Advance(); });
  progress.Finish();
  std::error_code ignored;
  std::filesystem::remove(job, ignored);
}

std::vector<MeshTile> FusePieces(const SurfaceInput& input, const DepthViews& views, const PieceFuser& fuser, base::ThreadPool& threads,
                                 double* fusing_s) {
  std::filesystem::create_directories(input.work_folder / "pieces");
  views.ReleasePages();
  const size_t together = PiecesTogether(input);
  std::vector<MeshTile> all;
  double bytes = 0.0;
  const size_t n_pieces = fuser.plan().pieces.size();
  base::Progress progress("surface mesh", static_cast<double>(n_pieces), "pieces");
  for (size_t piece = 0; piece < n_pieces; ++piece) {
    base::ThrowIfCancelled();
    if (together > 0 && piece % together == 0) MakeElsewhere(input, fuser, views.key(), piece);
    const auto start = std::chrono::steady_clock::now();
    std::vector<MeshTile> tiles = fuser.Make(piece, views, threads);
    *fusing_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (const MeshTile& tile : tiles) bytes += MeshBytes(tile.mesh);
    std::move(tiles.begin(), tiles.end(), std::back_inserter(all));
    progress.Advance();
    if (const double times = kMeshCopies * bytes / (input.mesh_bytes > 0.0 ? input.mesh_bytes : 0.5 * input.memory_bytes); times > 1.0) {
      throw MeshTooLarge{times * static_cast<double>(n_pieces) / static_cast<double>(piece + 1)};
    }
  }
  // In an order that does not depend on the pieces.
  std::sort(all.begin(), all.end(), [](const MeshTile& a, const MeshTile& b) { return a.id < b.id; });
  progress.Finish();
  return all;
}

// With larger voxels where the whole mesh would not fit into the memory limit: a survey's mesh grows with its area.
std::vector<MeshTile> FuseWithinMemory(const SurfaceInput& input, const DepthViews& views, double voxel_m, bool coarse, base::ThreadPool& threads,
                                       PiecePlan* plan, double* fusing_s) {
  for (double voxel = voxel_m;;) {
    *plan = MakePlan(input, views, voxel, coarse, threads);
    try {
      return FusePieces(input, views, PieceFuser(*plan, *input.info, input.boundary, input.work_folder), threads, fusing_s);
    } catch (const MeshTooLarge& found) {
      // Triangles are as many as voxels on the surface, so they go with the square.
      if (coarse) throw TooLittleMemory("the coarse mesh");
      voxel = plan->fuse.voxel_m * std::clamp(std::sqrt(found.times), kLeastStep, kLargestStep);
      if (voxel > kLargestMeshGrowth * voxel_m) {
        throw TooLittleMemory(fmt::format(
            "--memory: {}B are too small for the mesh of the whole survey, even in voxels of {:.3g} m. Give more memory, choose larger voxels with "
            "surface.voxel_gsd, or a part of the survey with products.boundary",
            base::FormatCount(input.memory_bytes), plan->fuse.voxel_m));
      }
      base::LogWarning(
          "the surface is fused again in voxels of {:.3g} m instead of {:.3g} m, because the mesh of the whole survey would not fit into the memory "
          "limit; a larger --memory, with --restart, gives the finer surface",
          voxel, voxel_m);
    }
  }
}

// Of coarse meshes that close gaps, in pixels of the pictures of depth and voxels of the fine mesh: the first closes panes and small holes, the
// second crowns of woods.
struct Coarseness {
  double pixels = 1.0, voxels = 1.0;
};
constexpr std::array<Coarseness, 2> kCoarseMeshes{{{3.0, 4.0}, {3.0, 12.0}}};
constexpr double kTracedBytes = 150.0;  // of a triangle that rays are traced against

// What the scene shows without its detail, fused from smaller pictures of depth in larger voxels: there photos agree where they do not in every
// detail, on panes and in woods. What it has in gaps of the mesh is added. Its files are in a folder of input.work_folder.
void CloseGaps(const SurfaceInput& input, const DepthViews& views, double voxel_m, const Coarseness& coarseness, base::ThreadPool& threads,
               Mesh* mesh, FusedMesh* result) {
  const double limit_bytes = input.mesh_bytes > 0.0 ? input.mesh_bytes : 0.5 * input.memory_bytes;
  SurfaceInput coarse = input;
  coarse.options.view_gsd *= coarseness.pixels;
  coarse.work_folder = input.work_folder / kCoarseFolder / fmt::format("{:g}", coarseness.voxels);
  coarse.mesh_bytes = std::max(1.0, limit_bytes - MeshBytes(*mesh) - kTracedBytes * static_cast<double>(mesh->triangle.size()));
  std::filesystem::create_directories(coarse.work_folder);
  const double coarse_voxel_m = coarseness.voxels * voxel_m;
  try {
    PiecePlan plan;
    std::vector<Mesh> meshes;
    {
      const DepthViews coarse_views = RenderDepthViews(coarse, coarse_voxel_m, threads);
      for (MeshTile& tile : FuseWithinMemory(coarse, coarse_views, coarse_voxel_m, true, threads, &plan, &result->fusing_s)) {
        meshes.push_back(std::move(tile.mesh));
      }
    }
    Mesh one = MergeMeshes(std::move(meshes));
    DropIslands(&one, input.options.min_island_m2);
    result->filled_m2 += FillGaps(one, coarse_voxel_m, views.All(), threads, mesh);
    views.ReleasePages();
  } catch (const TooLittleMemory&) {
    base::LogWarning(
        "gaps of the surface stay open, because a coarse mesh that closes them would not fit into the memory limit; a larger --memory, with "
        "--restart, closes them");
  }
}

}  // namespace

double MeshBytes(const Mesh& mesh) {
  constexpr size_t kVertex = sizeof(Eigen::Vector3d) + sizeof(uint64_t) + 2;
  return static_cast<double>(mesh.key.size() * kVertex + mesh.triangle.size() * sizeof(Triangle));
}

std::vector<MeshTile> SplitAlongLattice(const Mesh& mesh, int tile_voxels) {
  // The four cells around a lattice edge reach from its lower node to one less in both directions across it, so the largest cell of any three of them
  // is that node.
  std::map<TileId, std::vector<Triangle>> triangles;
  for (const Triangle& t : mesh.triangle) {
    const Eigen::Vector3i node = CellOf(mesh.key[t[0]]).cwiseMax(CellOf(mesh.key[t[1]])).cwiseMax(CellOf(mesh.key[t[2]]));
    triangles[{0, FloorDivide(node.x(), tile_voxels), FloorDivide(node.y(), tile_voxels)}].push_back(t);
  }
  std::vector<MeshTile> tiles;
  for (auto& [id, of_tile] : triangles) {
    MeshTile tile{.id = id, .mesh = {}, .error_m = 0.0};
    std::vector<uint32_t> vertices;
    for (const Triangle& t : of_tile) vertices.insert(vertices.end(), t.begin(), t.end());
    std::sort(vertices.begin(), vertices.end(), [&](uint32_t a, uint32_t b) { return mesh.key[a] < mesh.key[b]; });
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    for (const uint32_t v : vertices) {
      tile.mesh.position.push_back(mesh.position[v]);
      tile.mesh.key.push_back(mesh.key[v]);
      tile.mesh.views.push_back(mesh.views[v]);
      tile.mesh.filled.push_back(mesh.filled[v]);
    }
    const auto index_of = [&](uint32_t v) {
      const auto found = std::lower_bound(tile.mesh.key.begin(), tile.mesh.key.end(), mesh.key[v]);
      return static_cast<uint32_t>(found - tile.mesh.key.begin());
    };
    for (const Triangle& t : of_tile) {
      // Begin with the smallest index, so that the order does not depend on the piece either.
      Triangle own = {index_of(t[0]), index_of(t[1]), index_of(t[2])};
      std::rotate(own.begin(), std::min_element(own.begin(), own.end()), own.end());
      tile.mesh.triangle.push_back(own);
    }
    std::sort(tile.mesh.triangle.begin(), tile.mesh.triangle.end());
    tiles.push_back(std::move(tile));
  }
  return tiles;
}

FusedMesh FuseMesh(const SurfaceInput& input, const DepthViews& views, double voxel_m, base::ThreadPool& threads) {
  PiecePlan plan;
  FusedMesh result;
  std::vector<MeshTile> tiles = FuseWithinMemory(input, views, voxel_m, false, threads, &plan, &result.fusing_s);
  result.voxel_m = plan.fuse.voxel_m;
  result.tile_size_m = kTileVoxels * plan.fuse.voxel_m;
  const bool any = !tiles.empty();  // also when the boundary left nothing of them
  double error_m = 0.0;
  std::vector<Mesh> meshes;
  for (MeshTile& tile : tiles) {
    error_m = std::max(error_m, tile.error_m);
    meshes.push_back(std::move(tile.mesh));
  }
  Mesh mesh = MergeMeshes(std::move(meshes));
  if (input.boundary && mesh.triangle.empty() && any) {
    throw base::UsageError(
        "the boundary leaves nothing of the surface: it does not meet it. Give products.boundary a polygon that does, or none, or set "
        "surface.edge_photos to 0");
  }
  const bool level = survey::LooksLevel(*input.survey);
  // Things along a wall or in a room are small, and without a place on Earth the frame's metres say nothing.
  const double island_m = level ? kLevelIslandVoxels * result.voxel_m : std::numeric_limits<double>::infinity();
  const int islands = DropIslands(&mesh, std::min(input.options.min_island_m2, island_m * island_m));
  const double spacing_m = 4.0 * result.voxel_m;
  result.filled_m2 = FillGroundHoles(&mesh, kMaxHole_m2, spacing_m);
  if (level) {
    const std::vector<DepthView> pictures = views.All();
    const double truncation_m = plan.fuse.truncation_voxels * result.voxel_m;
    const auto is_open = [&](const Eigen::Vector3d& x, const Eigen::Vector3d& normal) { return SeesThrough(pictures, x, normal, truncation_m); };
    result.filled_m2 += FillPlanarHoles(&mesh, kMaxHole_m2, spacing_m, kOffPlaneVoxels * result.voxel_m, is_open);
    views.ReleasePages();
  }
  if (input.options.fill_gaps && !level && !mesh.triangle.empty()) {
    for (const Coarseness& coarseness : kCoarseMeshes) CloseGaps(input, views, result.voxel_m, coarseness, threads, &mesh, &result);
  }
  result.edges = CountEdges(mesh);
  result.area_m2 = Area(mesh);
  result.tiles = SplitIntoTiles(mesh, result.tile_size_m);
  for (MeshTile& tile : result.tiles) tile.error_m = error_m;
  base::LogInfo("surface of {} triangles and {:.0f} m2 in {} tile(s); {} small piece(s) dropped, {:.0f} m2 of gaps closed",
                base::FormatCount(static_cast<double>(mesh.triangle.size())), result.area_m2, result.tiles.size(), islands, result.filled_m2);
  return result;
}

}  // namespace skyquilt::surface
