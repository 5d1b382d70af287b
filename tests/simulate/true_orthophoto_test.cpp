// The true orthophoto: the colours of photos, everything straight above its place, and a map that lies where it says.
#include "simulate/true_orthophoto.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/gis/geotiff.h"
#include "core/gis/map_projection.h"
#include "core/gis/read_maps.h"
#include "simulate/photo_renderer.h"
#include "simulate/survey_writer.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kCell_m = 0.2;
constexpr double kHigh_m = 2000.0;  // of cameras, above the ground: no roof leans

SimulateOptions Town() {
  SimulateOptions options;
  options.place = "town";
  options.tower_m = 40.0;
  options.longitude_deg = 9.0;  // in the middle of its zone, so that the map's north is that of the ENU frame
  return options;
}

class TrueOrthophoto : public InTemporaryFolder {
 protected:
  static void SetUpTestSuite() {
    base::Progress::SetQuiet(true);
    threads_ = new base::ThreadPool(2);
    const SimulateOptions options = Town();
    place_ = new PlaceSpec(ResolvePlace(options));
    place_->city.tree_detail = 0;
    place_->ambient_voxel_m = 24.0;
    world_ = new World(*place_, 1.0, *threads_);
    frame_ = new geo::EnuFrame({options.latitude_deg, options.longitude_deg, options.height_m});
  }
  static void TearDownTestSuite() {
    delete frame_;
    delete world_;
    delete place_;
    delete threads_;
  }

  static gis::MapProjection Projection() { return {frame_->origin(), Around(Vector2d::Zero(), 1, 1)}; }
  static double GroundAt(const Vector2d& at) {
    return static_cast<double>(world_->terrain().Height(static_cast<float>(at.x()), static_cast<float>(at.y())));
  }
  // A grid of so many cells with its middle at an easting and northing.
  static gis::MapGrid Around(const Vector2d& map_xy, int width, int height) {
    gis::MapGrid grid{.georeferenced = true, .zone = geo::UtmZoneOf(frame_->origin()), .resolution_m = kCell_m, .width = width, .height = height};
    grid.left = map_xy.x() - 0.5 * width * kCell_m;
    grid.top = map_xy.y() + 0.5 * height * kCell_m;
    return grid;
  }
  image::ImageF Written(const gis::MapGrid& grid) const {
    WriteTrueOrthophoto(*world_, grid, *frame_, 4, true, *threads_, folder_ / "map.tif");
    return gis::ReadReduced(folder_ / "map.tif", grid.width).image;
  }
  // What a camera high above this place shows, one pixel per cell.
  static image::Image8 SeenFromAbove(const Vector2d& at, int width, int height, const MovingScene& moving) {
    const camera::Camera camera{camera::CameraModel::kSimplePinhole, width, height, {kHigh_m / kCell_m, 0.5 * width, 0.5 * height}};
    const geo::Rigid3d pose = PoseFromGimbal({at.x(), at.y(), GroundAt(at) + kHigh_m}, 0.0, -90.0, 0.0);
    return Develop(PhotoRenderer(*world_, camera, 4, true).Render(pose, moving, *threads_).rgb_linear, {});
  }
  static MovingScene NothingMoves() { return {{}, {}, {}, raytrace::TracedScene({}, {})}; }
  // Largest difference of red, green and blue.
  static double Difference(const float* cell, const uint8_t* pixel) {
    double largest = 0.0;
    for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(static_cast<double>(cell[c]) - pixel[c]));
    return largest;
  }

  static inline base::ThreadPool* threads_ = nullptr;
  static inline PlaceSpec* place_ = nullptr;
  static inline World* world_ = nullptr;
  static inline geo::EnuFrame* frame_ = nullptr;
};

// Of everything low: what is high leans by a small part of a pixel only in the middle of the photo.
TEST_F(TrueOrthophoto, HasTheColoursOfACameraFarAbove) {
  constexpr int kWidth = 80, kHeight = 60;
  const gis::MapProjection projection = Projection();
  for (const Vector2d& at : {Vector2d(-33.0, -33.0), Vector2d(20.0, 50.0), Vector2d(60.0, -45.0)}) {
    const image::ImageF map = Written(Around(projection.EastingNorthing({at.x(), at.y(), GroundAt(at)}), kWidth, kHeight));
    const image::Image8 photo = SeenFromAbove(at, kWidth, kHeight, NothingMoves());
    int alike = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        ASSERT_EQ(map.At(x, y)[3], 255.0F);
        alike += Difference(map.At(x, y), photo.At(x, y)) <= 8.0 ? 1 : 0;
      }
    }
    EXPECT_GT(alike, kWidth * kHeight * 85 / 100) << at.transpose();
  }
}

// A camera straight above each place sees it as the map shows it, on the roof's rim and beside the foot of the wall.
TEST_F(TrueOrthophoto, HighRoofsAreAboveTheirWalls) {
  const auto& buildings = world_->buildings();
  const Building& tower =
      *std::max_element(buildings.begin(), buildings.end(), [](const Building& a, const Building& b) { return a.eave_height_m < b.eave_height_m; });
  ASSERT_GT(tower.eave_height_m, 30.0);
  const gis::MapProjection projection = Projection();
  const gis::MapGrid grid = Around(projection.EastingNorthing({tower.centre.x(), tower.centre.y(), tower.ground_z_m}), 250, 250);
  const image::ImageF map = Written(grid);
  int n = 0, alike = 0;
  for (int step = 0; step < 72; ++step) {
    const double angle = step * 5.0 * M_PI / 180.0;
    for (double reach_m = 4.0; reach_m < 24.0; reach_m += 5.0) {
      const Vector2d at = tower.centre + reach_m * Vector2d(std::cos(angle), std::sin(angle));
      const Vector2d cell = grid.CellOf(projection.EastingNorthing({at.x(), at.y(), tower.ground_z_m})).array().round();
      const Vector3d middle = projection.VerticalLineAt(grid.CellCentre(cell.x(), cell.y())).start_enu;
      const image::Image8 photo = SeenFromAbove(middle.head<2>(), 1, 1, NothingMoves());
      alike += Difference(map.At(static_cast<int>(cell.x()), static_cast<int>(cell.y())), photo.At(0, 0)) <= 10.0 ? 1 : 0;
      ++n;
    }
  }
  EXPECT_GT(alike, n * 85 / 100);
}

TEST_F(TrueOrthophoto, CarsThatMoveAreAbsent) {
  const MovingScene moving = world_->MovingAt(0.0);
  const gis::MapProjection projection = Projection();
  int n = 0, hidden = 0;
  for (const Car& car : moving.cars) {
    if (car.position.cwiseAbs().maxCoeff() > 100.0) continue;
    const image::ImageF map = Written(Around(projection.EastingNorthing({car.position.x(), car.position.y(), car.ground_z_m}), 1, 1));
    const image::Image8 with = SeenFromAbove(car.position, 1, 1, moving), without = SeenFromAbove(car.position, 1, 1, NothingMoves());
    EXPECT_LE(Difference(map.At(0, 0), without.At(0, 0)), 15.0);
    hidden += with.data != without.data ? 1 : 0;
    ++n;
  }
  EXPECT_TRUE(n == 0 || hidden > 0);
}

TEST_F(TrueOrthophoto, LiesWhereItSays) {
  const std::vector<PhotoPlan> photos = PlanFlight(*place_, world_->TakeoffHeight(*place_));
  const double ground = world_->TakeoffHeight(*place_);
  const gis::MapGrid grid = PlanTrueOrthophoto(*place_, photos, ground, *frame_, 2.5);
  const auto whole = [](double value) { return std::abs(value - std::round(value)) < 1e-6; };
  EXPECT_TRUE(whole(grid.left / 2.5) && whole(grid.top / 2.5));
  EXPECT_EQ(grid.zone.Epsg(), 32632);
  // The photos see all of the area, and nothing is drawn beyond what is built but what edges of cells need.
  for (const double x : {0.0, 1.0}) {
    for (const double y : {0.0, 1.0}) {
      const Vector2d corner(grid.left + x * grid.width * 2.5, grid.top - y * grid.height * 2.5);
      const Vector3d enu = frame_->EnuFromGeodetic(geo::GeodeticFromUtm(corner, frame_->origin().height_m + ground, grid.zone));
      const Vector2d out = (x == 0.0 ? -1.0 : 1.0) * Vector2d::UnitX() + (y == 0.0 ? 1.0 : -1.0) * Vector2d::UnitY();
      const Vector2d outwards = enu.head<2>().cwiseProduct(out);
      EXPECT_GT(outwards.minCoeff(), 100.0);
      EXPECT_LT(outwards.maxCoeff(), 100.0 + place_->surround_m + 3.0);
    }
  }
  WriteTrueOrthophoto(*world_, grid, *frame_, 4, false, *threads_, folder_ / "whole.tif");
  const gis::MapGrid read = gis::ReadMapGrid(folder_ / "whole.tif");
  EXPECT_EQ(read.zone.Epsg(), 32632);
  EXPECT_NEAR(read.left, grid.left, 1e-6);
  EXPECT_NEAR(read.top, grid.top, 1e-6);
  EXPECT_EQ(read.width, grid.width);
  EXPECT_EQ(read.height, grid.height);
}

// Where nothing is built there is no data.
TEST_F(TrueOrthophoto, EndsWithThePlace) {
  const double rim = place_->area_max.x() + place_->surround_m;
  const image::ImageF map = Written(Around(Projection().EastingNorthing({rim, 0.0, GroundAt({rim - 1.0, 0.0})}), 40, 4));
  for (int y = 0; y < 4; ++y) {
    EXPECT_EQ(map.At(5, y)[3], 255.0F);
    EXPECT_EQ(map.At(37, y)[3], 0.0F);
  }
}

// Several bands of rows, and rows that are no whole number of packets.
TEST_F(TrueOrthophoto, SameBytesForAnyNumberOfThreads) {
  const gis::MapGrid grid = Around(Projection().EastingNorthing({0.0, 0.0, 0.0}), 31, 301);
  base::ThreadPool one(1), three(3);
  WriteTrueOrthophoto(*world_, grid, *frame_, 4, true, one, folder_ / "one.tif");
  WriteTrueOrthophoto(*world_, grid, *frame_, 4, true, three, folder_ / "three.tif");
  EXPECT_EQ(base::ReadFile(folder_ / "one.tif"), base::ReadFile(folder_ / "three.tif"));
}

TEST_F(TrueOrthophoto, StopsWhenAsked) {
  const gis::MapGrid grid = Around(Projection().EastingNorthing({0.0, 0.0, 0.0}), 8, 8);
  ExpectStopsWhenAsked([&] { WriteTrueOrthophoto(*world_, grid, *frame_, 4, true, *threads_, folder_ / "map.tif"); });
  EXPECT_FALSE(std::filesystem::exists(folder_ / "map.tif"));
}

TEST(OrthophotoOptions, CellsThatCannotBeAreRefused) {
  SimulateOptions options;
  options.ortho_cell_m = 0.05;
  EXPECT_NO_THROW(options.Check());
  options.ortho_cell_m = 0.001;
  EXPECT_NE(UsageErrorOf([&] { options.Check(); }).find("simulate.ortho_cell_m"), std::string::npos);
  options.place = "smallcity";
  options.ortho_cell_m = 0.02;
  const std::string too_many = UsageErrorOf([&] { options.Check(); });
  EXPECT_NE(too_many.find("simulate.ortho_cell_m = 0.02"), std::string::npos) << too_many;
  EXPECT_NE(too_many.find("more than 400 million"), std::string::npos) << too_many;
  options = {};
  options.flight = "orbit";
  options.ortho_cell_m = 0.1;
  EXPECT_NE(UsageErrorOf([&] { options.Check(); }).find("simulate.ortho_cell_m"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::simulate
