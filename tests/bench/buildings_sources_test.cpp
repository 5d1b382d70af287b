// Surfaces that are not trained: true depth and sparse points of a made place.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "bench/study/sparse_cloud.h"
#include "bench/study/true_rays.h"
#include "buildings/make_buildings.h"
#include "core/base/errors.h"
#include "core/image/image.h"
#include "surface/make_surface.h"
#include "tests/buildings/sample_buildings.h"
#include "tests/buildings/sample_clouds.h"
#include "tests/evaluate/surface/surface_sample.h"
#include "tests/support/nadir_photo.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::bench {
namespace {

using survey::SurfaceClass;

constexpr double kDeck_m = 6.0, kWest_m = -8.0, kEast_m = 8.0, kSouth_m = -5.0, kNorth_m = 5.0;

void AddWall(const Eigen::Vector2d& from, const Eigen::Vector2d& to, evaluate::surface::TrueSurface* truth) {
  const auto first = static_cast<uint32_t>(truth->position.size());
  for (const auto& [at, z] : {std::pair{from, 0.0}, {to, 0.0}, {to, kDeck_m}, {from, kDeck_m}}) {
    truth->position.push_back((Eigen::Vector3d(at.x(), at.y(), z) - truth->middle).cast<float>());
  }
  truth->triangle.push_back({first, first + 1, first + 2});
  truth->triangle.push_back({first, first + 2, first + 3});
  truth->class_id.resize(truth->triangle.size(), static_cast<uint8_t>(SurfaceClass::kWall));
}

// A box of 16 x 10 x 6 m on level ground.
evaluate::surface::TrueSurface BoxOnGround() {
  evaluate::surface::TrueSurface truth;
  truth.middle = {3.0, -2.0, 1.0};
  evaluate::surface::AddPlate({-60, -60, 60, 60, 0}, SurfaceClass::kGround, &truth);
  evaluate::surface::AddPlate({kWest_m, kSouth_m, kEast_m, kNorth_m, kDeck_m}, SurfaceClass::kRoof, &truth);
  const std::vector<Eigen::Vector2d> ring = {{kWest_m, kSouth_m}, {kEast_m, kSouth_m}, {kEast_m, kNorth_m}, {kWest_m, kNorth_m}};
  for (size_t i = 0; i < ring.size(); ++i) AddWall(ring[i], ring[(i + 1) % ring.size()], &truth);
  return truth;
}

render::Ray RayTo(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return {from, (to - from).normalized()};
}

survey::Survey FlownOver() {
  survey::Survey survey;
  survey.georeferenced = true;
  survey.origin = {46.8427, -91.994, 180.0};
  survey.cameras.push_back({camera::CameraModel::kPinhole, 200, 150, {150.0, 150.0, 100.0, 75.0}});
  for (int row = -2; row <= 2; ++row) {
    for (int column = -2; column <= 2; ++column) {
      survey::Photo photo = NadirPhoto({12.0 * column, 12.0 * row, 40.0}, "p" + std::to_string(survey.photos.size()) + ".jpg");
      photo.agl_m = 40.0;
      survey.photos.push_back(photo);
    }
  }
  // Obliques from the four sides, 40 degrees off nadir.
  for (int side = 0; side < 4; ++side) {
    for (int place = -1; place <= 1; ++place) {
      const double azimuth = side * std::numbers::pi / 2.0;
      survey::Photo photo = NadirPhoto({0, 0, 0}, "q" + std::to_string(survey.photos.size()) + ".jpg");
      const Eigen::Vector3d eye = Eigen::AngleAxisd(azimuth, Eigen::Vector3d::UnitZ()) * Eigen::Vector3d(12.0 * place, -34.0, 40.0);
      // About the camera's x axis, which points east before the turn to the azimuth: looks north and down.
      const Eigen::Quaterniond cam_from_enu = Eigen::AngleAxisd(-40.0 * std::numbers::pi / 180.0, Eigen::Vector3d::UnitX()) *
                                              photo.cam_from_enu.rotation * Eigen::AngleAxisd(-azimuth, Eigen::Vector3d::UnitZ());
      photo.cam_from_enu = {cam_from_enu, -(cam_from_enu * eye)};
      photo.agl_m = 40.0;
      survey.photos.push_back(photo);
    }
  }
  return survey;
}

TEST(TrueRays, HitWhatIsThereWithinTheirStretch) {
  const survey::Survey survey = FlownOver();
  const TrueRays truth(BoxOnGround(), survey, nullptr);
  std::vector<render::Ray> rays = {RayTo({0, 0, 40}, {0, 0, 0}), RayTo({30, 0, 40}, {30, 0, 0}), RayTo({0, 0, 40}, {0, 0, 80}),
                                   RayTo({0, -30, 3}, {0, 0, 3})};
  rays.push_back(rays[0]);
  rays.back().t_far = 20.0;
  rays.push_back(rays[0]);
  rays.back().t_near = 35.0;  // begins below the deck
  std::vector<render::RayColor> seen(rays.size());
  base::ThreadPool threads(2);
  truth.Cast(rays, seen, threads);
  EXPECT_NEAR(seen[0].depth_median, 40.0 - kDeck_m, 1e-4);
  EXPECT_NEAR(seen[1].depth, 40.0, 1e-4);
  EXPECT_EQ(seen[2].opacity, 0.0F);
  EXPECT_TRUE(std::isnan(seen[2].depth_median));
  EXPECT_NEAR(seen[3].depth_front, 30.0 + kSouth_m, 1e-4);
  EXPECT_EQ(seen[3].depth_front, seen[3].depth_back);
  EXPECT_EQ(seen[4].opacity, 0.0F);
  EXPECT_NEAR(seen[5].depth, 40.0, 1e-4);
}

TEST(TrueRays, TakeColoursFromPhotosThatSeeThePlace) {
  const TemporaryFolder folder;
  survey::Survey survey;
  survey.cameras.push_back({camera::CameraModel::kPinhole, 64, 48, {40.0, 40.0, 32.0, 24.0}});
  survey.photos = {NadirPhoto({0, 0, 30}, "red.png"), NadirPhoto({18, 0, 30}, "green.png"), NadirPhoto({0, 0.5, 30}, "held_out.png")};
  survey.photos[2].is_test = true;
  const std::array<std::array<uint8_t, 3>, 3> colors = {{{200, 0, 0}, {0, 200, 0}, {0, 0, 200}}};
  std::vector<image::PixelSource> sources;
  for (size_t i = 0; i < 3; ++i) {
    image::Image8 picture(64, 48, 3);
    for (size_t at = 0; at < picture.data.size(); ++at) picture.data[at] = colors[i][at % 3];
    image::SavePng(picture, folder / survey.photos[i].name);
    sources.push_back({folder / survey.photos[i].name, {}});
  }
  base::ThreadPool threads(1);
  const image::PixelCache pixels = image::PixelCache::Open(folder / "pixels.bin", sources, 0, threads);
  const TrueRays truth(BoxOnGround(), survey, &pixels);
  // The deck below the first photo; the ground beside the east wall, which the first photo's deck hides; nothing that a photo sees.
  const std::vector<render::Ray> rays = {RayTo({0, 0, 50}, {-2, 0, kDeck_m}), RayTo({10, 0, 50}, {kEast_m + 0.5, 0, 0}),
                                         RayTo({55, 50, 50}, {55, 55, 0})};
  std::vector<render::RayColor> seen(rays.size());
  truth.Cast(rays, seen, threads);
  EXPECT_NEAR(seen[0].rgb_srgb[0], 200.0 / 255.0, 1e-6) << "not of the held-out photo, which is as near";
  EXPECT_EQ(seen[0].rgb_srgb[2], 0.0F);
  EXPECT_NEAR(seen[1].rgb_srgb[1], 200.0 / 255.0, 1e-6);
  EXPECT_EQ(seen[1].rgb_srgb[0], 0.0F);
  EXPECT_EQ(seen[2].rgb_srgb[0], seen[2].rgb_srgb[1]) << "grey";
}

// The whole way from true depth to a measured building.
TEST(TrueRays, GiveTheSurfaceAndTheBuildingThatAreThere) {
  const TemporaryFolder folder;
  const survey::Survey survey = FlownOver();
  const TrueRays truth(BoxOnGround(), survey, nullptr);
  base::ThreadPool threads(2);
  scene::SceneInfo info;
  info.origin = survey.origin;
  info.georeferenced = true;
  info.min_enu = {-30, -30, -3};
  info.max_enu = {30, 30, 12};
  info.gsd_m = 40.0 / 150.0;
  surface::SurfaceInput input;
  input.options.glb = input.options.obj = input.options.ply = input.options.tiles = false;
  input.info = &info;
  input.survey = &survey;
  input.caster = [&](std::span<const render::Ray> rays, std::span<render::RayColor> seen) { truth.Cast(rays, seen, threads); };
  input.map_resolution_m = 0.5;
  input.memory_bytes = 1e9;
  input.work_key = "key";
  input.work_folder = folder / "work";
  input.out_folder = folder / "out";
  const surface::SurfaceResult made = surface::MakeSurface(input, threads);
  ASSERT_GT(made.triangles, 0);
  const buildings::PointCloud cloud = buildings::LoadSurfacePoints(input.work_folder, made.voxel_m);
  size_t decks = 0, walls = 0;
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    const Eigen::Vector3d x = cloud.At(i);
    const bool over = x.x() > kWest_m + 1 && x.x() < kEast_m - 1 && x.y() > kSouth_m + 1 && x.y() < kNorth_m - 1;
    if (over && cloud.points[i].filled == 0) {
      EXPECT_NEAR(x.z(), kDeck_m, 0.2 * made.voxel_m) << x.transpose();
      ++decks;
    }
    if (cloud.points[i].filled == 0 && x.z() > 1.5 && x.z() < kDeck_m - 1.5 && std::abs(x.x()) < 6.0 && x.y() < 0.0) {
      EXPECT_NEAR(x.y(), kSouth_m, 0.5 * made.voxel_m) << x.transpose();
      ++walls;
    }
  }
  EXPECT_GT(decks, 100U);
  EXPECT_GT(walls, 20U);

  const surface::MapFrame frame(info);
  const buildings::GroundGrid ground = buildings::GroundGrid::Read(input.out_folder / "dtm.tif", frame);
  buildings::BuildingsInput search;
  search.cloud = &cloud;
  search.ground = &ground;
  search.georeferenced = true;
  search.gsd_m = info.gsd_m;
  const buildings::BuildingSet set = buildings::MakeBuildings(search, threads);
  ASSERT_EQ(set.buildings.size(), 1U);
  const buildings::Measures& measures = set.buildings[0].measures;
  EXPECT_NEAR(measures.height_m.value, kDeck_m, 0.1);
  EXPECT_NEAR(measures.length_m.value, kEast_m - kWest_m, info.gsd_m);
  EXPECT_NEAR(measures.width_m.value, kNorth_m - kSouth_m, info.gsd_m);
}

survey::Survey SurveyOf(const buildings::MadeCloud& made) {
  survey::Survey survey;
  survey.photos = {NadirPhoto({0, 0, 200}, "a.jpg"), NadirPhoto({60, 60, 200}, "b.jpg")};
  for (size_t i = 0; i < made.cloud.points.size(); ++i) {
    const bool kept = i % 10 == 0;
    (kept ? survey.kept_points : survey.points).push_back({made.cloud.At(i), made.cloud.points[i].rgb, 0.5F, 7});
    (kept ? survey.kept_tracks : survey.tracks).Add({0, 1});
  }
  return survey;
}

TEST(SparseCloud, HasTheNormalsColoursAndSpacingOfTheSurface) {
  const buildings::Building house = buildings::MadeHouse({.length_m = 14.0, .width_m = 10.0});
  const buildings::MadeCloud made = buildings::MadeCloudOf({house}, {.spacing_m = 0.6, .wall_share = 0.0, .ground_margin_m = 12.0});
  const survey::Survey survey = SurveyOf(made);
  base::ThreadPool one(1), two(2);
  const buildings::PointCloud cloud = SparseCloud(survey, two);
  ASSERT_EQ(cloud.points.size(), survey.points.size()) << "without those kept from training";
  EXPECT_NEAR(cloud.spacing_m, 0.6, 0.12);
  EXPECT_EQ(cloud.points[0].views, 2) << "from the tracks, not the length in the model";
  // In order, but for those kept.
  size_t at = 0, right = 0, compared = 0;
  for (size_t i = 0; i < made.cloud.points.size(); ++i) {
    if (i % 10 == 0) continue;
    const buildings::SurfacePoint& point = cloud.points[at++];
    EXPECT_LT((cloud.At(at - 1) - made.cloud.At(i)).norm(), 1e-3);
    EXPECT_EQ(point.rgb, made.cloud.points[i].rgb);
    EXPECT_GT(point.normal.z(), 0.0F) << "towards the photos";
    right += point.normal.dot(made.cloud.points[i].normal) > 0.99F ? 1 : 0;
    ++compared;
  }
  EXPECT_GT(static_cast<double>(right), 0.6 * static_cast<double>(compared)) << "all but those near edges";
  const buildings::PointCloud again = SparseCloud(survey, one);
  for (size_t i = 0; i < cloud.points.size(); ++i) EXPECT_EQ(cloud.points[i].normal, again.points[i].normal);
}

TEST(SparseCloud, LeadsToTheGroundAndTheHouse) {
  const buildings::Building house =
      buildings::MadeHouse({.roof = buildings::RoofKind::kFlat, .length_m = 16.0, .width_m = 12.0, .ground_z = 100.0, .eave_z = 106.0});
  const survey::Survey survey = SurveyOf(buildings::MadeCloudOf({house}, {.spacing_m = 0.6, .wall_share = 0.4, .ground_margin_m = 20.0}));
  base::ThreadPool threads(2);
  const buildings::PointCloud cloud = SparseCloud(survey, threads);
  const buildings::GroundGrid ground = SparseGround(cloud, {});
  for (const Eigen::Vector2d& at : house.footprint.outer) EXPECT_NEAR(ground.At(at), 100.0, 0.1);
  EXPECT_NEAR(ground.At(buildings::Centroid(house.footprint)), 100.0, 0.1) << "below the roof too";
  buildings::BuildingsInput input;
  input.cloud = &cloud;
  input.ground = &ground;
  input.georeferenced = true;
  input.gsd_m = SparseGsd(cloud, 0.1);
  const buildings::BuildingSet set = buildings::MakeBuildings(input, threads);
  ASSERT_EQ(set.buildings.size(), 1U);
  EXPECT_NEAR(set.buildings[0].measures.height_m.value, 6.0, 0.3);
}

TEST(SparseCloud, NeedsPoints) {
  base::ThreadPool threads(1);
  EXPECT_THROW(SparseCloud({}, threads), base::InputError);
  survey::Survey few;
  few.points.push_back({Eigen::Vector3d(1, 2, 3), {}, 0.5F, 3});
  const buildings::PointCloud cloud = SparseCloud(few, threads);
  ASSERT_EQ(cloud.points.size(), 1U);
  EXPECT_GT(cloud.spacing_m, 0.0);
  EXPECT_EQ(cloud.points[0].normal, Eigen::Vector3f::UnitZ());
  const buildings::GroundGrid ground = SparseGround(cloud, {});
  EXPECT_NEAR(ground.At(ground.min()), 3.0, 1e-6);
}

}  // namespace
}  // namespace skyquilt::bench
