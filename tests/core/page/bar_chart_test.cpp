#include "core/page/bar_chart.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/count_of.h"
#include "tests/support/not_finite.h"

namespace skyquilt::page {
namespace {

// The numbers of an attribute of all elements of a class, in order.
std::vector<double> Numbers(const std::string& html, const std::string& element, const std::string& attribute) {
  std::vector<double> numbers;
  for (size_t at = html.find(element); at != std::string::npos; at = html.find(element, at + 1)) {
    const std::string name = " " + attribute + "=\"";
    numbers.push_back(std::stod(html.substr(html.find(name, at) + name.size())));
  }
  return numbers;
}

std::vector<double> BarLengths(const std::string& html) {
  return Numbers(html, "<rect class=\"bar", "width");
}

TEST(BarChart, IsAsLongAsItsValue) {
  const std::string html = BarChart({{"a", 1.0}, {"b", 4.0}, {"c", 2.0}}, {"t", "x"});
  const std::vector<double> lengths = BarLengths(html);
  ASSERT_EQ(lengths.size(), 3U);
  EXPECT_NEAR(lengths[1], 4.0 * lengths[0], 0.3);  // lengths are written to a tenth of a pixel
  EXPECT_NEAR(lengths[1], 2.0 * lengths[2], 0.2);
  EXPECT_EQ(CountOf(html, "legend"), 0U) << "without limits there is nothing to explain";
}

TEST(BarChart, SaysNoDataWithoutAnyNumber) {
  EXPECT_NE(BarChart({}, {"t", "x"}).find("No data"), std::string::npos);
  EXPECT_NE(BarChart({{"a", kNan}, {"b", kInfinity}}, {"t", "x"}).find("No data"), std::string::npos);
}

TEST(BarChart, DrawsNoBarForZeroAndNan) {
  const std::string zeros = BarChart({{"a", 0.0}, {"b", -0.0}}, {"t", "x"});
  EXPECT_EQ(zeros.find("No data"), std::string::npos);
  EXPECT_TRUE(BarLengths(zeros).empty());
  EXPECT_EQ(zeros.find("nan"), std::string::npos);
  const std::string mixed = BarChart({{"a", kNan, "never shown"}, {"b", kInfinity}, {"c", -1.0, "-1 s"}, {"d", 2.0}}, {"t", "x"});
  EXPECT_EQ(BarLengths(mixed).size(), 1U);
  EXPECT_NE(mixed.find(">\xE2\x80\x93</text>"), std::string::npos) << "an en dash for NaN";
  EXPECT_NE(mixed.find(">\xE2\x88\x9E</text>"), std::string::npos);
  EXPECT_NE(mixed.find(">-1 s</text>"), std::string::npos);
  EXPECT_EQ(mixed.find("never shown"), std::string::npos);
  EXPECT_EQ(mixed.find("nan"), std::string::npos);
  EXPECT_EQ(mixed.find("inf"), std::string::npos);
}

TEST(BarChart, StaysInsideItsBoxBesideHugeValuesAndLongTexts) {
  const std::string label(200, 'W');
  const std::string html = BarChart({{label, 1e12, std::string(90, '8')}, {"b", 1e-6, "", 2e12}, {"c", 5e-324}}, {"t", "x"});
  const std::vector<double> starts = Numbers(html, "<rect class=\"bar", "x");
  const std::vector<double> lengths = BarLengths(html);
  ASSERT_EQ(lengths.size(), 3U);
  for (size_t i = 0; i < lengths.size(); ++i) {
    EXPECT_GT(starts[i], 0.0);
    EXPECT_GE(lengths[i], 1.0) << "small but visible";
    EXPECT_LT(starts[i] + lengths[i], 560.0);
  }
  EXPECT_GT(lengths[0], 50.0);
  EXPECT_NEAR(Numbers(html, "<line class=\"limit\"", "x1").at(0), starts[0] + 2.0 * lengths[0], 0.2);
  EXPECT_EQ(html.find(">" + label + "<"), std::string::npos) << "cut in the drawing";
  EXPECT_NE(html.find("<title>" + label), std::string::npos) << "in full in the tooltip";
}

TEST(BarChart, CutsBetweenLetters) {
  std::string label;
  for (int i = 0; i < 60; ++i) label += "\xC3\xA4";
  const std::string html = BarChart({{label, 1.0}}, {"t", "x"});
  EXPECT_NE(html.find("\xC3\xA4\xE2\x80\xA6</text>"), std::string::npos);
  EXPECT_EQ(html.find("\xEF\xBF\xBD"), std::string::npos) << "half a letter";
}

TEST(BarChart, MarksLimits) {
  const std::string html = BarChart({{"a", 1.0, "1 s", 2.0, "2 s"}, {"b", 1.0, "", kNan}, {"c", kNan, "", 1.5}, {"d", 1.0, "", -1.0}},
                                    {.title = "t", .x_label = "x", .value_name = "seen", .limit_name = "allowed"});
  EXPECT_EQ(CountOf(html, "<line class=\"limit\""), 2U);
  EXPECT_NE(html.find("<title>a: 1 s (allowed: 2 s)</title>"), std::string::npos) << html;
  EXPECT_NE(html.find("<title>b: 1</title>"), std::string::npos) << html;
  EXPECT_NE(html.find("<title>c: \xE2\x80\x93 (allowed: 1.5)</title>"), std::string::npos) << html;
  EXPECT_NE(html.find("</i>seen</span>"), std::string::npos);
  EXPECT_NE(html.find("</i>allowed</span>"), std::string::npos);
}

TEST(BarChart, IsEscapedAndHasTextForScreenReaders) {
  const std::string html = BarChart({{"<a>", 1.0, "\"1\"", 2.0}}, {.title = "A & B", .x_label = "<x>", .value_name = "<v>", .limit_name = "<l>"});
  for (const char* raw : {"<a>", "<x>", "<v>", "<l>", "\"1\"", "A & B"}) EXPECT_EQ(html.find(raw), std::string::npos) << raw;
  EXPECT_NE(html.find("aria-label=\"A &amp; B. &lt;a&gt;: &quot;1&quot; (&lt;l&gt;: 2)\""), std::string::npos) << html;
}

}  // namespace
}  // namespace skyquilt::page
