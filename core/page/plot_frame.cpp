#include "core/page/plot_frame.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/page/figure.h"
#include "core/page/html.h"

namespace skyquilt::page {

std::vector<double> RoundTicks(double low, double high, int count) {
  if (!(high > low) || !std::isfinite(low) || !std::isfinite(high) || count < 1) return {};
  const double raw = (high - low) / count;
  const double magnitude = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10.0 * magnitude;
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * magnitude >= raw * 0.999) {
      step = factor * magnitude;
      break;
    }
  }
  std::vector<double> ticks;
  for (double index = std::ceil(low / step - 1e-9); index * step <= high + 1e-9 * step; index += 1.0)
    ticks.push_back(index * step + 0.0);  // + 0.0 turns -0 into 0
  return ticks;
}

std::vector<double> LogTicks(double low_log10, double high_log10) {
  std::vector<double> ticks;
  const bool dense = high_log10 - low_log10 < 2.5;
  for (int decade = static_cast<int>(std::floor(low_log10)); decade <= static_cast<int>(std::ceil(high_log10)); ++decade) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (!dense && factor != 1.0) continue;
      const double tick = decade + std::log10(factor);
      if (tick >= low_log10 && tick <= high_log10) ticks.push_back(tick);
    }
  }
  if (ticks.size() >= 3 || high_log10 - low_log10 >= 1.0) return ticks;
  // In less than a decade there is at most one power of ten: use round numbers instead.
  ticks = RoundTicks(std::pow(10.0, low_log10), std::pow(10.0, high_log10), 5);
  for (double& tick : ticks) tick = std::log10(tick);
  return ticks;
}

std::string TickLabel(double value) {
  return std::abs(value) >= 1e4 ? FormatLarge(value) : fmt::format("{:.4g}", value);
}

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
