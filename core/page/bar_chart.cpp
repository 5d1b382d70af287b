#include "core/page/bar_chart.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/page/figure.h"
#include "core/page/html.h"
#include "core/page/plot_frame.h"

namespace skyquilt::page {

namespace {

constexpr double kBarsWidth_px = 560.0, kAboveBars_px = 8.0, kBelowBars_px = 42.0;
constexpr double kRow_px = 26.0, kThickness_px = 13.0, kThinnest_px = 1.5;
constexpr double kLetter_px = 6.5;  // width of the wider letters at the page's 11.5 px
constexpr size_t kLongestLabel = 34, kLongestShown = 24;

bool StartsLetter(char c) {
  return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
}

size_t Letters(const std::string& text) {
  return static_cast<size_t>(std::count_if(text.begin(), text.end(), StartsLetter));
}

// At most `longest` letters of UTF-8; the last one is an ellipsis when letters were left out.
std::string Shortened(const std::string& text, size_t longest) {
  size_t letters = 0, cut = text.size();
  for (size_t i = 0; i < text.size(); ++i) {
    if (StartsLetter(text[i]) && ++letters == longest) cut = i;
  }
  return letters > longest ? text.substr(0, cut) + "\xE2\x80\xA6" : text;
}

std::string ShownValue(double value, const std::string& shown) {
  if (std::isnan(value) || (shown.empty() && std::isinf(value))) return FormatFixed(value, 0);
  return shown.empty() ? TickLabel(value) : shown;
}

bool HasLimit(const Bar& bar) {
  return std::isfinite(bar.limit) && bar.limit >= 0.0;
}

std::string Spoken(const Bar& bar, const BarChartOptions& options) {
  const std::string text = bar.label + ": " + ShownValue(bar.value, bar.shown);
  return HasLimit(bar) ? text + " (" + options.limit_name + ": " + ShownValue(bar.limit, bar.limit_shown) + ")" : text;
}

// Horizontal positions of zero and of the largest value; `high` is that value, 0 when all are zero.
struct BarSpan {
  double left_px = 0.0, right_px = 1.0, high = 0.0;
  double Px(double value) const { return left_px + (high > 0.0 ? value / high : 0.0) * (right_px - left_px); }
};

BarSpan SpanOf(const std::vector<Bar>& bars) {
  BarSpan span;
  size_t label = 0, shown = 0;
  for (const Bar& bar : bars) {
    label = std::max(label, Letters(bar.label));
    shown = std::max(shown, Letters(ShownValue(bar.value, bar.shown)));
    if (std::isfinite(bar.value)) span.high = std::max(span.high, bar.value);
    if (HasLimit(bar)) span.high = std::max(span.high, bar.limit);
  }
  span.left_px = 10.0 + kLetter_px * static_cast<double>(std::min(label, kLongestLabel));
  span.right_px = kBarsWidth_px - 14.0 - kLetter_px * static_cast<double>(std::min(shown, kLongestShown));
  return span;
}

std::string BarAxis(const BarSpan& span, double bottom_px, const std::string& x_label) {
  std::string html;
  for (const double tick : RoundTicks(0.0, span.high, std::max(2, static_cast<int>((span.right_px - span.left_px) / 60.0)))) {
    const double x = span.Px(tick);
    html += SvgLine("grid", x, x, kAboveBars_px, bottom_px);
    html += SvgText("tick", x, bottom_px + 17.0, Anchor::kMiddle, TickLabel(tick));
  }
  html += SvgLine("axis", span.left_px, span.left_px, kAboveBars_px, bottom_px);
  return html + SvgText("label", 0.5 * (span.left_px + span.right_px), bottom_px + 36.0, Anchor::kMiddle, x_label);
}

std::string DrawBar(const Bar& bar, double middle_px, const BarSpan& span, const BarChartOptions& options) {
  std::string html = fmt::format("<g><title>{}</title>", EscapeHtml(Spoken(bar, options)));
  html += SvgText("tick", span.left_px - 8.0, middle_px + 4.0, Anchor::kEnd, Shortened(bar.label, kLongestLabel));
  if (std::isfinite(bar.value) && bar.value > 0.0) {
    html += fmt::format("<rect class=\"bar c0\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>", span.left_px,
                        middle_px - 0.5 * kThickness_px, std::max(span.Px(bar.value) - span.left_px, kThinnest_px), kThickness_px);
  }
  if (HasLimit(bar)) {
    const double x = span.Px(bar.limit);
    html += SvgLine("limit", x, x, middle_px - 0.4 * kRow_px, middle_px + 0.4 * kRow_px);
  }
  const std::string shown = Shortened(ShownValue(bar.value, bar.shown), kLongestShown);
  return html + SvgText("mark", kBarsWidth_px - 2.0, middle_px + 4.0, Anchor::kEnd, shown) + "</g>";
}

}  // namespace

std::string BarChart(const std::vector<Bar>& bars, const BarChartOptions& options) {
  if (std::none_of(bars.begin(), bars.end(), [](const Bar& bar) { return std::isfinite(bar.value) || HasLimit(bar); })) {
    return EmptyFigure(options.title);
  }
  const BarSpan span = SpanOf(bars);
  const double bottom_px = kAboveBars_px + kRow_px * static_cast<double>(bars.size());
  std::string spoken = options.title, rows;
  for (size_t i = 0; i < bars.size(); ++i) {
    spoken += (i == 0 ? ". " : "; ") + Spoken(bars[i], options);
    rows += DrawBar(bars[i], kAboveBars_px + kRow_px * (static_cast<double>(i) + 0.5), span, options);
  }
  std::string legend;
  if (std::any_of(bars.begin(), bars.end(), HasLimit)) legend = LegendEntry("c0", options.value_name) + LegendEntry("limit", options.limit_name);
  return FigureBegin({.title = options.title, .width_px = kBarsWidth_px, .height_px = bottom_px + kBelowBars_px, .spoken = spoken}) +
         BarAxis(span, bottom_px, options.x_label) + rows + FigureEnd(legend);
}

}  // namespace skyquilt::page
