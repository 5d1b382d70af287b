#include "products/photo_map/photo_orthophoto.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/order_statistics.h"
#include "core/base/random.h"
#include "core/gis/geotiff.h"
#include "products/map_products.h"
#include "products/map_rays.h"
#include "products/photo_map/painted_rows.h"
#include "products/photo_map/photo_light.h"
#include "tests/products/photo_orthophoto_fixture.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::products {
namespace {

using Ground = PatternedSurvey;

RC_GTEST_PROP(PhotoLight, FindsGainsAndTheLossInTheCornersDespiteWhatMoved, (uint32_t seed)) {
  base::Random random(seed);
  const size_t photos = 2 + random.Below(10);
  const double a = random.Uniform(0.0, 0.5), b = random.Uniform(0.0, 0.3);
  std::vector<int> camera(photos, 0);
  std::vector<std::array<float, 3>> gain(photos);
  std::vector<LightSample> samples;
  for (size_t i = 0; i < photos; ++i) {
    for (float& value : gain[i]) value = static_cast<float>(random.Uniform(-0.7, 0.7));
    for (int n = 0; n < 300; ++n) {
      const double radius2 = random.Uniform(0.0, 1.0), moved = n % 10 == 0 ? random.Uniform(-2.0, 2.0) : random.Uniform(-0.02, 0.02);
      LightSample sample{static_cast<int32_t>(i), static_cast<float>(radius2), {}};
      for (size_t k = 0; k < 3; ++k) sample.log_ratio[k] = gain[i][k] + static_cast<float>(a * radius2 + b * radius2 * radius2 + moved);
      if (n % 7 == 0) sample.log_ratio[0] = std::numeric_limits<float>::quiet_NaN();
      samples.push_back(sample);
    }
  }
  const PhotoLight light = FitLight(samples, camera, 1);
  for (size_t i = 0; i < photos; ++i) {
    for (const double radius2 : {0.05, 0.4, 0.9}) {
      const std::array<float, 3> factors = light.At(i, 0, static_cast<float>(radius2));
      for (size_t k = 0; k < 3; ++k) {
        RC_ASSERT(std::abs(std::log(static_cast<double>(factors[k])) - static_cast<double>(gain[i][k]) - a * radius2 - b * radius2 * radius2) < 0.03);
      }
    }
  }
}

TEST(PhotoLight, WithoutSamplesChangesNothingAndAPhotoWithoutTakesTheMiddle) {
  const std::vector<int> camera(3, 0);
  EXPECT_EQ(FitLight({}, camera, 1).At(2, 0, 0.5F), (std::array<float, 3>{1.0F, 1.0F, 1.0F}));
  std::vector<LightSample> samples;
  for (int n = 0; n < 20; ++n) samples.push_back({n % 2, 0.5F, {0.1F, 0.2F, 0.3F}});
  EXPECT_NEAR(FitLight(samples, camera, 1).At(2, 0, 0.0F)[2], std::exp(0.3F), 1e-5F);
}

// The photos differ by a whole stop, and 5 m of house hide up to a metre and a half of ground from each of them.
TEST_F(PhotoOrthophotoTest, ShowsTrueColoursAtTheirPlacesBesideAHouseToo) {
  const survey::Survey survey = Ground::Write(folder_.path(), 0.5, false);
  const MapProducts made = Make(survey);
  ASSERT_TRUE(made.painted);
  EXPECT_EQ(made.grid.resolution_m, 0.2);
  EXPECT_EQ(made.painted->photos, 12);
  EXPECT_EQ(made.painted->unreadable, 0);
  const std::vector<double> errors = Errors(made.grid);
  EXPECT_LT(base::Quantile(errors, 0.5), 2.0);
  EXPECT_LT(base::Quantile(errors, 0.999), 10.0);
}

TEST_F(PhotoOrthophotoTest, SaysWhereEachCellComesFrom) {
  survey::Survey survey = Ground::Write(folder_.path(), 0.5, false);
  survey.photos[5].is_test = true;
  const MapProducts made = Make(survey);
  ASSERT_TRUE(made.painted);
  const image::ImageF sources = gis::ReadReduced(folder_ / "products/ortho_sources.tif", 1 << 20).image;
  ASSERT_EQ(sources.data.size(), made.grid.size());
  std::map<int, int64_t> counts;
  for (size_t i = 0; i < sources.data.size(); ++i) {
    const float value = std::isfinite(sources.data[i]) ? sources.data[i] : 0.0F;
    ++counts[static_cast<int>(value)];
    EXPECT_EQ(value > 0.0F, map_.data[4 * i + 3] > 0.0F);
  }
  const nlohmann::ordered_json json = Sources();
  EXPECT_EQ(json["photos"].size(), 11U);
  EXPECT_FALSE(json["photos"].contains(survey.photos[5].name));
  for (const auto& [name, photo] : json["photos"].items()) EXPECT_EQ(counts[photo["value"].get<int>()], photo["cells"].get<int64_t>()) << name;
  EXPECT_EQ(counts[1], json["field_cells"].get<int64_t>());
  EXPECT_EQ(made.painted->cells, json["cells"].get<int64_t>());
  EXPECT_TRUE(std::filesystem::exists(folder_ / "products/cutline.gpkg"));
}

// The photos are laid on a finer surface, but maps of heights share their cells, and at most have those of the surface.
TEST_F(PhotoOrthophotoTest, TheSurfaceModelHasTheCellsOfTheOtherHeightsAndNoHeightBetweenRoofAndGround) {
  const survey::Survey survey = Ground::Write(folder_.path(), 0.5, false);
  for (const auto& [stated_m, expected_m] : {std::pair{0.0, 0.5}, std::pair{0.1, 0.25}, std::pair{0.7, 0.7}}) {
    ProductOptions options;
    options.resolution_m = stated_m;
    const MapProducts made = Make(survey, options);
    ASSERT_TRUE(made.painted);
    const gis::MapGrid planned = PlanHeightGrid(Info(), options);
    const gis::ReducedRaster dsm = gis::ReadReduced(folder_ / "products/dsm.tif", 1 << 20);
    EXPECT_EQ(planned.resolution_m, expected_m);
    ASSERT_EQ(dsm.image.width, planned.width) << stated_m;
    ASSERT_EQ(dsm.image.height, planned.height);
    int64_t without = 0;
    for (int y = 0; y < planned.height; ++y) {
      for (int x = 0; x < planned.width; ++x) {
        const double height_m = static_cast<double>(*dsm.image.At(x, y));
        const Eigen::Vector2d place = planned.CellCentre(x, y);
        if (!std::isfinite(height_m)) {
          ++without;
          continue;
        }
        const bool roof = std::abs(height_m - Ground::kRoof_m) < 1e-3;
        EXPECT_TRUE(roof || std::abs(height_m - Ground::kGround_m) < 1e-3) << height_m;
        const bool edge =
            Ground::InHouse(place.x(), place.y(), planned.resolution_m) && !Ground::InHouse(place.x(), place.y(), -planned.resolution_m);
        EXPECT_TRUE(edge || roof == Ground::InHouse(place.x(), place.y())) << place.transpose();
      }
    }
    // The border follows nodes of 8 x 8 cells, so large cells lose a wider rim.
    EXPECT_LT(static_cast<double>(without), (stated_m > 0.5 ? 0.3 : 0.05) * static_cast<double>(planned.size())) << stated_m;
  }
}

TEST_F(PhotoOrthophotoTest, HolesOfTheSceneHaveWhatThePhotosShow) {
  const survey::Survey survey = Ground::Write(folder_.path(), 0.5, false);
  caster_ = [](std::span<const render::Ray> rays, std::span<render::RayColor> out) {
    Field(rays, out);
    for (size_t i = 0; i < rays.size(); ++i) {
      if ((rays[i].origin_enu.head<2>() - Eigen::Vector2d(-9.0, 6.0)).norm() < 2.0) out[i].opacity = 0.0F;
    }
  };
  const MapProducts made = Make(survey);
  ASSERT_TRUE(made.painted);
  EXPECT_LT(base::Quantile(Errors(made.grid), 0.999), 10.0);
}

TEST_F(PhotoOrthophotoTest, DoesNotShowWhatMoved) {
  const survey::Survey survey = Ground::Write(folder_.path(), 0.5, false);
  const MapProducts before = Make(survey);
  // A red lorry in each of two photos, at places that they showed.
  for (const size_t photo : {4U, 6U}) {
    image::Image8 picture = image::LoadRgb8(folder_ / survey.photos[photo].name);
    for (int y = 80; y < 96; ++y) {
      for (int x = 110; x < 140; ++x) {
        picture.At(x, y)[0] = 250;
        picture.At(x, y)[1] = picture.At(x, y)[2] = 10;
      }
    }
    image::SavePng(picture, folder_ / survey.photos[photo].name);
  }
  const MapProducts made = Make(survey);
  ASSERT_TRUE(made.painted);
  EXPECT_LT(base::Quantile(Errors(made.grid), 0.9995), 12.0);
}

TEST_F(PhotoOrthophotoTest, CellsThatNoPhotoSeesComeFromTheField) {
  survey::Survey survey = Ground::Write(folder_.path(), 0.5, false);
  // Nobody looks at the roof.
  for (survey::Photo& photo : survey.photos) {
    const camera::Camera& camera = survey.cameras[0];
    image::Image8 mask(camera.width, camera.height, 1, 255);
    const Eigen::Vector3d eye = photo.cam_from_enu.OriginInSource();
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const Eigen::Vector3d ray = photo.cam_from_enu.rotation.conjugate() * camera.RayFromImg({x + 0.5, y + 0.5});
        const Eigen::Vector3d place = eye + (Ground::kRoof_m - eye.z()) / ray.z() * ray;
        if (Ground::InHouse(place.x(), place.y())) *mask.At(x, y) = 0;
      }
    }
    photo.mask = (folder_ / (photo.name + ".mask.png")).string();
    image::SavePng(mask, photo.mask);
  }
  const MapProducts made = Make(survey);
  ASSERT_TRUE(made.painted);
  const double house = std::pow(2.0 * Ground::kHouse / made.grid.resolution_m, 2.0);
  EXPECT_GT(static_cast<double>(made.painted->field_cells), 0.7 * house);
  EXPECT_LT(base::Quantile(Errors(made.grid), 0.999), 12.0);
}

TEST_F(PhotoOrthophotoTest, PhotosThatAreGoneOrReplacedAreLeftOutAndAllOfThemGiveTheFieldsMap) {
  const survey::Survey survey = Ground::Write(folder_.path(), 0.5, false);
  std::filesystem::remove(folder_ / survey.photos[2].name);
  image::SavePng(image::Image8(17, 11, 3, 99), folder_ / survey.photos[7].name);
  testing::internal::CaptureStdout();
  const MapProducts made = Make(survey);
  const std::string log = testing::internal::GetCapturedStdout();
  ASSERT_TRUE(made.painted);
  EXPECT_EQ(made.painted->unreadable, 2);
  EXPECT_NE(log.find("does without 2 of 12 photos"), std::string::npos) << log;
  EXPECT_NE(log.find("the photo has 17 x 11 pixels, and had 240 x 180"), std::string::npos) << log;
  EXPECT_LT(base::Quantile(Errors(made.grid), 0.999), 12.0);
  for (const survey::Photo& photo : survey.photos) std::filesystem::remove(folder_ / photo.name);
  testing::internal::CaptureStdout();
  const MapProducts from_field = Make(survey);
  EXPECT_NE(testing::internal::GetCapturedStdout().find("no photo can be read"), std::string::npos);
  EXPECT_FALSE(from_field.painted);
  EXPECT_EQ(from_field.grid.resolution_m, 0.25);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "products/ortho_sources.tif"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "products/cutline.gpkg"));
}

TEST_F(PhotoOrthophotoTest, ThreadsAndMemoryDoNotMatter) {
  const survey::Survey survey = Ground::Write(folder_.path(), 0.5, false);
  Make(survey);
  std::map<std::string, std::string> first;
  const std::vector<std::string> names = {"orthophoto.tif", "ortho_sources.tif", "ortho_sources.json", "cutline.gpkg", "dsm.tif"};
  for (const std::string& name : names) first[name] = base::ReadFile(folder_ / "products" / name);
  Make(survey, {}, 3, 1);
  for (const std::string& name : names) EXPECT_EQ(base::ReadFile(folder_ / "products" / name), first[name]) << name;
}

// A folder in the place of the last file stops the work when everything is painted.
TEST_F(PhotoOrthophotoTest, PartsThatArePaintedAreNotPaintedAgain) {
  const survey::Survey survey = Ground::Write(folder_.path(), 0.0, false);
  ProductOptions options;
  options.resolution_m = 0.042;
  const std::filesystem::path parts = folder_ / "products/orthophoto.parts";
  const std::filesystem::path in_the_way = folder_ / "products/cutline.gpkg";
  std::filesystem::create_directories(in_the_way / "full");
  EXPECT_THROW(Make(survey, options), std::exception);
  ASSERT_TRUE(std::filesystem::exists(parts / "rows_0.bin"));
  ASSERT_TRUE(std::filesystem::exists(parts / "rows_1024.bin"));
  std::filesystem::remove_all(in_the_way);
  // The second part is damaged, and the first is painted over, in a place that has nothing to do with the photos' colours.
  base::WriteFileAtomically(parts / "rows_1024.bin", base::ReadFile(parts / "rows_1024.bin").substr(0, 1000));
  const PaintedRows painted(parts, base::ReadFile(parts / "key.txt").substr(0, 16));
  PhotoMapRows rows;
  const gis::MapGrid planned = PlanMapGrid(Info(), options);
  ASSERT_TRUE(painted.Read(0, planned.Index(0, PhotoMap::kRows), &rows));
  const size_t marked = planned.Index(planned.width / 2, PhotoMap::kRows / 2);
  rows.rgba[4 * marked] = 3;
  rows.rgba[4 * marked + 1] = rows.rgba[4 * marked + 2] = 251;
  painted.Write(0, rows);
  testing::internal::CaptureStdout();
  const MapProducts made = Make(survey, options);
  const std::string log = testing::internal::GetCapturedStdout();
  EXPECT_NE(log.find("2 of 2 parts"), std::string::npos) << log;
  EXPECT_EQ(map_.At(planned.width / 2, PhotoMap::kRows / 2)[0], 3.0F);
  EXPECT_LT(base::Quantile(Errors(made.grid), 0.999), 12.0);
  EXPECT_FALSE(std::filesystem::exists(parts));
}

TEST_F(PhotoOrthophotoTest, PartsOfOtherPhotosArePaintedAgain) {
  survey::Survey survey = Ground::Write(folder_.path(), 0.0, false);
  const auto key = [&] {
    const gis::MapGrid grid = PlanMapGrid(Info(), {});
    const gis::MapProjection projection(Info().origin, grid);
    const HeightGrid surface(grid, std::vector<float>(grid.size(), 1.0F));
    const std::vector<char> usable(survey.photos.size(), 1);
    return PaintKey(
        {.survey = survey, .usable = usable, .grid = grid, .projection = projection, .surface = surface, .slack_m = {}, .field_rgba = {}});
  };
  const std::string first = key();
  EXPECT_EQ(key(), first);
  std::set<std::string> keys = {first};
  image::SavePng(image::Image8(20, 20, 3, 7), folder_ / survey.photos[3].name);
  keys.insert(key());
  survey.photos[2].cam_from_enu.translation.x() += 1e-9;
  keys.insert(key());
  survey.cameras[0].params[0] += 1e-9;
  keys.insert(key());
  EXPECT_EQ(keys.size(), 4U);
  const PaintedRows before(folder_ / "parts", first);
  before.Write(0, {std::vector<uint8_t>(8, 1), std::vector<uint16_t>(2, 1)});
  EXPECT_EQ(PaintedRows(folder_ / "parts", first).Count(), 1);
  PhotoMapRows rows;
  EXPECT_FALSE(before.Read(0, 3, &rows));
  EXPECT_TRUE(before.Read(0, 2, &rows));
  EXPECT_EQ(PaintedRows(folder_ / "parts", *keys.rbegin() == first ? *keys.begin() : *keys.rbegin()).Count(), 0);
}

TEST_F(PhotoOrthophotoTest, TheBorderIsCutWhereTwoPhotosSeeTheGroundAndMoreOnRequest) {
  const survey::Survey survey = Ground::Write(folder_.path(), 0.0, false);
  const auto covered = [&] {
    int64_t cells = 0;
    for (size_t i = 3; i < map_.data.size(); i += 4) cells += map_.data[i] > 0.0F ? 1 : 0;
    return static_cast<double>(cells);
  };
  ProductOptions options;
  const MapProducts made = Make(survey, options);
  const double whole = covered() * made.grid.resolution_m * made.grid.resolution_m;
  options.crop_m = 4.0;
  Make(survey, options);
  const double cropped = covered() * made.grid.resolution_m * made.grid.resolution_m;
  // A rectangle of about 56 m x 44 m loses a rim of 4 m.
  EXPECT_NEAR(whole - cropped, 4.0 * 2.0 * (56.0 + 44.0) - 64.0, 0.25 * 736.0);
  options.crop_m = 100.0;
  testing::internal::CaptureStdout();
  EXPECT_FALSE(Make(survey, options).painted);
  EXPECT_NE(testing::internal::GetCapturedStdout().find("products.crop_m"), std::string::npos);
}

TEST_F(PhotoOrthophotoTest, CanBeInterruptedAndLeavesNothingHalf) {
  const survey::Survey survey = Ground::Write(folder_.path(), 0.0, false);
  ExpectStopsWhenAsked([&] { Make(survey); });
  EXPECT_FALSE(std::filesystem::exists(folder_ / "products/orthophoto.tif"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "products/ortho_sources.tif"));
}

}  // namespace
}  // namespace skyquilt::products
