#include "core/page/curve_chart.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/count_of.h"

namespace skyquilt::page {
namespace {

TEST(Thin, KeepsTheEndsAndTheMean) {
  std::vector<std::pair<double, double>> points;
  points.reserve(5000);
  for (int i = 0; i < 5000; ++i) points.emplace_back(i, i % 2 == 0 ? 1.0 : 3.0);
  const auto thinned = Thin(points, 100);
  EXPECT_EQ(thinned.size(), 100U);
  EXPECT_EQ(thinned.front(), points.front());
  EXPECT_EQ(thinned.back(), points.back());
  for (size_t i = 1; i + 1 < thinned.size(); ++i) EXPECT_NEAR(thinned[i].second, 2.0, 0.05);
  EXPECT_EQ(Thin(points, 10000).size(), points.size());
}

// The labels of the ticks along x, as numbers.
std::vector<double> TicksAlongX(const std::string& chart) {
  const std::string mark = "text-anchor=\"middle\">";
  std::vector<double> ticks;
  for (size_t at = chart.find("class=\"tick\""); at != std::string::npos; at = chart.find("class=\"tick\"", at + 1)) {
    const size_t anchor = chart.find(mark, at);
    if (anchor != std::string::npos && anchor < chart.find("</text>", at)) ticks.push_back(std::stod(chart.substr(anchor + mark.size())));
  }
  return ticks;
}

TEST(CurveChart, HasSeveralTicksOnALogarithmicAxisOfAnyLength) {
  for (const double factor : {1.2, 1.5, 2.0, 4.0, 9.0, 30.0, 300.0, 1e5, 1e9}) {
    for (const double low : {0.003, 0.7, 4.0, 170.0, 8000.0}) {
      const std::string chart = CurveChart({{"a", {{low, 1.0}, {low * factor, 2.0}}}}, {.title = "t", .x_label = "x", .y_label = "y", .log_x = true});
      const std::vector<double> ticks = TicksAlongX(chart);
      EXPECT_GE(ticks.size(), 2U) << low << " to " << low * factor;
      EXPECT_LE(ticks.size(), 12U) << low << " to " << low * factor;
    }
  }
}

TEST(CurveChart, SurvivesEmptySingleAndNonFiniteData) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(CurveChart({}, {}).find("No data"), std::string::npos);
  EXPECT_NE(CurveChart({{"a", {{nan, 1.0}, {1.0, nan}}}}, {}).find("No data"), std::string::npos);
  const std::string single = CurveChart({{"a", {{1.0, 5.0}}}}, {"t", "x", "y", true});
  EXPECT_NE(single.find("<circle"), std::string::npos);
  EXPECT_EQ(single.find("nan"), std::string::npos);
  EXPECT_EQ(CurveChart({{"a", {{0.0, 0.0}, {1.0, -1.0}, {2.0, 0.1}}}}, {"t", "x", "y", true}).find("nan"), std::string::npos);
  EXPECT_NE(CurveChart({{"<i>", {{0.0, 1.0}, {1.0, 2.0}}}}, {}).find("&lt;i&gt;"), std::string::npos);
}

TEST(CurveChart, DrawsThousandsOfDotsAsOnePathAndLeavesNoneOut) {
  Curve curve{.name = "up <m>", .dots = true, .color = 7};
  for (int i = 0; i < 5000; ++i) curve.points.emplace_back(i, i % 7);
  curve.points.emplace_back(1.0, std::numeric_limits<double>::quiet_NaN());
  Curve rest{.name = "rest", .points = {{0.0, 1.0}}, .dots = true, .hollow = true, .in_legend = false};
  const std::string chart = CurveChart({curve, rest}, {.title = "t", .x_label = "x", .y_label = "y", .note = "a < b"});
  EXPECT_EQ(CountOf(chart, "<path class=\"dots c7 many\""), 1U);
  EXPECT_EQ(CountOf(chart, "h0"), 5000U);
  EXPECT_EQ(CountOf(chart, "<path class=\"rings c1\""), 1U);
  EXPECT_EQ(CountOf(chart, "<circle"), 0U);
  EXPECT_EQ(CountOf(chart, "<i class=\"c7 disc\"></i>up &lt;m&gt;"), 1U);
  EXPECT_EQ(CountOf(chart, "</i>rest"), 0U);
  EXPECT_EQ(CountOf(chart, "<span>a &lt; b</span>"), 1U);
  EXPECT_EQ(CountOf(chart, "nan"), 0U);
}

TEST(CurveChart, PointsBeyondTheRangeStandOnTheEdge) {
  const Curve curve{.name = "a", .points = {{0.0, 0.0}, {1.0, 1000.0}, {2.0, -1000.0}}, .dots = true};
  const std::string chart =
      CurveChart({curve}, {.title = "t", .x_label = "x", .y_label = "y", .y_range = std::pair(-5.0, 5.0), .zero_stands_out = true});
  // The drawing is 300 pixels high; the axes begin 14 pixels below its top and end 42 pixels above its bottom.
  EXPECT_NE(chart.find(" 136.0h0M"), std::string::npos) << chart;
  EXPECT_NE(chart.find(" 14.0h0M"), std::string::npos) << chart;
  EXPECT_NE(chart.find(" 258.0h0\""), std::string::npos) << chart;
  EXPECT_NE(chart.find("<line class=\"axis\" x1=\"52.0\" x2=\"546.0\" y1=\"136.0\" y2=\"136.0\""), std::string::npos) << chart;
}

}  // namespace
}  // namespace skyquilt::page
