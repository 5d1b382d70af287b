#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/random.h"
#include "core/geo/enu_frame.h"
#include "core/gis/geotiff.h"
#include "core/scene/point_heights.h"
#include "core/survey/seen_ground.h"
#include "products/field_preview.h"
#include "products/map_products.h"
#include "products/photo_map/overlap_gains.h"
#include "products/photo_map/photo_choice.h"
#include "tests/products/analytic_scene.h"
#include "tests/products/patterned_survey.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::products {
namespace {

RC_GTEST_PROP(OverlapGains, UndoTheExposuresOfAChainOfPhotos, (uint32_t seed)) {
  base::Random random(seed);
  const size_t n = 2 + random.Below(30);
  std::vector<double> log_exposure(n);
  for (double& value : log_exposure) value = random.Uniform(-0.5, 0.5);
  std::vector<OverlapRatio> ratios;
  for (size_t i = 0; i + 1 < n; ++i) {
    for (int k = 0; k < 9; ++k) {
      // Two places of nine moved between the photos, or were wet.
      const double wrong = k < 2 ? random.Uniform(0.5, 2.0) : 0.0;
      OverlapRatio ratio{static_cast<int32_t>(i), static_cast<int32_t>(i + 1), {}};
      const auto value = static_cast<float>(log_exposure[i] - log_exposure[i + 1]);
      ratio.log_ratio = {value + (k < 2 ? static_cast<float>(k == 0 ? wrong : -wrong) : 0.0F), std::numeric_limits<float>::quiet_NaN(), 0.0F};
      if (k % 2 == 0) ratio = {ratio.second, ratio.first, {-ratio.log_ratio[0], ratio.log_ratio[1], 0.0F}};
      ratios.push_back(ratio);
    }
  }
  const std::vector<std::array<float, 3>> gains = GainsOfOverlaps(n, ratios);
  for (size_t i = 0; i + 1 < n; ++i) {
    // The small weight of a gain of 0 leaves a little of the differences.
    const double left = static_cast<double>(gains[i][0] - gains[i + 1][0]) + log_exposure[i] - log_exposure[i + 1];
    RC_ASSERT(std::abs(left) < 0.06);
    RC_ASSERT(gains[i][1] == 0.0F && gains[i][2] == 0.0F);
  }
  double sum = 0.0;
  for (const auto& gain : gains) sum += static_cast<double>(gain[0]);
  RC_ASSERT(std::abs(sum) < 1e-3);
}

TEST(OverlapGains, NothingToCompareChangesNothing) {
  EXPECT_TRUE(GainsOfOverlaps(0, {}).empty());
  const std::vector<std::array<float, 3>> gains = GainsOfOverlaps(3, {{1, 1, {1.0F, 1.0F, 1.0F}}});
  for (const auto& gain : gains) EXPECT_EQ(gain, (std::array<float, 3>{0.0F, 0.0F, 0.0F}));
}

TEST(SparseSurface, SingleWrongPointsDoNotCountAndGapsAreFilled) {
  survey::Survey survey;
  survey.points = PatternedSurvey::Points(4000);
  // No points in a corner.
  std::erase_if(survey.points, [](const survey::SparsePoint& point) { return point.x_in_enu.x() > 15.0 && point.x_in_enu.y() > 10.0; });
  survey.points.push_back({.x_in_enu = {0.0, 0.0, std::nan("")}});
  Eigen::AlignedBox2d area(Eigen::Vector2d(-30.0, -25.0), Eigen::Vector2d(30.0, 25.0));
  const scene::HeightMap heights = scene::HeightsOfPoints(survey::SteadyPoints(survey), area);
  for (double x = -29.0; x < 30.0; x += 1.3) {
    for (double y = -24.0; y < 25.0; y += 1.3) {
      if (PatternedSurvey::InHouse(x, y, 4.0) && !PatternedSurvey::InHouse(x, y, -3.0)) continue;
      const bool in_gap = x > 12.0 && y > 7.0;  // filled from a wide surrounding, which has a house in it
      EXPECT_NEAR(heights.At(x, y), PatternedSurvey::SurfaceZ(x, y), in_gap ? 1.5 : 1e-9) << x << " " << y;
    }
  }
}

TEST(SparseSurface, TheAreaIsWherePhotosAndPointsAre) {
  survey::Survey survey;
  camera::Camera camera;
  camera.width = camera.height = 100;
  camera.params = {50.0, 50.0, 50.0, 50.0};  // 45 degrees to each side
  survey.cameras = {camera};
  survey.photos = {NadirPhoto({0.0, 0.0, 110.0}, "a"), NadirPhoto({50.0, 0.0, 110.0}, "b"), NadirPhoto({500.0, 0.0, -5.0}, "below")};
  const Eigen::AlignedBox2d seen = survey::SeenGround(survey, {{0.0, 0.0, 10.0}}, 10.0);
  EXPECT_LT((seen.min() - Eigen::Vector2d(-100.0, -100.0)).norm() + (seen.max() - Eigen::Vector2d(150.0, 100.0)).norm(), 1e-6);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i <= 100; ++i) points.emplace_back(-20.0 + i, -300.0 + 6.0 * i, 10.0);
  const Eigen::AlignedBox2d both = survey::SeenGround(survey, points, 10.0);
  EXPECT_NEAR(both.min().x(), -20.0, 5.0);
  EXPECT_NEAR(both.max().x(), 80.0, 5.0);
  EXPECT_NEAR(both.min().y(), -100.0, 1e-6);
  EXPECT_NEAR(both.max().y(), 100.0, 1e-6);
  // A camera that looks at the horizon sees ground only as far as it may count.
  survey.photos.resize(1);
  survey.photos[0].cam_from_enu.rotation =
      Eigen::Quaterniond(Eigen::AngleAxisd(-0.5 * 3.14159265358979, Eigen::Vector3d::UnitX())) * survey.photos[0].cam_from_enu.rotation;
  survey.photos[0].cam_from_enu.translation = -(survey.photos[0].cam_from_enu.rotation * Eigen::Vector3d(0.0, 0.0, 110.0));
  const Eigen::AlignedBox2d horizon = survey::SeenGround(survey, {{0.0, 0.0, 10.0}}, 10.0);
  ASSERT_FALSE(horizon.isEmpty());
  EXPECT_LE(horizon.sizes().maxCoeff(), 2.0 * 100.0 * std::sqrt(3.0) + 1e-6);
}

// Eleven photos in a row, 10 m apart, 50 m above the ground.
survey::Survey Row() {
  survey::Survey survey;
  camera::Camera camera;
  camera.width = 200;
  camera.height = 100;
  camera.params = {100.0, 100.0, 100.0, 50.0};
  survey.cameras = {camera};
  for (int i = 0; i < 11; ++i) survey.photos.push_back(NadirPhoto({10.0 * i, 0.0, 50.0}, "p" + std::to_string(i)));
  return survey;
}

TEST(ViewChoice, FewPhotosAreSpreadEvenly) {
  const survey::Survey survey = Row();
  std::vector<Eigen::Vector3d> places;
  for (int x = 0; x <= 100; x += 2) places.emplace_back(x, 0.0, 0.0);
  base::ThreadPool threads(2);
  const double photo = 200.0 * 100.0;
  EXPECT_EQ(ChooseFewPhotos(survey, places, 11.0 * photo, 50.0, threads), std::vector<char>(11, 1));
  const std::vector<char> chosen = ChooseFewPhotos(survey, places, 4.5 * photo, 50.0, threads);
  EXPECT_EQ(std::count(chosen.begin(), chosen.end(), 1), 4);
  // Every place is seen: a photo shows 50 m to each side.
  for (const Eigen::Vector3d& place : places) {
    double nearest = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < chosen.size(); ++i) {
      if (chosen[i] != 0) nearest = std::min(nearest, std::abs(10.0 * static_cast<double>(i) - place.x()));
    }
    EXPECT_LE(nearest, 50.0);
  }
  const std::vector<char> one = ChooseFewPhotos(survey, places, 0.1 * photo, 50.0, threads);
  EXPECT_EQ(std::count(one.begin(), one.end(), 1), 1);
}

TEST(PreviewGrid, KeepsItsLimitsEverywhere) {
  for (const geo::Geodetic& origin : {geo::Geodetic{47.0, 5.9, 400.0}, geo::Geodetic{89.9999, 10.0, 0.0}, geo::Geodetic{-17.0, 179.99999, 10.0}}) {
    for (const double cells : {16.0, 500.0, 1e5}) {
      const scene::SceneInfo info = AnalyticScene().Info(origin, true);
      const gis::MapGrid grid = PlanPreviewGrid(info, 0.46, cells);
      EXPECT_GE(grid.resolution_m, 0.46);
      EXPECT_LE(static_cast<double>(grid.width) * grid.height, cells);
    }
  }
}

TEST(FieldPreview, ShowsTheFieldAndMakesWayForTheOrthophoto) {
  const TemporaryFolder folder;
  AnalyticScene scene;
  scene.open_west = -30.0;
  const scene::SceneInfo info = scene.Info({41.38, 2.17, 50.0}, true);
  const FieldPreview preview = MakeFieldPreview(info, scene.Caster(), 10.0, {}, folder.path());
  EXPECT_NEAR(preview.filled, 0.75, 0.03);
  EXPECT_FALSE(FindPreview(folder.path(), kFromSparsePoints));
  const std::optional<FoundPreview> found = FindPreview(folder.path(), kFromContext);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->made_from, kFromContext);
  EXPECT_EQ(found->picture, preview.picture);
  const image::ImageF map = gis::ReadReduced(folder / "preview_context.tif", 1 << 20).image;
  const auto at = [&](double x, double y) {
    const geo::EnuFrame frame(info.origin);
    const Eigen::Vector2d cell =
        preview.grid.CellOf(geo::UtmFromGeodetic(frame.GeodeticFromEnu({x, y, scene.ground_z}), preview.grid.zone)).array().round().matrix();
    const float* rgba = map.At(static_cast<int>(cell.x()), static_cast<int>(cell.y()));
    return std::array<float, 4>{rgba[0], rgba[1], rgba[2], rgba[3]};
  };
  EXPECT_EQ(at(-20.0, 30.0), (std::array<float, 4>{0.0F, 255.0F, 0.0F, 255.0F}));
  EXPECT_EQ(at(50.0, 30.0), (std::array<float, 4>{255.0F, 0.0F, 0.0F, 255.0F}));
  EXPECT_EQ(at(25.0, 0.0), (std::array<float, 4>{0.0F, 0.0F, 255.0F, 255.0F}));
  EXPECT_EQ(at(-50.0, 0.0)[3], 0.0F);

  // A surface model alone leaves it; the orthophoto replaces it.
  ProductOptions options;
  options.ortho = false;
  MakeMapProducts(info, scene.Caster(), options, folder.path());
  WritePreview(info, PreviewMap{preview.grid, std::vector<uint8_t>(4 * preview.grid.size())}, kFromSparsePoints, folder.path(), 100);
  ASSERT_EQ(FindPreviews(folder.path()).size(), 2U);
  EXPECT_EQ(FindPreviews(folder.path())[0].made_from, kFromSparsePoints);
  EXPECT_FALSE(HasOrthophoto(folder.path()));
  options.ortho = true;
  MakeMapProducts(info, scene.Caster(), options, folder.path());
  EXPECT_TRUE(HasOrthophoto(folder.path()));
  EXPECT_TRUE(FindPreviews(folder.path()).empty());
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    EXPECT_FALSE(entry.path().filename().string().starts_with("preview_")) << entry.path();
  }
}

TEST(FindPreview, DamagedFilesAreNone) {
  const TemporaryFolder folder;
  const AnalyticScene scene;
  EXPECT_FALSE(FindPreview(folder.path(), kFromContext));
  MakeFieldPreview(scene.Info({}, false), scene.Caster(), 1.0, {}, folder.path());
  EXPECT_TRUE(FindPreview(folder.path(), kFromContext));
  base::WriteFileAtomically(folder / "preview_context.json", "{\"preview\": 3}");
  EXPECT_FALSE(FindPreview(folder.path(), kFromContext));
  RemovePreviews(folder.path());
  RemovePreviews(folder.path());
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace skyquilt::products
