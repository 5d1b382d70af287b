#include "tour/propose/propose_tour.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tour/format/read_tour.h"
#include "tour/format/write_tour.h"
#include "tour/propose/relief.h"

namespace skyquilt::tour {
namespace {

// Ground at 5 m, with houses 12 m high where `is_house` says so; cells of a metre.
template <typename IsHouse>
Heights GroundWith(const IsHouse& is_house) {
  constexpr int kSide = 160;
  std::vector<double> z;
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) z.push_back(is_house(column - 80, row - 80) ? 17.0 : 5.0);
  }
  return {{-80.0, -80.0}, {1.0, 1.0}, kSide, kSide, std::move(z)};
}

BuildingMark MarkAt(int id, double x, double y, double length, double width, double height) {
  return {.id = id, .roof = "gable", .middle_enu = {x, y, 5.0}, .length_m = length, .width_m = width, .height_m = height};
}

ProposeInput InputFor(const Heights& heights, int stops) {
  ProposeInput input;
  input.name = "hamlet";
  input.box_enu = {Eigen::Vector3d(-80.0, -80.0, 0.0), Eigen::Vector3d(80.0, 80.0, 30.0)};
  input.ground_m = 5.0;
  input.heights = &heights;
  input.stops = stops;
  return input;
}

Eigen::Vector3d LookOf(const Pose& pose) {
  return pose.cam_from_enu.conjugate() * Eigen::Vector3d::UnitZ();
}

// Two metres from all cells, by asking every one of them.
bool IsFree(const Heights& heights, const Eigen::Vector3d& eye) {
  for (int row = 0; row < heights.rows(); ++row) {
    for (int column = 0; column < heights.columns(); ++column) {
      const double x = heights.box().min().x() + column, y = heights.box().min().y() + row, top = heights.Top(column, row);
      const double dx = std::max({0.0, x - eye.x(), eye.x() - x - 1.0}), dy = std::max({0.0, y - eye.y(), eye.y() - y - 1.0});
      const double dz = std::max(0.0, eye.z() - top);
      if (std::sqrt(dx * dx + dy * dy + dz * dz) < 2.0 - 1e-9) return false;
    }
  }
  return true;
}

TEST(ProposeTour, ShowsTheSurveyThenItsLargestBuildings) {
  const Heights heights = GroundWith([](int, int) { return false; });
  ProposeInput input = InputFor(heights, 3);
  input.buildings = {MarkAt(1, 0.0, 0.0, 8.0, 6.0, 5.0), MarkAt(2, 30.0, 30.0, 20.0, 10.0, 9.26), MarkAt(3, -30.0, -40.0, 20.0, 10.0, 12.0),
                     MarkAt(4, 50.0, -50.0, 90.0, 90.0, 50.0)};
  input.buildings[3].accepted = false;
  const Tour tour = ProposeTour(input);
  ASSERT_EQ(tour.stops.size(), 3U);
  EXPECT_EQ(tour.title, "hamlet");
  EXPECT_EQ(tour.stops[0].id, "overview");
  // On a round from the south by the west.
  EXPECT_EQ(tour.stops[1].id, "building-3");
  EXPECT_EQ(tour.stops[2].title, "Building 2, 9.3 m high");
  EXPECT_EQ(tour.stops[2].text, "20.0 m long, 10.0 m wide and 9.3 m high. It has a gable roof.");
  EXPECT_FALSE(tour.stops[0].next->to.has_value());
  EXPECT_EQ(tour.stops[2].next->to, "overview") << "the round is closed";
  EXPECT_NO_THROW(ParseTour(FormatTour(tour))) << "what can be saved";
  EXPECT_EQ(FormatTour(ProposeTour(input)), FormatTour(tour));
}

// In the overview the corners of the survey are in the picture, as wide as 16 : 9.
TEST(ProposeTour, TheOverviewShowsEverything) {
  const Heights heights = GroundWith([](int, int) { return false; });
  const Pose pose = ProposeTour(InputFor(heights, 1)).stops.at(0).pose;
  const double half_height = std::tan(0.5 * pose.fovy_deg * M_PI / 180.0);
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d x(corner % 2 ? 80.0 : -80.0, corner / 2 % 2 ? 80.0 : -80.0, corner / 4 ? 17.0 : 5.0);
    const Eigen::Vector3d in_cam = pose.cam_from_enu * (x - pose.eye_enu);
    ASSERT_GT(in_cam.z(), 0.0);
    EXPECT_LE(std::abs(in_cam.y() / in_cam.z()), half_height);
    EXPECT_LE(std::abs(in_cam.x() / in_cam.z()), half_height * 16.0 / 9.0);
  }
}

// A dense town: views keep clear of all houses, and nothing stands between them and what they look at.
TEST(ProposeTour, ViewsAreFreeAndNothingHidesTheBuilding) {
  const auto is_house = [](int x, int y) { return (x + 80) % 20 < 11 && (y + 80) % 20 < 11; };
  const Heights heights = GroundWith(is_house);
  ProposeInput input = InputFor(heights, 9);
  for (int i = 0; i < 8; ++i) input.buildings.push_back(MarkAt(i + 1, -54.5 + 20.0 * (i % 4), -14.5 + 20.0 * (i / 4), 11.0, 11.0, 12.0));
  const Tour tour = ProposeTour(input);
  ASSERT_EQ(tour.stops.size(), 9U);
  for (size_t i = 1; i < tour.stops.size(); ++i) {
    const Pose& pose = tour.stops[i].pose;
    EXPECT_TRUE(IsFree(heights, pose.eye_enu)) << tour.stops[i].id;
    const int id = std::stoi(tour.stops[i].id.substr(9)) - 1;
    const Eigen::Vector2d middle(-54.5 + 20.0 * (id % 4), -14.5 + 20.0 * (id / 4));
    // The middle of the picture is on this building, which is the first that the ray meets.
    const Eigen::Vector3d look = LookOf(pose);
    double t = 0.0;
    std::optional<double> top;
    Eigen::Vector3d x = pose.eye_enu;
    for (; t < 200.0; t += 0.02) {
      x = pose.eye_enu + t * look;
      top = heights.At(x.x(), x.y());
      if (top && x.z() <= *top) break;
    }
    EXPECT_LE((x.head<2>() - middle).cwiseAbs().maxCoeff(), 6.0) << tour.stops[i].id;
  }
}

TEST(ProposeTour, WithoutBuildingsItShowsRelief) {
  const Heights heights = GroundWith([](int x, int y) { return std::hypot(x - 30, y - 20) < 5.0 || std::hypot(x + 40, y + 10) < 4.0; });
  const Tour tour = ProposeTour(InputFor(heights, 6));
  ASSERT_EQ(tour.stops.size(), 3U) << "flat ground is nothing to look at";
  std::set<std::string> ids;
  for (const Stop& stop : tour.stops) ids.insert(stop.id);
  EXPECT_EQ(ids, (std::set<std::string>{"overview", "place-1", "place-2"}));
  for (size_t i = 1; i < 3; ++i) {
    EXPECT_NE(tour.stops[i].title.find("12.0 m of relief"), std::string::npos) << tour.stops[i].title;
    EXPECT_TRUE(IsFree(heights, tour.stops[i].pose.eye_enu));
  }
  EXPECT_EQ(FormatTour(ProposeTour(InputFor(heights, 6))), FormatTour(tour));
}

TEST(ProposeTour, SaysNoLengthsWithoutAScale) {
  const Heights heights = GroundWith([](int x, int y) { return std::hypot(x - 30, y - 20) < 5.0; });
  ProposeInput input = InputFor(heights, 3);
  input.metric = false;
  input.buildings = {MarkAt(7, -30.0, -30.0, 8.0, 6.0, 5.0)};
  input.buildings[0].metric = false;
  input.name = std::string(201, 'x');
  const Tour tour = ProposeTour(input);
  EXPECT_EQ(tour.title, "");
  for (const Stop& stop : tour.stops) {
    EXPECT_EQ(stop.title.find(" m "), std::string::npos);
    EXPECT_EQ(stop.text.find(" m "), std::string::npos);
  }
}

TEST(ProposeTour, NeedsNoSurfaceModel) {
  const Heights heights = GroundWith([](int, int) { return false; });
  ProposeInput input = InputFor(heights, 4);
  input.heights = nullptr;
  input.buildings = {MarkAt(7, -30.0, -30.0, 8.0, 6.0, 5.0), MarkAt(8, std::nan(""), 0.0, 8.0, 6.0, 5.0)};
  EXPECT_EQ(ProposeTour(input).stops.size(), 2U);
}

TEST(FindRelief, PlacesAreApartAndAwayFromOthers) {
  const Heights heights = GroundWith([](int x, int y) { return (x + 80) % 10 < 3 && (y + 80) % 10 < 3; });
  const std::vector<Eigen::Vector2d> taken = {{0.0, 0.0}};
  const std::vector<ReliefPlace> places = FindRelief(heights, 5, taken);
  ASSERT_EQ(places.size(), 5U);
  for (size_t i = 0; i < places.size(); ++i) {
    EXPECT_GE((places[i].low_enu.head<2>() - taken[0]).norm(), 2.0 * places[i].size_m);
    for (size_t j = 0; j < i; ++j) EXPECT_GE((places[i].low_enu - places[j].low_enu).head<2>().norm(), 2.0 * places[i].size_m);
  }
}

}  // namespace
}  // namespace skyquilt::tour
