#include "surface/make_surface.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <set>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/survey/photo_pictures.h"
#include "core/survey/view_kind.h"
#include "surface/files/surface_files.h"
#include "surface/fuse_mesh.h"
#include "surface/maps/surface_maps.h"
#include "surface/mesh/simplify.h"
#include "surface/refine/refine_views.h"
#include "surface/surface_table.h"
#include "surface/views/render_depth_views.h"

namespace skyquilt::surface {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWorkVersion = "6";  // of the files in the work folder

fs::path TextureFolder(const fs::path& work_folder) {
  return work_folder / "textures";
}

// Results of other inputs or options are removed, so that files of two surfaces never stand side by side.
void OpenWorkFolder(const SurfaceInput& input) {
  const fs::path key_file = input.work_folder / "key.txt";
  const std::string key = std::string(kWorkVersion) + " " + input.work_key + "\n";
  if (fs::exists(key_file) && base::ReadFile(key_file) == key) return;
  std::error_code error;
  for (const fs::path& folder : {input.work_folder, input.out_folder}) {
    fs::remove_all(folder, error);
    if (error) throw base::InputError(folder, "cannot be removed: " + error.message(), "Check the permissions of the project folder");
  }
  base::RequireWritableFolder(input.work_folder);
  base::WriteFileAtomically(key_file, key);
}

// Whether a file of that folder is a texture of level 0.
bool IsFinest(const fs::path& file) {
  return file.filename().string().starts_with("0_") && file.extension() == ".bin";
}

// Textures of another mesh, which another memory limit may have given, or of other photos are removed.
void OpenTextureFolder(const fs::path& work_folder, double voxel_m, double area_m2, const std::string& photos) {
  const fs::path folder = TextureFolder(work_folder);
  const fs::path key_file = folder / "key.txt";
  const std::string key = fmt::format("{:016x} {:016x} {}\n", std::bit_cast<uint64_t>(voxel_m), std::bit_cast<uint64_t>(area_m2), photos);
  if (fs::exists(key_file) && base::ReadFile(key_file) == key) return;
  fs::remove_all(folder);
  fs::create_directories(folder);
  base::WriteFileAtomically(key_file, key);
}

BakeOptions BakeOptionsOf(const SurfaceInput& input, const MeshTile& tile, double voxel_m) {
  BakeOptions bake;
  bake.texel_m = input.options.texel_gsd * input.info->gsd_m * static_cast<double>(1U << static_cast<unsigned>(std::min(tile.id.level, 20)));
  bake.jpeg_quality = input.options.jpeg_quality;
  bake.point_spacing_m = tile.id.level == 0 && input.options.cloud ? voxel_m : 0.0;
  return bake;
}

// Sets which points are ground: those of the terrain's height.
void ClassifyPoints(const HeightRaster& terrain, const MapFrame& frame, double low_m, std::vector<CloudPoint>* points) {
  constexpr uint8_t kGround = 2;
  const gis::MapGrid& grid = terrain.grid;
  for (CloudPoint& point : *points) {
    const Eigen::Vector3d in_map = frame.MapFromEnu(point.position);
    const Eigen::Vector2d cell = grid.CellOf(in_map.head<2>()).array().round();
    if (!(cell.x() >= 0.0 && cell.y() >= 0.0 && cell.x() < grid.width && cell.y() < grid.height)) continue;
    const float ground = terrain.height_m[grid.Index(static_cast<int>(cell.x()), static_cast<int>(cell.y()))];
    if (std::abs(in_map.z() - static_cast<double>(ground)) <= low_m) point.las_class = kGround;
  }
}

class SurfaceBuilder {
 public:
  SurfaceBuilder(const SurfaceInput& input, base::ThreadPool& threads) : input_(input), threads_(threads), frame_(*input.info, input.vertical) {
    if (!frame_.heights().Caution().empty()) base::LogWarning("{}", frame_.heights().Caution());
    // The tiles need the geoid at the end: without it, hours of work would be lost then.
    if (input.options.tiles) frame_.heights().In(geo::Vertical::kEllipsoid);
  }

  SurfaceResult Make() {
    const auto start = std::chrono::steady_clock::now();
    OpenWorkFolder(input_);
    base::RequireWritableFolder(input_.out_folder);
    fs::remove(input_.out_folder / "surface.json");  // an older one must not vouch for an unfinished surface
    {
      const double voxel_m = input_.options.voxel_gsd * input_.info->gsd_m;
      const DepthViews views = RenderDepthViews(input_, voxel_m, threads_, Refinement());
      for (size_t i = 0; i < views.size(); ++i) ++(views.pose(i).photo >= 0 ? result_.photos : result_.virtual_views);
      FusedMesh fused = FuseMesh(input_, views, voxel_m, threads_);
      result_.voxel_m = fused.voxel_m;
      result_.area_m2 = fused.area_m2;
      result_.filled_m2 = fused.filled_m2;
      result_.fusing_s = fused.fusing_s;
      edges_ = fused.edges;
      for (const MeshTile& tile : fused.tiles) result_.triangles += static_cast<int64_t>(tile.mesh.triangle.size());
      if (result_.triangles == 0) {
        base::LogWarning(
            "no surface was found: too few photos see the same places, or the scene is still fog. No mesh, cloud, tiles or maps are made. Train "
            "longer, raise surface.max_spread_voxels or lower surface.min_views");
      } else {
        MakeProducts(std::move(fused), views);
      }
    }
    result_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    WriteSurfaceTable(result_, edges_, frame_, input_.out_folder / "surface.json");
    // Only the textures are needed again, by scores.
    std::error_code ignored;
    for (const char* done : {"views", "views.bin", "pieces", "pieces.job", kCoarseFolder}) fs::remove_all(input_.work_folder / done, ignored);
    RemoveCoarseTextures();
    return std::move(result_);
  }

 private:
  ImprovePhotoViews Refinement() const {
    if (!input_.options.refine || input_.photos == nullptr) return {};
    return [this](std::span<const ViewPose> poses, const std::string& key, const fs::path& folder, std::vector<fs::path>* files) {
      RefineViews(input_, poses, key, folder, files, threads_);
    };
  }

  // Scores need those of level 0 only.
  void RemoveCoarseTextures() const {
    const fs::path folder = TextureFolder(input_.work_folder);
    if (!fs::is_directory(folder)) return;
    std::vector<fs::path> coarse;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      if (entry.path().extension() == ".bin" && !IsFinest(entry.path())) coarse.push_back(entry.path());
    }
    std::error_code ignored;
    for (const fs::path& file : coarse) fs::remove(file, ignored);
  }

  void MakeProducts(FusedMesh fused, const DepthViews& views) {
    SurfaceMaps maps = MakeMaps(fused.tiles);
    const double max_error_m = kSimplifyVoxels * fused.voxel_m;
    const double tile_size_m = fused.tile_size_m;
    std::vector<MeshTile> levels = input_.options.tiles ? BuildLevels(std::move(fused.tiles), max_error_m, threads_) : std::move(fused.tiles);
    const SurfaceOptions& options = input_.options;
    SurfaceFiles files(frame_, {.glb = options.glb, .obj = options.obj, .ply = options.ply, .cloud = options.cloud, .tiles = options.tiles},
                       tile_size_m, input_.out_folder);
    BakeAll(std::move(levels), views, fused.voxel_m, std::move(maps.terrain), &files);
    result_.files = files.Close();
    std::move(maps.files.begin(), maps.files.end(), std::back_inserter(result_.files));
  }

  SurfaceMaps MakeMaps(const std::vector<MeshTile>& tiles) {
    if (!input_.options.maps && !input_.options.cloud) return {};  // the cloud needs the terrain for its classes
    const gis::MapGrid grid = PlanSurfaceGrid(tiles, frame_, input_.map_resolution_m);
    return MakeSurfaceMaps(RasteriseSurface(tiles, frame_, grid), frame_, input_.boundary, input_.options, input_.out_folder, threads_);
  }

  void BakeAll(std::vector<MeshTile> tiles, const DepthViews& views, double voxel_m, HeightRaster terrain, SurfaceFiles* files) {
    OpenTextureFolder(input_.work_folder, voxel_m, result_.area_m2, input_.photos ? input_.photos->identity() : "none");
    double triangles = 0.0;
    for (const MeshTile& tile : tiles) triangles += static_cast<double>(tile.mesh.triangle.size());
    TextureBaker baker(input_, views, voxel_m);
    base::Progress progress("surface texture", triangles, "triangles");
    for (MeshTile& tile : tiles) {
      base::ThrowIfCancelled();
      if (tile.id.level > 0) terrain = {};  // only points of level 0 have classes
      const fs::path file = TextureFolder(input_.work_folder) / (tile.id.Name() + ".bin");
      BakedTile baked;
      if (!LoadFinished(file, &LoadBakedTile, "the texture", &baked)) {
        baked = baker.Bake(tile, BakeOptionsOf(input_, tile, voxel_m), threads_);
        ClassifyPoints(terrain, frame_, input_.options.terrain_low_m, &baked.points);
        SaveBakedTile(baked, file);
      }
      files->Add(baked.tile);
      files->AddPoints(baked.points);
      result_.points += static_cast<int64_t>(baked.points.size());
      views.ReleasePages();
      const auto done = static_cast<double>(tile.mesh.triangle.size());
      tile.mesh = {};
      progress.Advance(done);
    }
    progress.Finish();
    const std::set<std::string> unread = baker.Failures();
    survey::WarnOfUnreadPhotos("the texture", {unread.begin(), unread.end()}, input_.survey->photos.size());
  }

  const SurfaceInput& input_;
  base::ThreadPool& threads_;
  MapFrame frame_;
  SurfaceResult result_;
  EdgeCounts edges_;
};

}  // namespace

SurfaceResult MakeSurface(const SurfaceInput& input, base::ThreadPool& threads) {
  SKYQUILT_CHECK(input.info != nullptr && input.survey != nullptr && input.caster, "scene, survey and caster must be set");
  input.options.Check();
  return SurfaceBuilder(input, threads).Make();
}

std::vector<fs::path> FinestTileFiles(const fs::path& work_folder) {
  std::set<fs::path> files;
  if (fs::is_directory(TextureFolder(work_folder))) {
    for (const fs::directory_entry& entry : fs::directory_iterator(TextureFolder(work_folder))) {
      if (IsFinest(entry.path())) files.insert(entry.path());
    }
  }
  return {files.begin(), files.end()};
}

std::vector<TexturedTile> LoadFinestTiles(const fs::path& work_folder) {
  std::vector<TexturedTile> tiles;
  for (const fs::path& file : FinestTileFiles(work_folder)) tiles.push_back(std::move(LoadBakedTile(file).tile));
  return tiles;
}

}  // namespace skyquilt::surface
