#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>

#include "tests/support/error_of.h"
#include "tests/viewer/queries/analytic_field.h"
#include "viewer/queries/polygon_cells.h"

namespace skyquilt::viewer {
namespace {

using Polygon = std::vector<Eigen::Vector2d>;

const Polygon kSquare = {{-10, -10}, {10, -10}, {10, 10}, {-10, 10}};

VolumeRequest VolumeOf(const Polygon& polygon, VolumeBase base, double height_m = 0.0) {
  VolumeRequest request;
  request.id = 5;
  request.polygon_enu = polygon;
  request.base = base;
  request.base_height_m = height_m;
  return request;
}

double Value(const nlohmann::json& answer, const char* key) {
  return answer.at(key).get<double>();
}

// 12 m wide and 4 m high in the middle, on ground that slopes by 0.1: 12^2 * 4 / 3 = 192 m3.
std::optional<double> Pyramid(double x, double y) {
  const double r = std::max(std::abs(x), std::abs(y));
  return 0.1 * x + 2.0 + std::max(0.0, 4.0 * (1.0 - r / 6.0));
}
std::optional<double> Slope(double x, double) {
  return 0.1 * x + 2.0;
}

TEST(Volume, OfAPyramidOverThePlaneOfTheCorners) {
  const nlohmann::json answer = AnswerOf(*MakeVolume(VolumeOf(kSquare, VolumeBase::kPlane)), AccessTo(FieldOf(Above(Pyramid), 0.03)));
  EXPECT_EQ(answer["type"], "volume");
  EXPECT_EQ(answer["id"], 5);
  EXPECT_NEAR(Value(answer, "net_m3"), 192.0, 0.2);
  EXPECT_NEAR(Value(answer, "cut_m3"), 192.0, 0.2);
  EXPECT_NEAR(Value(answer, "fill_m3"), 0.0, 0.01);
  EXPECT_NEAR(Value(answer, "plan_area_m2"), 400.0, 1e-9);
  EXPECT_NEAR(Value(answer, "base_mean_m"), 2.0, 1e-3);
  EXPECT_EQ(Value(answer, "filled"), 1.0);
  EXPECT_NEAR(Value(answer, "cells") * std::pow(Value(answer, "cell_m"), 2), 400.0, 4.0);
  // 400 independent square metres, and four corners at whose mean height the plane passes.
  EXPECT_NEAR(Value(answer, "sigma_m3"), 400.0 * std::hypot(0.03 / 20.0, 0.03 / 2.0), 0.2);
  // Ground around the pyramid, and its four faces, which slope by 2/3 and along x also by the ground's slope.
  const double faces = 36.0 * (2.0 * std::sqrt(1.0 + 4.0 / 9.0 + 0.01) + std::hypot(1.0, 2.0 / 3.0 + 0.1) + std::hypot(1.0, 2.0 / 3.0 - 0.1));
  EXPECT_NEAR(Value(answer, "surface_area_m2"), (400.0 - 144.0) * std::sqrt(1.01) + faces, 0.5);
}

TEST(Volume, OfABoxOverALevelBase) {
  const auto box = [](double x, double y) -> std::optional<double> { return std::abs(x) < 3.02 && std::abs(y) < 4.01 ? 5.0 : 1.0; };
  const double solid = 6.04 * 8.02 * 4.0;
  // The base is below the ground by 1.5 m, then above it by half a metre.
  const nlohmann::json low = AnswerOf(*MakeVolume(VolumeOf(kSquare, VolumeBase::kHeight, -0.5)), AccessTo(FieldOf(Above(box))));
  EXPECT_NEAR(Value(low, "net_m3"), 400.0 * 1.5 + solid, 10.0);
  EXPECT_LT(Value(low, "sigma_m3"), 2.0);
  EXPECT_EQ(Value(low, "base_mean_m"), -0.5);
  const nlohmann::json middle = AnswerOf(*MakeVolume(VolumeOf(kSquare, VolumeBase::kHeight, 1.5)), AccessTo(FieldOf(Above(box))));
  EXPECT_NEAR(Value(middle, "cut_m3"), 6.04 * 8.02 * 3.5, 9.0);
  EXPECT_NEAR(Value(middle, "fill_m3"), (400.0 - 6.04 * 8.02) * 0.5, 2.0);
  EXPECT_NEAR(Value(middle, "net_m3"), Value(middle, "cut_m3") - Value(middle, "fill_m3"), 1e-9);
}

TEST(Volume, OverTheLowestCorner) {
  const nlohmann::json answer = AnswerOf(*MakeVolume(VolumeOf(kSquare, VolumeBase::kLowest)), AccessTo(FieldOf(Above(Pyramid), 0.03)));
  // The western corners are at 1 m, the mean ground at 2 m.
  EXPECT_NEAR(Value(answer, "base_mean_m"), 1.0, 0.001);
  EXPECT_NEAR(Value(answer, "net_m3"), 192.0 + 400.0, 0.3);
}

TEST(Volume, BetweenTwoSurveys) {
  const RayCaster now = FieldOf(Above(Pyramid), 0.03), before = FieldOf(Above(Slope), 0.04);
  const nlohmann::json grown = AnswerOf(*MakeVolume(VolumeOf(kSquare, VolumeBase::kBefore)), AccessTo(now, before));
  EXPECT_NEAR(Value(grown, "net_m3"), 192.0, 0.2);
  EXPECT_NEAR(Value(grown, "sigma_m3"), 400.0 * 0.05 / 20.0, 0.05) << "both spreads";
  EXPECT_NEAR(Value(grown, "base_mean_m"), 2.0, 0.01);
  const nlohmann::json dug = AnswerOf(*MakeVolume(VolumeOf(kSquare, VolumeBase::kBefore)), AccessTo(before, now));
  EXPECT_NEAR(Value(dug, "fill_m3"), 192.0, 0.2);
  EXPECT_NEAR(Value(dug, "net_m3"), -192.0, 0.2);
  EXPECT_THROW(AnswerOf(*MakeVolume(VolumeOf(kSquare, VolumeBase::kBefore)), AccessTo(now)), BadMessage);
  VolumeRequest itself = VolumeOf(kSquare, VolumeBase::kBefore);
  itself.project = Which::kBefore;
  EXPECT_THROW(MakeVolume(itself), BadMessage);
}

TEST(Volume, OfTheEarlierSurvey) {
  VolumeRequest request = VolumeOf(kSquare, VolumeBase::kPlane);
  request.project = Which::kBefore;
  EXPECT_NEAR(Value(AnswerOf(*MakeVolume(request), AccessTo(FieldOf(Above(Slope)), FieldOf(Above(Pyramid)))), "net_m3"), 192.0, 0.2);
}

TEST(Volume, DoesNotDependOnTheDirectionOfTheOutline) {
  const Polygon house = {{-9, -8}, {9.3, -8.7}, {9.9, 7}, {0.4, 10}, {-9.5, 6.6}};
  Polygon reversed = house;
  std::reverse(reversed.begin(), reversed.end());
  const FieldAccess access = AccessTo(FieldOf(Above(Pyramid), 0.03));
  const nlohmann::json a = AnswerOf(*MakeVolume(VolumeOf(house, VolumeBase::kPlane)), access);
  const nlohmann::json b = AnswerOf(*MakeVolume(VolumeOf(reversed, VolumeBase::kPlane)), access);
  EXPECT_NEAR(Value(a, "net_m3"), 192.0, 0.3);
  EXPECT_GT(Value(a, "plan_area_m2"), 0.0);
  for (const char* key : {"net_m3", "plan_area_m2", "surface_area_m2", "sigma_m3", "cells"}) EXPECT_NEAR(Value(a, key), Value(b, key), 1e-6) << key;
}

TEST(Volume, OfALayerIsExactForAnyOutline) {
  const FieldAccess access = AccessTo(FieldOf(Above([](double, double) { return 3.0; })));
  const Polygon star = {{0, 7}, {-1.1, 1.3}, {-6, 1}, {-1.7, -1}, {-3, -6.2}, {0.1, -2}, {4, -6}, {1.6, -0.6}, {6.3, 2}, {1.2, 1.5}};
  const nlohmann::json answer = AnswerOf(*MakeVolume(VolumeOf(star, VolumeBase::kHeight, 1.0)), access);
  EXPECT_NEAR(Value(answer, "net_m3"), 2.0 * std::abs(SignedArea(star)), 1e-4);
  EXPECT_NEAR(Value(answer, "surface_area_m2"), std::abs(SignedArea(star)), 1e-6);
  EXPECT_NEAR(Value(answer, "sigma_m3"), 0.0, 1e-4);
  // Smaller than a cell of twice the GSD, and large.
  for (const double scale : {0.004, 12.0}) {
    Polygon scaled = star;
    for (Eigen::Vector2d& corner : scaled) corner *= scale;
    const nlohmann::json other = AnswerOf(*MakeVolume(VolumeOf(scaled, VolumeBase::kHeight, 1.0)), access);
    EXPECT_NEAR(Value(other, "net_m3"), 2.0 * scale * scale * std::abs(SignedArea(star)), 1e-4 * scale * scale);
    EXPECT_LE(Value(other, "cells"), 250'000.0);
    EXPECT_GT(Value(other, "cells"), 300.0);
  }
}

TEST(Volume, ScalesUpWhatHoldsNoSurface) {
  const auto holey = [](double x, double y) -> std::optional<double> {
    if (std::sin(3.0 * x) * std::sin(2.0 * y) > 0.5) return {};
    return 4.0;
  };
  const nlohmann::json answer = AnswerOf(*MakeVolume(VolumeOf(kSquare, VolumeBase::kHeight, 1.0)), AccessTo(FieldOf(Above(holey))));
  EXPECT_LT(Value(answer, "filled"), 0.9);
  EXPECT_GT(Value(answer, "filled"), 0.7);
  EXPECT_NEAR(Value(answer, "net_m3"), 1200.0, 0.01);
  EXPECT_NEAR(Value(answer, "surface_area_m2"), 400.0, 0.01);
  // A hole in something uneven makes the result less certain.
  const auto cut = [](double x, double y) -> std::optional<double> { return y > 5.0 ? std::optional<double>() : Pyramid(x, y); };
  const nlohmann::json whole = AnswerOf(*MakeVolume(VolumeOf(kSquare, VolumeBase::kHeight, 1.0)), AccessTo(FieldOf(Above(Pyramid))));
  const nlohmann::json part = AnswerOf(*MakeVolume(VolumeOf(kSquare, VolumeBase::kHeight, 1.0)), AccessTo(FieldOf(Above(cut))));
  EXPECT_NEAR(Value(part, "filled"), 0.75, 0.01);
  EXPECT_GT(Value(part, "sigma_m3"), 10.0 * Value(whole, "sigma_m3"));
  EXPECT_LT(std::abs(Value(part, "net_m3") - Value(whole, "net_m3")), 2.0 * Value(part, "sigma_m3"));
}

TEST(Volume, NoisyCornersCountByTheirMedian) {
  // A thin mast beside each corner.
  const auto masts = [](double x, double y) -> std::optional<double> {
    const bool mast = std::abs(std::abs(x) - 10.05) < 0.01 && std::abs(std::abs(y) - 10.05) < 0.01;
    return mast ? 20.0 : 1.0;
  };
  for (const VolumeBase base : {VolumeBase::kPlane, VolumeBase::kLowest}) {
    const nlohmann::json answer = AnswerOf(*MakeVolume(VolumeOf(kSquare, base)), AccessTo(FieldOf(Above(masts))));
    EXPECT_NEAR(Value(answer, "net_m3"), 0.0, 0.01);
  }
}

TEST(Volume, SaysWhyThereIsNone) {
  const auto refusal = [](const VolumeRequest& request, const Surface& surface) -> std::string {
    return ErrorOf<BadMessage>([&] { AnswerOf(*MakeVolume(request), AccessTo(FieldOf(surface))); });
  };
  const Surface nothing = Above([](double, double) -> std::optional<double> { return {}; });
  const Surface middle =
      Above([](double x, double) -> std::optional<double> { return std::abs(x) < 5.0 ? std::optional<double>(1.0) : std::nullopt; });
  EXPECT_NE(refusal(VolumeOf(kSquare, VolumeBase::kPlane), middle).find("three corners"), std::string::npos);
  EXPECT_NE(refusal(VolumeOf(kSquare, VolumeBase::kLowest), middle).find("no corner"), std::string::npos);
  EXPECT_NE(refusal(VolumeOf(kSquare, VolumeBase::kHeight), nothing).find("no surface within"), std::string::npos);
  EXPECT_EQ(refusal(VolumeOf(kSquare, VolumeBase::kHeight), middle), "");
  EXPECT_NE(refusal(VolumeOf({{0, 0}, {10, 10}, {10, 0}, {0, 10}}, VolumeBase::kHeight), middle).find("crosses"), std::string::npos);
  // Three corners with a surface, all on one line.
  EXPECT_NE(refusal(VolumeOf({{-4, 0}, {0, 0}, {4, 0}, {9, 9}, {-9, 9}}, VolumeBase::kPlane), middle).find("almost on a line"), std::string::npos);
}

TEST(PolygonCells, AreNeverTooMany) {
  // A sliver over a thousand kilometres, and a comb whose teeth are as wide as a row's rounding.
  const PolygonCells sliver({{0, 0}, {1e6, 1e6}, {1e6, 1e6 + 0.2}}, 0.1);
  EXPECT_LE(sliver.size(), kMaxPolygonCells);
  Polygon comb = {{0, -0.1}};
  for (int i = 0; i < 31; ++i) {
    comb.push_back({i + 1e-3, 1e5});
    comb.push_back({i + 0.5, -0.05});
  }
  comb.push_back({31, -0.1});
  EXPECT_LE(PolygonCells(comb, 0.01).size(), kMaxPolygonCells);
  EXPECT_LE(PolygonCells({{-1e7, -1e7}, {1e7, -1e7}, {0, 1e7}}, 0.1).size(), kMaxPolygonCells);
}

RC_GTEST_PROP(PolygonCells, AreInsideAndKnowTheirNeighbours, ()) {
  // A star around a far place: each corner in its own direction.
  const int n = *rc::gen::inRange(3, 20);
  Polygon polygon;
  for (int i = 0; i < n; ++i) {
    const double r = *rc::gen::inRange(30, 100) * 0.1, angle = 2.0 * std::numbers::pi * i / n;
    polygon.push_back(Eigen::Vector2d(-4000.0, 7000.0) + r * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  const PolygonCells cells(polygon, 0.3);
  const double area = SignedArea(polygon);
  RC_ASSERT(area > 0.0);
  RC_ASSERT(std::abs(static_cast<double>(cells.size()) * cells.cell_m() * cells.cell_m() - area) < 1.5 * cells.cell_m() * Perimeter(polygon));
  for (size_t i = 0; i < cells.size(); ++i) {
    const Eigen::Vector2d centre = cells.Centre(i);
    if (const auto right = cells.Right(i)) RC_ASSERT((cells.Centre(*right) - centre - Eigen::Vector2d(cells.cell_m(), 0)).norm() < 1e-6);
    if (const auto above = cells.Above(i)) RC_ASSERT((cells.Centre(*above) - centre - Eigen::Vector2d(0, cells.cell_m())).norm() < 1e-6);
    bool inside = false, on_edge = false;
    for (size_t k = 0; k < polygon.size(); ++k) {
      const Eigen::Vector2d a = polygon[k] - centre, b = polygon[(k + 1) % polygon.size()] - centre;
      const double turn = a.x() * b.y() - a.y() * b.x();
      on_edge = on_edge || std::abs(turn) < 1e-6;
      if ((a.y() > 0.0) != (b.y() > 0.0) && (turn > 0.0) == (b.y() > a.y())) inside = !inside;
    }
    RC_ASSERT(inside || on_edge);
  }
}

}  // namespace
}  // namespace skyquilt::viewer
