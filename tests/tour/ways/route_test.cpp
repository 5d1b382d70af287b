// The same ways as the page's: web/test/unit/tour/route_cases.spec.ts reads the same table.
#include "tour/ways/route.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "tour/ways/film.h"

namespace skyquilt::tour {
namespace {

using Json = nlohmann::json;

Eigen::Vector3d VectorFrom(const Json& list) {
  return {list.at(0).get<double>(), list.at(1).get<double>(), list.at(2).get<double>()};
}

Pose PoseFrom(const Json& json) {
  const Json& q = json.at("rotation");
  return {.eye_enu = VectorFrom(json.at("eye")),
          .cam_from_enu = {q.at(0).get<double>(), q.at(1).get<double>(), q.at(2).get<double>(), q.at(3).get<double>()},
          .fovy_deg = json.at("fovyDeg").get<double>()};
}

Path PathFrom(const Json& json) {
  if (json.at("kind") == "orbit") return {PathKind::kOrbit, VectorFrom(json.at("about"))};
  return {json.at("kind") == "over" ? PathKind::kOver : PathKind::kDirect, {}};
}

TEST(Route, IsThatOfTheTable) {
  const Json table = Json::parse(base::ReadFile("web/test/unit/tour/route_cases.json"));
  const Json& grid = table.at("heights");
  std::vector<double> z;
  for (const Json& top : grid.at("z")) z.push_back(top.is_null() ? std::nan("") : top.get<double>());
  const auto number = [&grid](const char* key) { return grid.at(key).get<double>(); };
  const Heights heights(Eigen::Vector2d(number("minX"), number("minY")), Eigen::Vector2d(number("cellX"), number("cellY")),
                        grid.at("columns").get<int>(), grid.at("rows").get<int>(), z);
  ASSERT_GE(table.at("cases").size(), 12U);
  for (const Json& one : table.at("cases")) {
    const std::string name = one.at("name");
    const bool solid = one.at("solid");
    const Route route(PoseFrom(one.at("from")), PoseFrom(one.at("to")), PathFrom(one.at("path")), solid ? &heights : nullptr);
    EXPECT_NEAR(route.length_m(), one.at("lengthM").get<double>(), 1e-6) << name;
    const double duration = one.at("durationS");
    EXPECT_NEAR(route.duration_s(), duration, 1e-6) << name;
    const Json& poses = one.at("poses");
    for (size_t i = 0; i < poses.size(); ++i) {
      const Pose there = PoseFrom(poses[i]), pose = route.At(duration * static_cast<double>(i + 1) / static_cast<double>(poses.size() + 1));
      EXPECT_LT((pose.eye_enu - there.eye_enu).norm(), 1e-6) << name << " " << i;
      EXPECT_LT(pose.cam_from_enu.angularDistance(there.cam_from_enu), 1e-6) << name << " " << i;
      EXPECT_NEAR(pose.fovy_deg, there.fovy_deg, 1e-6) << name << " " << i;
    }
  }
}

TEST(Route, BeginsAndEndsAtThePosesAndMayBeACut) {
  Pose from, to;
  to.eye_enu = {10.0, 0.0, 5.0};
  to.fovy_deg = 20.0;
  const Route way(from, to, {}, nullptr);
  EXPECT_EQ(way.At(-1.0).eye_enu, from.eye_enu);
  EXPECT_EQ(way.At(0.0).fovy_deg, from.fovy_deg);
  EXPECT_EQ(way.At(way.duration_s()).eye_enu, to.eye_enu);
  EXPECT_GT(way.duration_s(), 1.0);
  const Route cut(from, to, {PathKind::kJump, {}}, nullptr);
  EXPECT_EQ(cut.duration_s(), 0.0);
  EXPECT_EQ(cut.At(0.0).eye_enu, to.eye_enu);
  EXPECT_EQ(Route(from, from, {}, nullptr).duration_s(), 0.0);
}

Tour RoundOf(int stops) {
  Tour tour;
  for (int i = 0; i < stops; ++i) {
    Stop stop;
    stop.id = "s" + std::to_string(i);
    stop.pose.eye_enu = {10.0 * i, 0.0, 5.0};
    stop.pause_s = 3.0;
    stop.next = Next{};
    tour.stops.push_back(stop);
  }
  return tour;
}

// The stops in the order in which the film stands at them.
std::vector<size_t> ShownBy(const Tour& tour) {
  std::vector<size_t> shown;
  for (const FilmFrame& frame : FilmOf(tour, nullptr, 10)) {
    for (size_t i = 0; i < tour.stops.size(); ++i) {
      const bool stands = frame.pose.eye_enu == tour.stops[i].pose.eye_enu;
      if (stands && frame.stop == i && (shown.empty() || shown.back() != i)) shown.push_back(i);
    }
  }
  return shown;
}

TEST(Film, FollowsTheTourAndEnds) {
  Tour tour = RoundOf(4);
  EXPECT_EQ(ShownBy(tour), (std::vector<size_t>{0, 1, 2, 3}));
  tour.stops[3].next->to = "s0";
  EXPECT_EQ(ShownBy(tour), (std::vector<size_t>{0, 1, 2, 3, 0})) << "a round ends where it began";
  tour.start = "s2";
  tour.stops[3].next.reset();
  EXPECT_EQ(ShownBy(tour), (std::vector<size_t>{2, 3}));
  tour.stops[2].next->to = "s2";
  EXPECT_EQ(ShownBy(tour), std::vector<size_t>{2}) << "no way from a stop to itself";
  EXPECT_TRUE(FilmOf(Tour{}, nullptr, 10).empty());
}

TEST(Film, StaysAndMovesWithoutJumps) {
  const Tour tour = RoundOf(3);
  const std::vector<FilmFrame> frames = FilmOf(tour, nullptr, 10);
  double seconds = 3.0 * 3.0;
  for (int i = 0; i < 2; ++i) {
    seconds += Route(tour.stops[static_cast<size_t>(i)].pose, tour.stops[static_cast<size_t>(i) + 1].pose, {}, nullptr).duration_s();
  }
  EXPECT_NEAR(static_cast<double>(frames.size()) / 10.0, seconds, 0.5);
  for (size_t i = 1; i < frames.size(); ++i) EXPECT_LT((frames[i].pose.eye_enu - frames[i - 1].pose.eye_enu).norm(), 0.5);
  EXPECT_EQ(frames.front().stop, 0U);
  EXPECT_EQ(frames.back().stop, 2U);
}

}  // namespace
}  // namespace skyquilt::tour
