#include "surface/piece_fuser.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/packed_bytes.h"
#include "surface/fuse_mesh.h"
#include "surface/map_frame.h"
#include "surface/mesh/mesh_tools.h"
#include "surface/mesh/simplify.h"
#include "surface/surface_options.h"
#include "surface/tile_store.h"

namespace skyquilt::surface {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDamagedJob = "is damaged";
constexpr const char* kAgain = "Run 'skyquilt surface' again; it makes the file anew";
constexpr size_t kJobHashChars = 16;

void SimplifyTiles(std::vector<MeshTile>* tiles, double max_error_m, base::ThreadPool& threads) {
  if (!(max_error_m > 0.0)) return;
  threads.ParallelFor(static_cast<int64_t>(tiles->size()), [&](int64_t i, int) {
    if (base::CancelRequested()) return;
    MeshTile& tile = (*tiles)[static_cast<size_t>(i)];
    tile.mesh = Simplify(tile.mesh, max_error_m, &tile.error_m);
  });
  base::ThrowIfCancelled();
}

void PackPlan(const PiecePlan& plan, base::BytePacker* bytes) {
  const FuseOptions& fuse = plan.fuse;
  for (const double value : {fuse.voxel_m, fuse.truncation_voxels, fuse.max_angle_deg}) bytes->Add(value);
  for (const int value : {fuse.min_views, fuse.min_photos, fuse.tile_voxels, fuse.coarse ? 1 : 0}) bytes->Add(value);
  bytes->AddCount(plan.pieces.size());
  for (const LatticeBox& piece : plan.pieces) {
    for (int axis = 0; axis < 3; ++axis) {
      bytes->Add(piece.min[axis]);
      bytes->Add(piece.max[axis]);
    }
  }
}

PiecePlan UnpackPlan(base::ByteUnpacker* bytes) {
  PiecePlan plan;
  for (double* value : {&plan.fuse.voxel_m, &plan.fuse.truncation_voxels, &plan.fuse.max_angle_deg}) bytes->Take(value);
  int coarse = 0;
  for (int* value : {&plan.fuse.min_views, &plan.fuse.min_photos, &plan.fuse.tile_voxels, &coarse}) bytes->Take(value);
  plan.fuse.coarse = coarse != 0;
  plan.pieces.resize(bytes->TakeCount(6 * sizeof(int)));
  for (LatticeBox& piece : plan.pieces) {
    for (int axis = 0; axis < 3; ++axis) {
      bytes->Take(&piece.min[axis]);
      bytes->Take(&piece.max[axis]);
    }
  }
  return plan;
}

void PackBoundary(const std::optional<gis::Boundary>& boundary, base::BytePacker* bytes) {
  bytes->Add(static_cast<uint8_t>(boundary ? 1 : 0));
  if (!boundary) return;
  bytes->AddCount(boundary->rings().size());
  for (const std::vector<Eigen::Vector2d>& ring : boundary->rings()) {
    std::vector<double> coordinates;
    for (const Eigen::Vector2d& corner : ring) coordinates.insert(coordinates.end(), {corner.x(), corner.y()});
    bytes->Add(coordinates);
  }
}

std::optional<gis::Boundary> UnpackBoundary(base::ByteUnpacker* bytes) {
  bool any = false;
  bytes->Take(&any);
  if (!any) return std::nullopt;
  std::vector<std::vector<Eigen::Vector2d>> rings(bytes->TakeCount(sizeof(uint64_t)));
  for (std::vector<Eigen::Vector2d>& ring : rings) {
    const auto coordinates = bytes->Take<std::vector<double>>();
    for (size_t i = 0; i + 1 < coordinates.size(); i += 2) ring.emplace_back(coordinates[i], coordinates[i + 1]);
  }
  return gis::Boundary(std::move(rings));
}

}  // namespace

PieceFuser::PieceFuser(PiecePlan plan, const scene::SceneInfo& info, std::optional<gis::Boundary> boundary, fs::path work_folder)
    : plan_(std::move(plan)), boundary_(std::move(boundary)), work_folder_(std::move(work_folder)) {
  place_.origin = info.origin;
  place_.georeferenced = info.georeferenced;
  place_.min_enu = info.min_enu;
  place_.max_enu = info.max_enu;
}

void PieceFuser::Write(const fs::path& job, const std::string& views_key) const {
  base::BytePacker bytes;
  bytes.Add(views_key);
  PackPlan(plan_, &bytes);
  bytes.Add(place_.origin);
  bytes.Add(static_cast<uint8_t>(place_.georeferenced ? 1 : 0));
  for (const Eigen::Vector3d& corner : {place_.min_enu, place_.max_enu}) {
    for (int axis = 0; axis < 3; ++axis) bytes.Add(corner[axis]);
  }
  PackBoundary(boundary_, &bytes);
  base::WriteFileAtomically(job, base::HashHex(bytes.bytes()) + bytes.bytes());
}

PieceFuser PieceFuser::Read(const fs::path& job, DepthViews* views) {
  const std::string text = base::ReadFile(job);
  const std::string_view content = std::string_view(text).substr(std::min(kJobHashChars, text.size()));
  if (text.size() < kJobHashChars || base::HashHex(content) != text.substr(0, kJobHashChars)) throw base::InputError(job, kDamagedJob, kAgain);
  base::ByteUnpacker bytes(content, kDamagedJob);
  try {
    const auto views_key = bytes.Take<std::string>();
    PiecePlan plan = UnpackPlan(&bytes);
    scene::SceneInfo place;
    bytes.Take(&place.origin);
    bytes.Take(&place.georeferenced);
    for (Eigen::Vector3d* corner : {&place.min_enu, &place.max_enu}) {
      for (int axis = 0; axis < 3; ++axis) bytes.Take(&(*corner)[axis]);
    }
    std::optional<gis::Boundary> boundary = UnpackBoundary(&bytes);
    bytes.End();
    *views = DepthViews::Open(job.parent_path() / "views.bin");
    if (views->key() != views_key) {
      throw base::InputError(job.parent_path() / "views.bin", "is not the file that rank 0 sees", "All ranks must see the same project folder");
    }
    return {std::move(plan), place, std::move(boundary), job.parent_path()};
  } catch (const base::UnreadableBytes&) {
    throw base::InputError(job, kDamagedJob, kAgain);
  }
}

// Named after the voxel too, which another memory limit may change.
fs::path PieceFuser::FileOf(size_t piece) const {
  const LatticeBox& box = plan_.pieces[piece];
  return work_folder_ / "pieces" /
         fmt::format("{:016x}_{}_{}_{}_{}.bin", std::bit_cast<uint64_t>(plan_.fuse.voxel_m), box.min.x(), box.min.y(), box.max.x(), box.max.y());
}

bool PieceFuser::IsMade(size_t piece) const {
  std::error_code ignored;
  return fs::exists(FileOf(piece), ignored);
}

std::vector<MeshTile> PieceFuser::Make(size_t piece, const DepthViews& views, base::ThreadPool& threads) const {
  const fs::path file = FileOf(piece);
  std::vector<MeshTile> tiles;
  if (LoadFinished(file, &LoadMeshTiles, "the piece", &tiles)) return tiles;
  fs::create_directories(file.parent_path());
  tiles = SplitAlongLattice(FusePiece(views.All(), plan_.pieces[piece], plan_.fuse, threads), kTileVoxels);
  views.ReleasePages();
  CutToBoundary(&tiles);
  if (!plan_.fuse.coarse) SimplifyTiles(&tiles, kSimplifyVoxels * plan_.fuse.voxel_m, threads);
  SaveMeshTiles(tiles, file);
  return tiles;
}

// Before simplification, while triangles are as small as voxels, so that the new border is smooth.
void PieceFuser::CutToBoundary(std::vector<MeshTile>* tiles) const {
  if (!boundary_) return;
  const MapFrame frame(place_);
  for (MeshTile& tile : *tiles) {
    Mesh& mesh = tile.mesh;
    std::erase_if(mesh.triangle, [&](const Triangle& t) {
      const auto is_inside = [&](const Eigen::Vector3d& x) { return boundary_->Contains(frame.MapFromEnu(x).head<2>()); };
      if (plan_.fuse.coarse) return !std::all_of(t.begin(), t.end(), [&](uint32_t v) { return is_inside(mesh.position[v]); });
      return !is_inside((mesh.position[t[0]] + mesh.position[t[1]] + mesh.position[t[2]]) / 3.0);
    });
    DropUnusedVertices(&mesh);
  }
}

}  // namespace skyquilt::surface
