#include "core/page/html.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/not_finite.h"

namespace skyquilt::page {
namespace {

TEST(EscapeHtml, FileNamesCannotBecomeMarkup) {
  EXPECT_EQ(EscapeHtml("<b>.jpg"), "&lt;b&gt;.jpg");
  EXPECT_EQ(EscapeHtml("a&b \"c\" 'd'"), "a&amp;b &quot;c&quot; &#39;d&#39;");
  EXPECT_EQ(EscapeHtml(""), "");
}

TEST(EscapeHtml, KeepsUtf8AndRepairsTheRest) {
  EXPECT_EQ(EscapeHtml("M\xC3\xBChle \xE5\x9C\xB0\xF0\x9F\x8F\xA0"), "M\xC3\xBChle \xE5\x9C\xB0\xF0\x9F\x8F\xA0");
  EXPECT_EQ(EscapeHtml("M\xFChle"), "M\xEF\xBF\xBDhle");            // Latin-1
  EXPECT_EQ(EscapeHtml("x\xE5\x9C"), "x\xEF\xBF\xBD\xEF\xBF\xBD");  // cut short
  EXPECT_EQ(EscapeHtml("\xC0\xBC"), "\xEF\xBF\xBD\xEF\xBF\xBD");    // overlong '<'
  EXPECT_EQ(EscapeHtml(std::string_view("a\0b\x1b", 4)), "ab");
}

TEST(FormatFixed, IsADashForNan) {
  EXPECT_EQ(FormatFixed(kNan, 2, "dB"), "\xE2\x80\x93");
  EXPECT_EQ(FormatFixed(28.126, 2, "dB"),
            "28.13\xE2\x80\xAF"
            "dB");
  EXPECT_EQ(FormatFixed(-0.001, 2), "0.00");
  EXPECT_EQ(FormatFixed(0.31, 2, "\xC2\xB0"), "0.31\xC2\xB0") << "no space before the degree sign";
  EXPECT_EQ(FormatFixed(-1.5, 1),
            "\xE2\x88\x92"
            "1.5");
  EXPECT_EQ(FormatFixed(std::numeric_limits<double>::infinity(), 2, "dB"), "\xE2\x88\x9E");
}

TEST(FormatCounts, UseUnits) {
  EXPECT_EQ(FormatInteger(0), "0");
  EXPECT_EQ(FormatInteger(999), "999");
  EXPECT_EQ(FormatInteger(1234567),
            "1\xE2\x80\xAF"
            "234\xE2\x80\xAF"
            "567");
  EXPECT_EQ(FormatInteger(-1234),
            "-1\xE2\x80\xAF"
            "234");
  EXPECT_EQ(FormatBytes(0), "\xE2\x80\x93");
  EXPECT_EQ(FormatBytes(int64_t{3} << 29), "1.50\xE2\x80\xAFGiB");
  EXPECT_EQ(FormatLarge(2.5e6), "2.50\xE2\x80\xAFM");
  EXPECT_EQ(FormatLarge(999.9), "1.00\xE2\x80\xAFk");
  EXPECT_EQ(FormatLarge(12.0), "12");
  EXPECT_EQ(FormatPercent(0.934), "93.4\xE2\x80\xAF%");
}

TEST(FormatDuration, SpellsUnits) {
  constexpr const char* kSpace = "\xE2\x80\xAF";
  const auto with_spaces = [&](std::string text) {
    for (size_t at = text.find('_'); at != std::string::npos; at = text.find('_')) text.replace(at, 1, kSpace);
    return text;
  };
  EXPECT_EQ(FormatDuration(24.49), with_spaces("24.5_s"));
  EXPECT_EQ(FormatDuration(624.0), with_spaces("10_min 24_s"));
  EXPECT_EQ(FormatDuration(7500.0), with_spaces("2_h 05_min"));
  EXPECT_EQ(FormatDuration(kNan), "\xE2\x80\x93");
}

TEST(NumberCell, SortsByTheNumberNotByItsText) {
  EXPECT_EQ(NumberCell(2.5, "two"), "<td class=\"num\" data-v=\"2.5\">two</td>");
  EXPECT_EQ(NumberCell(kNan, "-"), "<td class=\"num\" data-v=\"\">-</td>");
}

}  // namespace
}  // namespace skyquilt::page
