#include "core/page/plot_frame.h"

#include <gtest/gtest.h>

#include "core/page/figure.h"

namespace skyquilt::page {
namespace {

TEST(PlotFrame, TheEndsOfTheAxesAreAtItsCorners) {
  const PlotFrame frame{.x = {.low = -2.0, .high = 2.0}, .y = {.low = 10.0, .high = 30.0}};
  EXPECT_DOUBLE_EQ(frame.X(-2.0), PlotFrame::kLeft_px);
  EXPECT_DOUBLE_EQ(frame.X(2.0), frame.right_px());
  EXPECT_DOUBLE_EQ(frame.Y(10.0), frame.bottom_px());
  EXPECT_DOUBLE_EQ(frame.Y(20.0), 0.5 * (frame.bottom_px() + PlotFrame::kTop_px)) << "larger values are higher up";
}

TEST(PlotAxis, GrowsAroundItsValues) {
  PlotAxis axis{.low = 0.0, .high = 1.0};
  axis.Include(3.0);
  axis.Include(0.5);
  axis.Pad(0.25);
  EXPECT_DOUBLE_EQ(axis.low, -0.25);
  EXPECT_DOUBLE_EQ(axis.high, 3.25);
}

TEST(PlotBegin, ZeroStandsOutWhereAskedFor) {
  PlotFrame frame{.title = "t", .y = {.low = -1.0, .high = 1.0}};
  const std::string zero = SvgLine("axis", PlotFrame::kLeft_px, frame.right_px(), frame.Y(0.0), frame.Y(0.0));
  EXPECT_EQ(PlotBegin(frame).find(zero), std::string::npos);
  frame.zero_stands_out = true;
  EXPECT_NE(PlotBegin(frame).find(zero), std::string::npos);
}

TEST(PlotBegin, WritesRoundNumbersAtALogarithmicAxis) {
  const std::string html = PlotBegin({.title = "t", .x = {.low = 0.0, .high = 5.0, .logarithmic = true}});
  for (const char* label : {">1<", ">10<", ">1000<", ">100\xE2\x80\xAFk<"}) EXPECT_NE(html.find(label), std::string::npos) << label;
}

TEST(Figure, IsEscapedAndClosed) {
  const std::string html = FigureBegin({.title = "<t>", .css_class = "wide", .spoken = "\"s\""}) + SvgText("tick", 1.0, 2.0, Anchor::kEnd, "<x>") +
                           SvgPath("curve", "M0 0", "<p>") + FigureEnd(LegendEntry("c0", "<l>"));
  for (const char* raw : {"<t>", "<x>", "<p>", "<l>", "\"s\""}) EXPECT_EQ(html.find(raw), std::string::npos) << raw;
  EXPECT_NE(html.find("<figure class=\"chart card wide\"><figcaption>&lt;t&gt;</figcaption><svg"), std::string::npos) << html;
  EXPECT_NE(html.find("aria-label=\"&quot;s&quot;\""), std::string::npos) << html;
  EXPECT_TRUE(html.ends_with("</div></figure>\n")) << html;
  EXPECT_EQ(FigureEnd(), "</svg></figure>\n") << "nothing to explain";
}

}  // namespace
}  // namespace skyquilt::page
