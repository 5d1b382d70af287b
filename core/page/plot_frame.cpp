#include "core/page/plot_frame.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/page/figure.h"
#include "core/page/html.h"
#include "core/page/ticks.h"

namespace skyquilt::page {

namespace {

std::vector<double> TicksOf(const PlotAxis& axis) {
  return axis.logarithmic ? LogTicks(axis.low, axis.high) : RoundTicks(axis.low, axis.high, axis.ticks);
}

std::string LabelAt(const PlotAxis& axis, double tick) {
  return TickLabel(axis.logarithmic ? std::pow(10.0, tick) : tick);
}

}  // namespace

void PlotAxis::Include(double value) {
  low = std::min(low, value);
  high = std::max(high, value);
}

void PlotAxis::Pad(double by) {
  low -= by;
  high += by;
}

std::string PlotBegin(const PlotFrame& frame) {
  constexpr double kLeft_px = PlotFrame::kLeft_px;
  const double right_px = frame.right_px(), bottom_px = frame.bottom_px();
  std::string html = FigureBegin({.title = frame.title, .width_px = frame.width_px, .height_px = frame.height_px, .css_class = frame.css_class});
  for (const double tick : TicksOf(frame.y)) {
    const double y = frame.Y(tick);
    html += SvgLine(frame.zero_stands_out && tick == 0.0 ? "axis" : "grid", kLeft_px, right_px, y, y);
    html += SvgText("tick", kLeft_px - 8.0, y + 4.0, Anchor::kEnd, LabelAt(frame.y, tick));
  }
  for (const double tick : TicksOf(frame.x)) {
    const double x = frame.X(tick);
    html += SvgLine("axis", x, x, bottom_px, bottom_px + 4.0);
    html += SvgText("tick", x, bottom_px + 17.0, Anchor::kMiddle, LabelAt(frame.x, tick));
  }
  html += SvgLine("axis", kLeft_px, right_px, bottom_px, bottom_px);
  html += SvgText("label", 0.5 * (kLeft_px + right_px), frame.height_px - 6.0, Anchor::kMiddle, frame.x.label);
  return html + fmt::format("<text class=\"label\" transform=\"translate(12 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
                            0.5 * (PlotFrame::kTop_px + bottom_px), EscapeHtml(frame.y.label));
}

}  // namespace skyquilt::page
