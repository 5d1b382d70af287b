#include "surface/make_surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <atomic>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "surface/fuse_mesh.h"
#include "surface/fusion/fuse.h"
#include "surface/map_frame.h"
#include "surface/piece_fuser.h"
#include "tests/products/analytic_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/nadir_photo.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::surface {
namespace {

namespace fs = std::filesystem;

// A house on level ground, flown over in a grid of nadir photos.
class MakeSurfaceTest : public ::testing::Test {
 protected:
  MakeSurfaceTest() {
    info_ = scene_.Info({46.8427, -91.994, 180.0}, true);
    survey_.georeferenced = true;
    survey_.origin = info_.origin;
    survey_.cameras.push_back({camera::CameraModel::kPinhole, 400, 300, {300.0, 300.0, 200.0, 150.0}});
    for (int row = -3; row <= 3; ++row) {
      for (int column = -3; column <= 3; ++column) {
        survey::Photo photo = NadirPhoto({18.0 * column, 16.0 * row, 85.0}, "p" + std::to_string(survey_.photos.size()) + ".jpg");
        photo.agl_m = 80.0;
        survey_.photos.push_back(photo);
      }
    }
  }

  SurfaceInput Input(const std::string& name) {
    SurfaceInput input;
    input.options.texel_gsd = 4.0;
    input.info = &info_;
    input.survey = &survey_;
    input.caster = [this](std::span<const render::Ray> rays, std::span<render::RayColor> out) {
      if (stop_after_ >= 0 && rays_ > stop_after_) throw base::Interrupted();
      rays_ += static_cast<int64_t>(rays.size());
      scene_.Caster()(rays, out);
    };
    input.map_resolution_m = 0.5;
    input.memory_bytes = 1e9;
    input.work_key = "key";
    input.work_folder = folder_ / (name + "_work");
    input.out_folder = folder_ / name;
    return input;
  }

  std::vector<std::string> Names(const fs::path& folder) {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file()) names.push_back(fs::relative(entry.path(), folder).generic_string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  // surface.json holds the seconds it took.
  void ExpectSameFiles(const fs::path& a, const fs::path& b) {
    ASSERT_EQ(Names(a), Names(b));
    for (const std::string& name : Names(a)) {
      if (name == "surface.json") continue;
      EXPECT_TRUE(base::ReadFile(a / name) == base::ReadFile(b / name)) << name << " differs";
    }
  }

  const TemporaryFolder folder_;
  products::AnalyticScene scene_;
  scene::SceneInfo info_;
  survey::Survey survey_;
  base::ThreadPool threads_;
  std::atomic<int64_t> rays_ = 0;
  int64_t stop_after_ = -1;
};

TEST_F(MakeSurfaceTest, GroundAndRoofAreWhereTheyAre) {
  const SurfaceInput input = Input("out");
  const SurfaceResult result = MakeSurface(input, threads_);
  EXPECT_GT(result.triangles, 0);
  EXPECT_EQ(result.photos, 49);
  const std::vector<TexturedTile> tiles = LoadFinestTiles(input.work_folder);
  ASSERT_FALSE(tiles.empty());
  size_t n_roof = 0, n_ground = 0;
  for (const TexturedTile& tile : tiles) {
    for (size_t v = 0; v < tile.position.size(); ++v) {
      if (tile.filled[v] != 0) continue;  // measured places only
      const Eigen::Vector3d& x = tile.position[v];
      // Away from the walls, where the mesh turns.
      const bool roof = x.x() > 12.0 && x.x() < 38.0 && x.y() > -18.0 && x.y() < 8.0;
      // Nor at the border of the scene, where few views see the ground, and at a small angle.
      const bool ground = std::abs(x.x()) < 60.0 && (x.x() < 5.0 || x.x() > 45.0);
      // Depths of a level surface have no error but that of single precision; a vertex is the mean of exact crossings.
      if (roof || ground) {
        EXPECT_NEAR(x.z(), roof ? scene_.roof_z : scene_.ground_z, 0.05 * result.voxel_m) << x.transpose();
      }
      n_roof += roof ? 1 : 0;
      n_ground += ground ? 1 : 0;
    }
  }
  EXPECT_GT(n_roof, 4U);
  EXPECT_GT(n_ground, 4U);
  const auto table = base::ParseJson(base::ReadFile(input.out_folder / "surface.json"));
  EXPECT_EQ(table["triangles"].get<int64_t>(), result.triangles);
  EXPECT_EQ(table["non_manifold_edges"].get<int64_t>(), 0);
  EXPECT_EQ(table["crs"], "EPSG:32615");
  for (const auto& row : table["files"]) EXPECT_TRUE(fs::exists(input.out_folder / row["file"].get<std::string>())) << row;
  for (const std::string& name : Names(input.out_folder)) EXPECT_EQ(name.find("partial"), std::string::npos) << name;
}

// As another rank does, but only every second piece. The job and the pictures are read again from their files.
class HalfOfThePieces : public PieceService {
 public:
  int Makers() const override { return 2; }
  double MemoryBytes() const override { return 1e9; }
  void Make(const fs::path& job, std::span<const size_t> pieces, const Made& made) override {
    base::ThreadPool threads(1);
    DepthViews views;
    const PieceFuser fuser = PieceFuser::Read(job, &views);
    for (size_t i = 0; i < pieces.size(); i += 2) {
      fuser.Make(pieces[i], views, threads);
      EXPECT_TRUE(fuser.IsMade(pieces[i]));
      made(pieces[i]);
      ++n_made;
    }
    job_bytes = base::ReadFile(job);
    views_bytes = base::ReadFile(job.parent_path() / "views.bin");
  }
  int n_made = 0;
  std::string job_bytes, views_bytes;
};

TEST_F(MakeSurfaceTest, PiecesMadeElsewhereChangeNothing) {
  const Eigen::Vector2d middle = MapFrame(info_).MapFromEnu(Eigen::Vector3d::Zero()).head<2>();
  const gis::Boundary boundary({{middle + Eigen::Vector2d(-200, -200), middle + Eigen::Vector2d(200, -200), middle + Eigen::Vector2d(0, 30)}});
  SurfaceInput alone = Input("alone");
  alone.boundary = boundary;
  const SurfaceResult all = MakeSurface(alone, threads_);
  HalfOfThePieces others;
  SurfaceInput input = Input("shared");
  input.boundary = boundary;
  input.pieces = &others;
  const SurfaceResult shared = MakeSurface(input, threads_);
  EXPECT_GE(others.n_made, 2);
  EXPECT_EQ(shared.triangles, all.triangles);
  ExpectSameFiles(alone.out_folder, input.out_folder);
  // What another process refuses.
  const fs::path job = folder_ / "pieces.job";
  const auto error_with = [&](const std::string& bytes, const std::string& views) {
    base::WriteFileAtomically(job, bytes);
    base::WriteFileAtomically(folder_ / "views.bin", views);
    DepthViews opened;
    return ErrorOf<base::InputError>([&] { PieceFuser::Read(job, &opened); });
  };
  EXPECT_EQ(error_with(others.job_bytes, others.views_bytes), "");
  std::string damaged = others.job_bytes;
  damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] + 1);
  EXPECT_NE(error_with(damaged, others.views_bytes).find("pieces.job"), std::string::npos);
  EXPECT_NE(error_with(others.job_bytes.substr(0, 40), others.views_bytes).find("pieces.job"), std::string::npos);
  EXPECT_NE(error_with("", others.views_bytes).find("pieces.job"), std::string::npos);
  EXPECT_NE(error_with(others.job_bytes, others.views_bytes.substr(0, 1000)).find("views.bin"), std::string::npos);
}

TEST_F(MakeSurfaceTest, AnInterruptedRunGoesOnWithTheSameResult) {
  MakeSurface(Input("whole"), threads_);
  const int64_t all = rays_;
  const SurfaceInput input = Input("stopped");
  // In the middle of the views, and again in the textures. Rays of finished views are not cast again, so the counts go on.
  rays_ = 0;
  for (const double share : {0.3, 0.99}) {
    stop_after_ = static_cast<int64_t>(share * static_cast<double>(all));
    EXPECT_THROW(MakeSurface(input, threads_), base::Interrupted);
    EXPECT_FALSE(fs::exists(input.out_folder / "surface.json"));
  }
  stop_after_ = -1;
  rays_ = 0;
  MakeSurface(input, threads_);
  EXPECT_LT(rays_, all / 2) << "finished steps are made again";
  ExpectSameFiles(folder_ / "whole", folder_ / "stopped");
}

// The mesh is scored from their poses.
TEST_F(MakeSurfaceTest, HeldOutPosesChangeNothing) {
  for (size_t i = 0; i < survey_.photos.size(); i += 8) survey_.photos[i].is_test = true;
  EXPECT_EQ(MakeSurface(Input("given"), threads_).photos, 42);
  for (survey::Photo& photo : survey_.photos) {
    if (!photo.is_test) continue;
    const Eigen::Vector3d centre = photo.cam_from_enu.OriginInSource() + Eigen::Vector3d(5.0, -4.0, -20.0);
    photo.cam_from_enu.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX())) * photo.cam_from_enu.rotation;
    photo.cam_from_enu.translation = -(photo.cam_from_enu.rotation * centre);
    photo.agl_m = 60.0;
  }
  MakeSurface(Input("moved"), threads_);
  ExpectSameFiles(folder_ / "given", folder_ / "moved");
}

TEST_F(MakeSurfaceTest, ResultsOfOtherOptionsAreNotUsed) {
  SurfaceInput input = Input("out");
  MakeSurface(input, threads_);
  rays_ = 0;
  input.work_key = "other";
  input.options.voxel_gsd = 3.0;
  const SurfaceResult other = MakeSurface(input, threads_);
  EXPECT_GT(rays_, 0);
  EXPECT_NEAR(other.voxel_m, 3.0 * info_.gsd_m, 1e-9);
}

TEST_F(MakeSurfaceTest, TheBoundaryLimitsTheMesh) {
  SurfaceInput input = Input("out");
  const MapFrame frame(info_);
  const Eigen::Vector2d middle = frame.MapFromEnu({-30.0, 0.0, 5.0}).head<2>();
  input.boundary = gis::Boundary(
      {{middle + Eigen::Vector2d(-10, -10), middle + Eigen::Vector2d(10, -10), middle + Eigen::Vector2d(10, 10), middle + Eigen::Vector2d(-10, 10)}});
  const SurfaceResult result = MakeSurface(input, threads_);
  EXPECT_NEAR(result.area_m2 - result.filled_m2, 400.0, 60.0);
  for (const TexturedTile& tile : LoadFinestTiles(input.work_folder)) {
    for (const Eigen::Vector3d& x : tile.position) EXPECT_LT((frame.MapFromEnu(x).head<2>() - middle).cwiseAbs().maxCoeff(), 12.0);
  }
  input = Input("far");
  input.boundary = gis::Boundary({{middle + Eigen::Vector2d(1000, 0), middle + Eigen::Vector2d(1100, 0), middle + Eigen::Vector2d(1000, 100)}});
  EXPECT_NE(ErrorOf<base::UsageError>([&] { MakeSurface(input, threads_); }).find("boundary"), std::string::npos);
  EXPECT_FALSE(fs::exists(input.out_folder / "surface.json"));
}

TEST_F(MakeSurfaceTest, LittleMemoryGivesTheSameMeshAndTooLittleAnAnswer) {
  SurfaceInput input = Input("large");
  input.options.voxel_gsd = 1.0;  // several tiles
  MakeSurface(input, threads_);
  double least = 1e9;
  // Halve it until pieces must be smaller, but none fails.
  for (double memory = 64e6; memory > 1e4; memory /= 2.0) {
    input = Input("small");
    input.options.voxel_gsd = 1.0;
    input.memory_bytes = memory;
    input.work_key = std::to_string(memory);
    try {
      if (std::abs(MakeSurface(input, threads_).voxel_m - info_.gsd_m) > 1e-9) break;
    } catch (const base::UsageError& error) {
      EXPECT_NE(std::string(error.what()).find("memory"), std::string::npos) << error.what();
      break;
    }
    ExpectSameFiles(folder_ / "large", folder_ / "small");
    least = memory;
  }
  EXPECT_LT(least, 1e9);
  input = Input("tiny");
  input.memory_bytes = 1e3;
  EXPECT_NE(ErrorOf<base::UsageError>([&] { MakeSurface(input, threads_); }).find("memory"), std::string::npos);
}

TEST_F(MakeSurfaceTest, TheMeshOfTheSurveyIsKeptWithinItsMemory) {
  SurfaceInput input = Input("whole");
  const SurfaceResult whole = MakeSurface(input, threads_);
  input = Input("bounded");
  input.mesh_bytes = 3.0 * 12.0 * static_cast<double>(whole.triangles);  // its triangles alone would nearly fill it
  const SurfaceResult bounded = MakeSurface(input, threads_);
  EXPECT_GT(bounded.voxel_m, 1.1 * whole.voxel_m);
  EXPECT_LT(bounded.triangles, whole.triangles);
  EXPECT_GT(bounded.triangles, 0);
  EXPECT_NEAR(bounded.area_m2 - bounded.filled_m2, whole.area_m2 - whole.filled_m2, 0.1 * whole.area_m2);
  input = Input("tiny_mesh");
  input.mesh_bytes = 10.0;
  EXPECT_NE(ErrorOf<base::UsageError>([&] { MakeSurface(input, threads_); }).find("--memory"), std::string::npos);
}

TEST_F(MakeSurfaceTest, ASceneWithoutSurfaceIsNoError) {
  SurfaceInput input = Input("fog");
  input.caster = [](std::span<const render::Ray>, std::span<render::RayColor> out) {
    for (render::RayColor& color : out) {
      color.opacity = 0.1F;
      color.depth = color.depth_median = color.depth_front = color.depth_back = std::nanf("");
    }
  };
  const SurfaceResult result = MakeSurface(input, threads_);
  EXPECT_EQ(result.triangles, 0);
  EXPECT_TRUE(result.files.empty());
  EXPECT_EQ(Names(input.out_folder), std::vector<std::string>{"surface.json"});
  EXPECT_TRUE(LoadFinestTiles(input.work_folder).empty());
}

TEST_F(MakeSurfaceTest, ASurveyWithoutPhotosIsNoError) {
  survey_.photos.clear();
  EXPECT_EQ(MakeSurface(Input("none"), threads_).triangles, 0);
}

TEST_F(MakeSurfaceTest, ADamagedTextureIsMadeAgain) {
  const SurfaceInput input = Input("out");
  MakeSurface(input, threads_);
  const std::string before = base::ReadFile(input.out_folder / "mesh.glb");
  for (const fs::directory_entry& entry : fs::directory_iterator(input.work_folder / "textures")) {
    std::string bytes = base::ReadFile(entry.path());
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    base::WriteFileAtomically(entry.path(), bytes);
  }
  MakeSurface(input, threads_);
  EXPECT_TRUE(base::ReadFile(input.out_folder / "mesh.glb") == before);
}

TEST(SplitAlongLattice, DoesNotDependOnThePiece) {
  // Two triangles of one quad around the lattice edge from node (4, 4, 4) upwards: its cells are (3..4, 3..4, 4).
  Mesh mesh;
  for (const Eigen::Vector3i& cell : {Eigen::Vector3i(3, 3, 4), Eigen::Vector3i(4, 3, 4), Eigen::Vector3i(4, 4, 4), Eigen::Vector3i(3, 4, 4)}) {
    mesh.position.push_back(cell.cast<double>());
    mesh.key.push_back(VertexKey(cell, 0));
    mesh.views.push_back(3);
    mesh.filled.push_back(0);
  }
  mesh.triangle = {{0, 1, 2}, {2, 3, 0}};
  const std::vector<MeshTile> tiles = SplitAlongLattice(mesh, 4);
  ASSERT_EQ(tiles.size(), 1U);
  EXPECT_EQ(tiles[0].id, (TileId{0, 1, 1}));
  EXPECT_EQ(tiles[0].mesh.triangle.size(), 2U);
  // Negative indices round down.
  for (uint64_t& key : mesh.key) key = VertexKey(Eigen::Vector3i(-1, -5, 4), 0);
  for (size_t i = 0; i < mesh.key.size(); ++i) mesh.key[i] += static_cast<uint64_t>(i);
  EXPECT_EQ(SplitAlongLattice(mesh, 4)[0].id, (TileId{0, -1, -2}));
}

}  // namespace
}  // namespace skyquilt::surface
