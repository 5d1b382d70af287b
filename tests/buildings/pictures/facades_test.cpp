#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <string>

#include "buildings/pictures/building_pictures.h"
#include "buildings/pictures/wall_sides.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/geo/ray_box.h"
#include "tests/buildings/sample_buildings.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::buildings {
namespace {

using nlohmann::json;

HousePlan Flat(double yaw = 0.0) {
  HousePlan plan;
  plan.roof = RoofKind::kFlat;
  plan.yaw_rad = yaw;
  return plan;
}

HousePlan Large() {
  HousePlan plan = Flat();
  plan.length_m = 16.0;
  plan.width_m = 14.0;
  return plan;
}

// The house of a plan as an opaque box. Its south wall (v = 0) is grey with a red window at u 2 .. 4, z 101 .. 103; its other walls are blue.
struct PaintedHouse {
  HousePlan plan;
  double depth_m = 0.0;  // the painted wall is this far behind the model's
  double opacity = 1.0;
  std::vector<render::Ray> seen = {};

  surface::RayCaster Caster() {
    return [this](std::span<const render::Ray> rays, std::span<render::RayColor> out) {
      for (size_t i = 0; i < rays.size(); ++i) {
        seen.push_back(rays[i]);
        out[i] = {};
        out[i].depth = out[i].depth_median = std::numeric_limits<float>::quiet_NaN();
        const Eigen::Rotation2Dd turn(-plan.yaw_rad);
        Eigen::Vector3d origin = rays[i].origin_enu, direction = rays[i].direction_enu;
        origin.head<2>() = turn * (origin.head<2>() - plan.origin);
        direction.head<2>() = turn * direction.head<2>();
        const Eigen::Vector3d low(depth_m, depth_m, plan.ground_z), high(plan.length_m - depth_m, plan.width_m - depth_m, plan.eave_z);
        const geo::Interval hit = geo::RayBox(origin, direction, low, high);
        if (hit.Empty() || hit.t_near > rays[i].t_far) continue;
        const Eigen::Vector3d x = origin + hit.t_near * direction;
        const bool south = std::abs(x.y() - depth_m) < 1e-6, window = south && x.x() > 2 && x.x() < 4 && x.z() > 101 && x.z() < 103;
        const float rgb[3] = {window ? 1.0F : south ? 0.5F : 0.0F, window ? 0.0F : south ? 0.5F : 0.0F, window ? 0.0F : south ? 0.5F : 1.0F};
        for (size_t c = 0; c < 3; ++c) out[i].rgb_srgb[c] = static_cast<float>(opacity) * rgb[c];
        out[i].opacity = static_cast<float>(opacity);
        out[i].depth = out[i].depth_median = static_cast<float>(hit.t_near);
      }
    };
  }
};

struct Result {
  TemporaryFolder folder;
  std::vector<std::filesystem::path> files;
  json description;

  Result(const Building& building, const surface::RayCaster& caster, const surface::MapFrame& frame = surface::MapFrame(scene::SceneInfo{}),
         double pixel_m = 0.1, const BuildingSet& set = {}) {
    base::ThreadPool threads(2);
    files = WriteFacades(building, caster, FileFrame(set, frame), pixel_m, folder.path() / "facades", threads);
    description = base::ParseJson(base::ReadFile(folder.path() / "facades" / ("facade_" + std::to_string(building.id) + ".json")));
  }
  // The facade that looks into this direction.
  const json& Facing(double azimuth_deg) const {
    for (const json& facade : description["facades"])
      if (std::abs(std::remainder(facade["azimuth_deg"].get<double>() - azimuth_deg, 360.0)) < 1.0) return facade;
    throw std::runtime_error("no facade of azimuth " + std::to_string(azimuth_deg));
  }
  cv::Mat Picture(const json& facade) const { return cv::imread((folder.path() / "facades" / facade["file"]).string(), cv::IMREAD_UNCHANGED); }
};

TEST(WriteFacades, ThePatternIsAtItsMetres) {
  for (const double yaw : {0.0, 0.7}) {
    PaintedHouse house{.plan = Flat(yaw)};
    const Result result(MadeHouse(house.plan, 7), house.Caster());
    const json& south = result.Facing(180.0 - yaw * 180.0 / std::numbers::pi);
    const cv::Mat picture = result.Picture(south);
    ASSERT_EQ(picture.channels(), 4);
    ASSERT_EQ(picture.cols, 120);
    ASSERT_EQ(picture.rows, 50);
    for (int row = 0; row < picture.rows; ++row) {
      for (int column = 0; column < picture.cols; ++column) {
        // u to the right from the west end, z down from 105; BGRA.
        const bool window = column >= 20 && column < 40 && row >= 20 && row < 40;
        const cv::Vec4b expected = window ? cv::Vec4b(0, 0, 255, 255) : cv::Vec4b(128, 128, 128, 255);
        ASSERT_EQ(picture.at<cv::Vec4b>(row, column), expected) << row << " " << column;
      }
    }
    EXPECT_EQ(result.Picture(result.Facing(-yaw * 180.0 / std::numbers::pi)).at<cv::Vec4b>(25, 60), cv::Vec4b(255, 0, 0, 255));
  }
}

TEST(WriteFacades, FilesAndDescriptionsAreComplete) {
  PaintedHouse house{.plan = Flat()};
  const Result result(MadeHouse(house.plan, 3), house.Caster());
  std::set<std::string> names;
  for (const auto& file : result.files) {
    EXPECT_TRUE(std::filesystem::exists(file)) << file;
    names.insert(file.filename().string());
  }
  EXPECT_EQ(names, (std::set<std::string>{"facade_3_1.png", "facade_3_2.png", "facade_3_3.png", "facade_3_4.png", "facade_3.json"}));
  size_t on_disk = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(result.folder / "facades")) ++on_disk;
  EXPECT_EQ(on_disk, names.size());  // no temporary files are left
  EXPECT_EQ(result.description["building"], 3);
  ASSERT_EQ(result.description["facades"].size(), 4U);
  std::set<int> azimuths;
  for (const json& facade : result.description["facades"]) {
    azimuths.insert(static_cast<int>(std::lround(facade["azimuth_deg"].get<double>())));
    EXPECT_DOUBLE_EQ(facade["pixel_m"].get<double>(), 0.1);
    EXPECT_NEAR(facade["wall_height_m"].get<double>(), 5.0, 1e-9);
    EXPECT_DOUBLE_EQ(facade["shown"].get<double>(), 1.0);
    EXPECT_EQ(result.Picture(facade).cols, facade["width_px"].get<int>());
    EXPECT_EQ(result.Picture(facade).rows, facade["height_px"].get<int>());
  }
  EXPECT_EQ(azimuths, (std::set<int>{0, 90, 180, 270}));
  const json& south = result.Facing(180.0);
  EXPECT_NEAR(south["wall_width_m"].get<double>(), 12.0, 1e-9);
  const std::vector<double> expected[4] = {{20, 30, 105}, {32, 30, 105}, {32, 30, 100}, {20, 30, 100}};
  const char* const corners[4] = {"top_left", "top_right", "bottom_right", "bottom_left"};
  for (int i = 0; i < 4; ++i)
    for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(south[corners[i]][k].get<double>(), expected[i][k], 1e-9) << corners[i];
}

TEST(WriteFacades, MapCoordinatesAndGridNorth) {
  scene::SceneInfo info;
  info.georeferenced = true;
  info.origin = {47.38, 8.54, 450.0};
  info.min_enu = {0.0, 0.0, 0.0};
  info.max_enu = {100.0, 100.0, 120.0};
  const surface::MapFrame frame(info);
  PaintedHouse house{.plan = Flat()};
  const Result result(MadeHouse(house.plan), house.Caster(), frame);
  EXPECT_EQ(result.description["crs"], "EPSG:32632");
  const json& south = result.Facing(180.0);
  // Meridians of the zone of 9 degrees east turn by (longitude - 9) sin(latitude).
  const double convergence_deg = (8.54 - 9.0) * std::sin(47.38 * std::numbers::pi / 180.0);
  EXPECT_NEAR(south["azimuth_deg"].get<double>(), 180.0 - convergence_deg, 0.005);
  const Eigen::Vector3d corner = frame.MapFromEnu({20.0, 30.0, 105.0});
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(south["top_left"][static_cast<size_t>(k)].get<double>(), corner[k], 1e-4);
}

TEST(WriteFacades, LengthsAreThoseOfTheScaleBarAndHaveNoUnitWithoutScale) {
  PaintedHouse house{.plan = Flat()};
  BuildingSet scaled, unknown;
  scaled.scale = 2.0;
  unknown.metric = false;
  const surface::MapFrame frame{scene::SceneInfo{}};
  const json metres = Result(MadeHouse(house.plan), house.Caster(), frame, 0.1, scaled).Facing(180.0);
  EXPECT_NEAR(metres["wall_width_m"].get<double>(), 24.0, 1e-9);
  EXPECT_NEAR(metres["pixel_m"].get<double>(), 0.2, 1e-9);
  EXPECT_EQ(metres["width_px"], 120);
  EXPECT_NEAR(metres["top_left"][0].get<double>(), 40.0, 1e-9);
  const Result without(MadeHouse(house.plan), house.Caster(), frame, 0.1, unknown);
  EXPECT_EQ(without.description["crs"], "local frame, unknown scale");
  const json& units = without.Facing(180.0);
  EXPECT_NEAR(units["wall_width"].get<double>(), 12.0, 1e-9);
  for (const auto& [name, value] : units.items()) EXPECT_FALSE(name.ends_with("_m")) << name;
}

TEST(WriteFacades, WhatIsNotOpaqueNearTheWallIsTransparent) {
  PaintedHouse near{.plan = Flat(), .depth_m = 1.4}, deep{.plan = Flat(), .depth_m = 1.6}, thin{.plan = Flat(), .opacity = 0.4};
  const Building house = MadeHouse(Flat());
  const Result shown(house, near.Caster()), behind(house, deep.Caster()), faint(house, thin.Caster());
  EXPECT_EQ(shown.Picture(shown.Facing(180.0)).at<cv::Vec4b>(25, 60)[3], 255);
  for (const Result* empty : {&behind, &faint}) {
    for (const json& facade : empty->description["facades"]) EXPECT_DOUBLE_EQ(facade["shown"].get<double>(), 0.0);
    EXPECT_EQ(empty->Picture(empty->Facing(180.0)).at<cv::Vec4b>(25, 60), cv::Vec4b(0, 0, 0, 0));
  }
  // Premultiplied colours are made straight.
  PaintedHouse hazy{.plan = Flat(), .opacity = 0.8};
  const Result straight(house, hazy.Caster());
  EXPECT_EQ(straight.Picture(straight.Facing(180.0)).at<cv::Vec4b>(5, 60), cv::Vec4b(128, 128, 128, 255));
}

TEST(WriteFacades, TheEndOfAGableHasTheShapeOfTheGable) {
  const surface::RayCaster opaque = [](std::span<const render::Ray>, std::span<render::RayColor> out) {
    for (render::RayColor& color : out) color.opacity = color.rgb_srgb[0] = 1.0F;
  };
  const Result result(MadeHouse({}), opaque);
  const json& west = result.Facing(270.0);
  const cv::Mat picture = result.Picture(west);
  ASSERT_EQ(picture.rows, 80);
  ASSERT_EQ(picture.cols, 80);
  EXPECT_EQ(picture.at<cv::Vec4b>(0, 0)[3], 0);
  EXPECT_EQ(picture.at<cv::Vec4b>(3, 40)[3], 255);
  EXPECT_EQ(picture.at<cv::Vec4b>(79, 0)[3], 255);
  EXPECT_NEAR(west["shown"].get<double>(), (8.0 * 5.0 + 0.5 * 8.0 * 3.0) / 64.0, 0.01);
}

TEST(WriteFacades, RaysBeginInFrontOfTheWallButNotBehindTheNextOne) {
  PaintedHouse free{.plan = Flat()};
  const Result box(MadeHouse(free.plan), free.Caster());
  ASSERT_FALSE(free.seen.empty());
  for (const render::Ray& ray : free.seen) {
    EXPECT_NEAR(ray.t_far, 4.5, 1e-9);
    EXPECT_NEAR(ray.direction_enu.norm(), 1.0, 1e-9);
    EXPECT_NEAR(static_cast<double>(ray.pixel_width), 0.1, 1e-6);
  }
  // A courtyard of 4 x 2 m: its rays begin halfway to the opposite wall.
  PaintedHouse court{.plan = Large()};
  const Result yard(MadeCourtyard(court.plan, 6.0), court.Caster());
  EXPECT_EQ(yard.description["facades"].size(), 8U);
  std::set<long> starts_cm;
  for (const render::Ray& ray : court.seen) starts_cm.insert(std::lround(100.0 * (ray.t_far - 1.5)));
  EXPECT_EQ(starts_cm, (std::set<long>{100, 200, 300}));
}

TEST(WriteFacades, NarrowWallsHaveNoPictures) {
  // The wing is 0.8 m deep, so that two of its three walls are narrow; the third and the main part's have pictures.
  PaintedHouse house{.plan = Large()};
  const Result result(MadeLHouse(house.plan, 5.0, 0.8), house.Caster());
  EXPECT_EQ(result.description["facades"].size(), 5U);
}

TEST(WriteFacades, CancelledRunsAndBrokenFoldersAreReported) {
  PaintedHouse house{.plan = Flat()};
  TemporaryFolder folder;
  base::ThreadPool threads(1);
  const surface::MapFrame map{scene::SceneInfo{}};
  const BuildingSet set;
  const FileFrame frame(set, map);
  ExpectStopsWhenAsked([&] { WriteFacades(MadeHouse(house.plan), house.Caster(), frame, 0.1, folder.path(), threads); });
  EXPECT_FALSE(std::filesystem::exists(folder / "facade_1.json"));
  std::ofstream(folder / "file") << "x";
  EXPECT_NE(InputErrorOf([&] { WriteFacades(MadeHouse(house.plan), house.Caster(), frame, 0.1, folder / "file", threads); }), "");
}

TEST(WallSides, CoplanarWallsThatTouchAreOneAndOthersAreNot) {
  EXPECT_EQ(WallSidesOf(MadeTHouse({}, {}).lod22).size(), 8U);  // the main south wall twice, left and right of the wing
  EXPECT_EQ(WallSidesOf(MadeLHouse(Large()).lod22).size(), 6U);
  // A wall in two faces, one beside the other.
  Solid solid = MadeHouse(Flat()).lod22;
  const auto wall = std::find_if(solid.face.begin(), solid.face.end(), [](const Face& face) { return face.kind == FaceKind::kWall; });
  const Face second{FaceKind::kWall, {wall->outer[0], wall->outer[2], wall->outer[3]}, {}};
  wall->outer.pop_back();
  solid.face.push_back(second);
  const std::vector<WallSide> sides = WallSidesOf(solid);
  ASSERT_EQ(sides.size(), 4U);
  double area = 0.0;
  for (const WallSide& side : sides) area += side.width_m * side.height_m;
  EXPECT_NEAR(area, 2.0 * (12.0 + 8.0) * 5.0, 1e-9);
  EXPECT_TRUE(WallSidesOf(Solid{}).empty());
}

}  // namespace
}  // namespace skyquilt::buildings
