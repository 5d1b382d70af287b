#include "core/page/curve_chart.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/page/html.h"

namespace skyquilt::page {

namespace {

constexpr double kWidth = 560.0, kHeight = 300.0;
constexpr double kLeft = 52.0, kRight = 14.0, kTop = 14.0, kBottom = 42.0;

struct Axis {
  double low = 0.0, high = 1.0;
  double first_px = 0.0, last_px = 1.0;
  double Px(double value) const { return first_px + (value - low) / (high - low) * (last_px - first_px); }
};

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
  // Less than a decade: round numbers between its ends say more than the one power of ten that may lie there.
  ticks = RoundTicks(std::pow(10.0, low_log10), std::pow(10.0, high_log10), 5);
  for (double& tick : ticks) tick = std::log10(tick);
  return ticks;
}

// What is drawn of a curve, in the axes' own units (logarithms where they are logarithmic).
struct Line {
  std::vector<std::pair<double, double>> points;
  std::vector<std::string> labels;  // empty or one per point
};

Line ToLine(const Curve& curve, const ChartOptions& options) {
  Line line;
  for (size_t i = 0; i < curve.points.size(); ++i) {
    const auto [x, y] = curve.points[i];
    if (!std::isfinite(x) || !std::isfinite(y) || (options.log_x && x <= 0.0) || (options.log_y && y <= 0.0)) continue;
    line.points.emplace_back(options.log_x ? std::log10(x) : x, options.log_y ? std::log10(y) : y);
    if (!curve.labels.empty()) line.labels.push_back(curve.labels.at(i));
  }
  if (!curve.marks) line.points = Thin(line.points, options.max_points);
  return line;
}

// Grid lines, ticks and labels of both axes.
std::string Frame(const Axis& x_axis, const Axis& y_axis, const ChartOptions& options) {
  std::string html;
  for (const double tick : options.log_y ? LogTicks(y_axis.low, y_axis.high) : RoundTicks(y_axis.low, y_axis.high, 5)) {
    const double y = y_axis.Px(tick);
    html += fmt::format("<line class=\"grid\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", kLeft, kWidth - kRight, y, y);
    html += fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>", kLeft - 8.0, y + 4.0,
                        TickLabel(options.log_y ? std::pow(10.0, tick) : tick));
  }
  for (const double tick : options.log_x ? LogTicks(x_axis.low, x_axis.high) : RoundTicks(x_axis.low, x_axis.high, 6)) {
    const double x = x_axis.Px(tick);
    html += fmt::format("<line class=\"axis\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", x, x, kHeight - kBottom,
                        kHeight - kBottom + 4.0);
    html += fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>", x, kHeight - kBottom + 17.0,
                        TickLabel(options.log_x ? std::pow(10.0, tick) : tick));
  }
  html += fmt::format("<line class=\"axis\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", kLeft, kWidth - kRight, kHeight - kBottom,
                      kHeight - kBottom);
  html += fmt::format("<text class=\"label\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>", 0.5 * (kLeft + kWidth - kRight),
                      kHeight - 6.0, EscapeHtml(options.x_label));
  return html + fmt::format("<text class=\"label\" transform=\"translate(12 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
                            0.5 * (kTop + kHeight - kBottom), EscapeHtml(options.y_label));
}

std::string DrawLine(const Line& line, const Curve& curve, size_t color, const Axis& x_axis, const Axis& y_axis) {
  std::string html;
  if (curve.line) {
    html += fmt::format("<path class=\"curve c{}{}\" d=\"", color, curve.band ? " band" : curve.emphasised ? " strong" : "");
    for (size_t k = 0; k < line.points.size(); ++k) {
      html += fmt::format("{}{:.1f} {:.1f}", k == 0 ? "M" : "L", x_axis.Px(line.points[k].first), y_axis.Px(line.points[k].second));
    }
    html += fmt::format("\"><title>{}</title></path>", EscapeHtml(curve.name));
  }
  if (!curve.marks && line.points.size() != 1) return html;
  for (size_t k = 0; k < line.points.size(); ++k) {
    const double x = x_axis.Px(line.points[k].first);
    const double y = y_axis.Px(line.points[k].second);
    const std::string label = line.labels.empty() ? "" : EscapeHtml(line.labels[k]);
    html += fmt::format("<circle class=\"dot c{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"><title>{}</title></circle>", color, x, y,
                        curve.emphasised ? 4.5 : 3.0, label.empty() ? EscapeHtml(curve.name) : label);
    if (label.empty()) continue;
    // Labels of marks near the right edge stand on the left.
    const bool left = x > 0.72 * kWidth;
    html += fmt::format("<text class=\"mark\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>", left ? x - 7.0 : x + 7.0, y + 4.0,
                        left ? "end" : "start", label);
  }
  return html;
}

}  // namespace

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

std::string TickLabel(double value) {
  return std::abs(value) >= 1e4 ? FormatLarge(value) : fmt::format("{:.4g}", value);
}

std::vector<std::pair<double, double>> Thin(const std::vector<std::pair<double, double>>& points, size_t max_points) {
  if (points.size() <= max_points || max_points < 3) return points;
  std::vector<std::pair<double, double>> thinned{points.front()};
  const size_t inner = points.size() - 2;
  const size_t runs = max_points - 2;
  for (size_t run = 0; run < runs; ++run) {
    const size_t begin = 1 + run * inner / runs;
    const size_t end = 1 + (run + 1) * inner / runs;
    double x = 0.0, y = 0.0;
    for (size_t i = begin; i < end; ++i) {
      x += points[i].first;
      y += points[i].second;
    }
    const auto n = static_cast<double>(end - begin);
    thinned.emplace_back(x / n, y / n);
  }
  thinned.push_back(points.back());
  return thinned;
}

std::string CurveChart(const std::vector<Curve>& curves, const ChartOptions& options) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Axis x_axis{kInfinity, -kInfinity, kLeft, kWidth - kRight};
  Axis y_axis{kInfinity, -kInfinity, kHeight - kBottom, kTop};
  std::vector<Line> lines;
  for (const Curve& curve : curves) {
    lines.push_back(ToLine(curve, options));
    for (const auto& [x, y] : lines.back().points) {
      x_axis.low = std::min(x_axis.low, x);
      x_axis.high = std::max(x_axis.high, x);
      y_axis.low = std::min(y_axis.low, y);
      y_axis.high = std::max(y_axis.high, y);
    }
  }
  std::string html = fmt::format("<figure class=\"chart card\"><figcaption>{}</figcaption>", EscapeHtml(options.title));
  if (!(x_axis.high >= x_axis.low)) return html + "<p class=\"empty\">No data.</p></figure>\n";
  if (!options.log_x) x_axis.low = std::min(x_axis.low, 0.0);
  if (!(x_axis.high > x_axis.low)) x_axis.high = x_axis.low + 1.0;
  if (std::any_of(curves.begin(), curves.end(), [](const Curve& c) { return c.marks; })) {
    // Marks stand clear of the edges.
    const double pad = 0.04 * (x_axis.high - x_axis.low);
    x_axis.high += pad;
    if (options.log_x) x_axis.low -= pad;
  }
  const double pad = std::max(0.05 * (y_axis.high - y_axis.low), options.log_y ? 0.05 : std::min(0.5, 0.2 * std::abs(y_axis.high) + 1e-6));
  y_axis.low -= pad;
  y_axis.high += pad;

  html += fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">", kWidth, kHeight, EscapeHtml(options.title));
  html += Frame(x_axis, y_axis, options);
  std::string legend;
  for (size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].points.empty()) continue;
    html += DrawLine(lines[i], curves[i], i % 10, x_axis, y_axis);
    legend += fmt::format("<span><i class=\"c{}\"></i>{}</span>", i % 10, EscapeHtml(curves[i].name));
  }
  return html + "</svg><div class=\"legend\">" + legend + "</div></figure>\n";
}

}  // namespace skyquilt::page
