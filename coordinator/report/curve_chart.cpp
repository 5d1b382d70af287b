#include "coordinator/report/curve_chart.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "coordinator/report/html.h"

namespace skyquilt::report {

namespace {

constexpr double kWidth = 560.0, kHeight = 300.0;
constexpr double kLeft = 52.0, kRight = 14.0, kTop = 14.0, kBottom = 42.0;

struct Axis {
  double low = 0.0, high = 1.0;
  double first_px = 0.0, last_px = 1.0;
  double Px(double value) const { return first_px + (value - low) / (high - low) * (last_px - first_px); }
};

// 10 for 1, 0.05 for 5 hundredths: as many digits as the number needs.
std::string TickLabel(double value) {
  return std::abs(value) >= 1e4 ? FormatLarge(value) : fmt::format("{:.4g}", value);
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
  return ticks;
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
  std::vector<std::vector<std::pair<double, double>>> lines;
  Axis x_axis{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), kLeft, kWidth - kRight};
  Axis y_axis{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), kHeight - kBottom, kTop};
  for (const Curve& curve : curves) {
    std::vector<std::pair<double, double>> points;
    for (const auto& [x, y] : curve.points) {
      if (!std::isfinite(x) || !std::isfinite(y) || (options.log_y && y <= 0.0)) continue;
      points.emplace_back(x, options.log_y ? std::log10(y) : y);
    }
    points = Thin(points, options.max_points);
    for (const auto& [x, y] : points) {
      x_axis.low = std::min(x_axis.low, x);
      x_axis.high = std::max(x_axis.high, x);
      y_axis.low = std::min(y_axis.low, y);
      y_axis.high = std::max(y_axis.high, y);
    }
    lines.push_back(std::move(points));
  }
  std::string html = fmt::format("<figure class=\"chart card\"><figcaption>{}</figcaption>", EscapeHtml(options.title));
  if (!(x_axis.high >= x_axis.low)) return html + "<p class=\"empty\">No training log was found.</p></figure>\n";
  x_axis.low = std::min(x_axis.low, 0.0);
  if (!(x_axis.high > x_axis.low)) x_axis.high = x_axis.low + 1.0;
  const double pad = std::max(0.05 * (y_axis.high - y_axis.low), options.log_y ? 0.05 : 0.5);
  y_axis.low -= pad;
  y_axis.high += pad;

  html += fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">", kWidth, kHeight, EscapeHtml(options.title));
  for (const double tick : options.log_y ? LogTicks(y_axis.low, y_axis.high) : RoundTicks(y_axis.low, y_axis.high, 5)) {
    const double y = y_axis.Px(tick);
    html += fmt::format("<line class=\"grid\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", kLeft, kWidth - kRight, y, y);
    html += fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>", kLeft - 8.0, y + 4.0,
                        TickLabel(options.log_y ? std::pow(10.0, tick) : tick));
  }
  for (const double tick : RoundTicks(x_axis.low, x_axis.high, 6)) {
    const double x = x_axis.Px(tick);
    html += fmt::format("<line class=\"axis\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", x, x, kHeight - kBottom,
                        kHeight - kBottom + 4.0);
    html +=
        fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>", x, kHeight - kBottom + 17.0, TickLabel(tick));
  }
  html += fmt::format("<line class=\"axis\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", kLeft, kWidth - kRight, kHeight - kBottom,
                      kHeight - kBottom);
  html += fmt::format("<text class=\"label\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>", 0.5 * (kLeft + kWidth - kRight),
                      kHeight - 6.0, EscapeHtml(options.x_label));
  html += fmt::format("<text class=\"label\" transform=\"translate(12 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
                      0.5 * (kTop + kHeight - kBottom), EscapeHtml(options.y_label));
  std::string legend;
  for (size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].empty()) continue;
    const size_t color = i % 10;
    html += fmt::format("<path class=\"curve c{}{}\" d=\"", color, curves[i].emphasised ? " strong" : "");
    for (size_t k = 0; k < lines[i].size(); ++k) {
      html += fmt::format("{}{:.1f} {:.1f}", k == 0 ? "M" : "L", x_axis.Px(lines[i][k].first), y_axis.Px(lines[i][k].second));
    }
    html += fmt::format("\"><title>{}</title></path>", EscapeHtml(curves[i].name));
    if (lines[i].size() == 1) {
      html += fmt::format("<circle class=\"dot c{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"/>", color, x_axis.Px(lines[i][0].first),
                          y_axis.Px(lines[i][0].second));
    }
    legend += fmt::format("<span><i class=\"c{}\"></i>{}</span>", color, EscapeHtml(curves[i].name));
  }
  return html + "</svg><div class=\"legend\">" + legend + "</div></figure>\n";
}

}  // namespace skyquilt::report
