#include "core/page/curve_chart.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/page/figure.h"
#include "core/page/html.h"
#include "core/page/plot_frame.h"

namespace skyquilt::page {

namespace {

// The points of a curve that are drawn, in axis units (logarithms on logarithmic axes).
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
  if (!curve.marks && !curve.dots) line.points = Thin(line.points, options.max_points);
  return line;
}

// A frame that contains all lines; empty when there are no points.
std::optional<PlotFrame> FrameOf(const std::vector<Line>& lines, bool marks, const ChartOptions& options) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  PlotFrame frame{.title = options.title,
                  .x = {.label = options.x_label, .low = kInfinity, .high = -kInfinity, .ticks = 6, .logarithmic = options.log_x},
                  .y = {.label = options.y_label, .low = kInfinity, .high = -kInfinity, .logarithmic = options.log_y},
                  .zero_stands_out = options.zero_stands_out};
  for (const Line& line : lines) {
    for (const auto& [x, y] : line.points) {
      frame.x.Include(x);
      frame.y.Include(y);
    }
  }
  if (!(frame.x.high >= frame.x.low)) return std::nullopt;
  if (!options.log_x) frame.x.low = std::min(frame.x.low, 0.0);
  if (!(frame.x.high > frame.x.low)) frame.x.high = frame.x.low + 1.0;
  if (marks) {
    // Keeps marks away from the edges.
    const double pad = 0.04 * (frame.x.high - frame.x.low);
    frame.x.high += pad;
    if (options.log_x) frame.x.low -= pad;
  }
  if (options.y_range) {
    std::tie(frame.y.low, frame.y.high) = *options.y_range;
    return frame;
  }
  frame.y.Pad(std::max(0.05 * (frame.y.high - frame.y.low), options.log_y ? 0.05 : std::min(0.5, 0.2 * std::abs(frame.y.high) + 1e-6)));
  return frame;
}

// A dot is a line of no length with round ends.
std::string DrawDots(const PlotFrame& frame, const Line& line, const Curve& curve, const std::string& color) {
  constexpr size_t kMany = 600;
  std::string steps;
  for (const auto& [x, y] : line.points) {
    steps += curve.hollow ? fmt::format("M{:.1f} {:.1f}m-3 0a3 3 0 1 0 6 0a3 3 0 1 0-6 0", frame.X(x), frame.Y(y))
                          : fmt::format("M{:.1f} {:.1f}h0", frame.X(x), frame.Y(y));
  }
  return SvgPath(fmt::format("{} {}{}", curve.hollow ? "rings" : "dots", color, line.points.size() > kMany ? " many" : ""), steps, curve.name);
}

std::string DrawLine(const PlotFrame& frame, const Line& line, const Curve& curve, const std::string& color) {
  std::string html;
  if (curve.line) {
    std::string steps;
    for (const auto& [x, y] : line.points) steps += fmt::format("{}{:.1f} {:.1f}", steps.empty() ? "M" : "L", frame.X(x), frame.Y(y));
    html += SvgPath(fmt::format("curve {}{}", color, curve.band ? " band" : curve.emphasised ? " strong" : ""), steps, curve.name);
  }
  if (!curve.marks && line.points.size() != 1) return html;
  for (size_t k = 0; k < line.points.size(); ++k) {
    const double x = frame.X(line.points[k].first);
    const double y = frame.Y(line.points[k].second);
    const std::string label = line.labels.empty() ? "" : line.labels[k];
    html += fmt::format("<circle class=\"dot {}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"><title>{}</title></circle>", color, x, y,
                        curve.emphasised ? 4.5 : 3.0, EscapeHtml(label.empty() ? curve.name : label));
    if (label.empty()) continue;
    // Labels of marks near the right edge are placed on the left.
    const bool left = x > 0.72 * frame.width_px;
    html += SvgText("mark", left ? x - 7.0 : x + 7.0, y + 4.0, left ? Anchor::kEnd : Anchor::kStart, label);
  }
  return html;
}

}  // namespace

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
  std::vector<Line> lines;
  lines.reserve(curves.size());
  for (const Curve& curve : curves) lines.push_back(ToLine(curve, options));
  const bool marks = std::any_of(curves.begin(), curves.end(), [](const Curve& c) { return c.marks; });
  const std::optional<PlotFrame> frame = FrameOf(lines, marks, options);
  if (!frame) return EmptyFigure(options.title);
  std::string html = PlotBegin(*frame), legend;
  for (size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].points.empty()) continue;
    const Curve& curve = curves[i];
    const std::string color = fmt::format("c{}", curve.color.value_or(static_cast<int>(i % 10)));
    for (auto& point : lines[i].points) point.second = std::clamp(point.second, frame->y.low, frame->y.high);
    html += curve.dots ? DrawDots(*frame, lines[i], curve, color) : DrawLine(*frame, lines[i], curve, color);
    if (curve.in_legend) legend += LegendEntry(curve.dots ? color + (curve.hollow ? " ring" : " disc") : color, curve.name);
  }
  if (!options.note.empty()) legend += "<span>" + EscapeHtml(options.note) + "</span>";
  return html + FigureEnd(legend);
}

}  // namespace skyquilt::page
