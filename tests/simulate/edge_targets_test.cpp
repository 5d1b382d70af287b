// Slanted edges: the line between black and white is where the file says, in the map and for whoever reads the survey.
#include "simulate/edge_targets.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/progress.h"
#include "core/gis/geotiff.h"
#include "core/gis/map_projection.h"
#include "core/gis/read_maps.h"
#include "core/image/srgb.h"
#include "simulate/simulate.h"
#include "simulate/true_orthophoto.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;

class EdgeTargets : public InTemporaryFolder {
 protected:
  static void SetUpTestSuite() {
    base::Progress::SetQuiet(true);
    threads_ = new base::ThreadPool(2);
    SimulateOptions options;
    options.place = "town";
    options.tree_density = 0.2;
    place_ = new PlaceSpec(ResolvePlace(options));
    place_->city.tree_detail = 0;
    place_->ambient_voxel_m = 24.0;
    world_ = new World(*place_, 1.0, *threads_);
    photos_ = new std::vector<PhotoPlan>(PlanFlight(*place_, world_->TakeoffHeight(*place_)));
    frame_ = new geo::EnuFrame({options.latitude_deg, options.longitude_deg, options.height_m});
    targets_ = new std::vector<EdgeTarget>(Choose({}, *threads_));
  }
  static void TearDownTestSuite() {
    delete targets_;
    delete frame_;
    delete photos_;
    delete world_;
    delete place_;
    delete threads_;
  }
  static std::vector<EdgeTarget> Choose(const std::vector<PaintedTarget>& others, base::ThreadPool& threads) {
    return ChooseEdgeTargets(*world_, *place_, *photos_, *frame_, others, 3, threads);
  }

  static inline base::ThreadPool* threads_ = nullptr;
  static inline PlaceSpec* place_ = nullptr;
  static inline World* world_ = nullptr;
  static inline std::vector<PhotoPlan>* photos_ = nullptr;
  static inline geo::EnuFrame* frame_ = nullptr;
  static inline std::vector<EdgeTarget>* targets_ = nullptr;
};

TEST_F(EdgeTargets, TheLineIsWhereItShould) {
  constexpr int kCells = 60;
  ASSERT_EQ(targets_->size(), 3U);
  gis::MapGrid grid{.georeferenced = true, .zone = geo::UtmZoneOf(frame_->origin()), .width = kCells, .height = kCells};
  const gis::MapProjection projection(frame_->origin(), grid);
  for (const EdgeTarget& target : *targets_) {
    const double side_m = target.paint.side_m;
    EXPECT_GE(side_m, 4.0);
    EXPECT_LE(target.centre.head<2>().cwiseAbs().maxCoeff(), 100.0);
    // Five degrees from the map's north.
    const double yaw_rad = target.paint.yaw_rad;
    const Vector2d middle = projection.EastingNorthing(target.centre);
    const Vector2d ahead = projection.EastingNorthing(target.centre + 10.0 * Eigen::Vector3d(std::cos(yaw_rad), std::sin(yaw_rad), 0.0)) - middle;
    EXPECT_NEAR(std::atan2(-ahead.x(), ahead.y()) * 180.0 / std::numbers::pi, 5.0, 0.01);

    world_->PaintTargets({target.paint});
    grid.resolution_m = side_m / 50.0;
    grid.left = middle.x() - 0.5 * kCells * grid.resolution_m;
    grid.top = middle.y() + 0.5 * kCells * grid.resolution_m;
    WriteTrueOrthophoto(*world_, grid, *frame_, 4, true, *threads_, folder_ / "map.tif");
    const image::ImageF map = gis::ReadReduced(folder_ / "map.tif", kCells).image;
    const Vector2d along = ahead.normalized(), left(-along.y(), along.x());
    std::array<double, 2> display{}, linear{};  // black half, white half, away from the line
    std::array<int, 2> n{};
    std::array<std::vector<double>, 2> near;  // linear light around the line, ahead and behind
    for (int y = 0; y < kCells; ++y) {
      for (int x = 0; x < kCells; ++x) {
        const Vector2d from = grid.CellCentre(x, y) - middle;
        const double u = from.dot(along) / side_m, v = from.dot(left) / side_m;
        if (std::abs(u) > 0.4 || std::abs(v) > 0.4) continue;
        const float value = map.At(x, y)[1];
        const auto light = static_cast<double>(image::LinearFromSrgb(value / 255.0F));
        near[u > 0.0 ? 0 : 1].push_back(light);
        if (std::abs(v) < 0.06) continue;
        const size_t half = v > 0.0 ? 0 : 1;
        display[half] += static_cast<double>(value);
        linear[half] += light;
        ++n[half];
      }
    }
    for (const size_t half : {0U, 1U}) {
      display[half] /= n[half];
      linear[half] /= n[half];
    }
    EXPECT_NEAR(display[0], 40.0, 15.0);
    EXPECT_NEAR(display[1], 215.0, 15.0);
    // Half of the light is on each side of the line, so that it passes through the centre in this direction.
    for (const std::vector<double>& part : near) {
      double white = 0.0;
      for (const double light : part) white += (light - linear[0]) / (linear[1] - linear[0]);
      EXPECT_NEAR(white / static_cast<double>(part.size()), 0.5, 0.012);
    }
  }
  world_->PaintTargets({});
}

TEST_F(EdgeTargets, DoNotMeetOthers) {
  std::vector<PaintedTarget> others;
  for (const EdgeTarget& target : *targets_) others.push_back(target.paint);
  for (const EdgeTarget& target : Choose(others, *threads_)) {
    for (const PaintedTarget& other : others)
      EXPECT_GT((target.paint.centre - other.centre).norm(), (target.paint.side_m + other.side_m) / std::numbers::sqrt2);
  }
}

TEST_F(EdgeTargets, TheSameForAnyNumberOfThreads) {
  base::ThreadPool one(1);
  const std::vector<EdgeTarget> again = Choose({}, one);
  ASSERT_EQ(again.size(), targets_->size());
  for (size_t i = 0; i < again.size(); ++i) {
    EXPECT_EQ(again[i].centre, (*targets_)[i].centre);
    EXPECT_EQ(again[i].paint.side_m, (*targets_)[i].paint.side_m);
  }
}

TEST_F(EdgeTargets, TheFileSaysWhereTheyAre) {
  WriteEdgeTargets(*targets_, folder_ / "edges.json");
  const nlohmann::json list = base::ParseJson(base::ReadFile(folder_ / "edges.json")).at("targets");
  ASSERT_EQ(list.size(), targets_->size());
  for (size_t i = 0; i < list.size(); ++i) {
    const EdgeTarget& target = (*targets_)[i];
    for (size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(list[i].at("centre_enu").at(axis), target.centre[static_cast<Eigen::Index>(axis)]);
    EXPECT_EQ(list[i].at("side_m"), target.paint.side_m);
    EXPECT_NEAR(list[i].at("yaw_deg").get<double>(), 95.0, 1.0);
    EXPECT_EQ(list[i].at("black_half"), "left of the line through the centre along yaw");
  }
}

TEST(EdgeTargetSurvey, SimulateWritesMapAndTargets) {
  const TemporaryFolder folder;
  base::Progress::SetQuiet(true);
  base::ThreadPool threads(2);
  SimulateOptions options;
  options.place = "hamlet";
  options.image_width = 48;
  options.samples_per_pixel = 1;
  options.ortho_cell_m = 0.5;
  options.edge_targets = 1;
  Simulate(options, folder / "survey", threads);
  EXPECT_TRUE(base::ParseJson(base::ReadFile(folder / "survey/truth/edge_targets.json")).at("targets").is_array());
  const gis::MapGrid grid = gis::ReadMapGrid(folder / "survey/truth/orthophoto.tif");
  EXPECT_EQ(grid.resolution_m, 0.5);
  EXPECT_GE(grid.width, 140);  // the area is 70 m wide
  EXPECT_LE(grid.width, 382);  // and the place 190 m
  EXPECT_EQ(base::ParseJson(base::ReadFile(folder / "survey/simulate.json")).at("options").at("ortho_cell_m"), 0.5);
}

}  // namespace
}  // namespace skyquilt::simulate
