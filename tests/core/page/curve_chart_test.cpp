#include "core/page/curve_chart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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

}  // namespace
}  // namespace skyquilt::page
