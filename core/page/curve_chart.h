// Line and point charts as inline SVG, coloured by the page's style sheet (light and dark).
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace skyquilt::page {

struct Curve {
  std::string name = {};
  std::vector<std::pair<double, double>> points = {};  // x, y; non-finite points are left out
  bool emphasised = false;
  bool line = true;
  bool marks = false;                    // a mark on every point; all points are then drawn
  bool band = false;                     // drawn wide and pale, behind the later curves
  std::vector<std::string> labels = {};  // one per point, for the marks; may be empty
  bool dots = false;                     // a small dot on every point instead of a line, all of them one path: for thousands of points
  bool hollow = false;                   // rings instead of dots
  std::optional<int> color = {};         // 0..9, of the page; empty: by the place in the list
  bool in_legend = true;
};

struct ChartOptions {
  std::string title;
  std::string x_label;  // with unit
  std::string y_label;
  bool log_y = false;                                     // points with y <= 0 are left out
  size_t max_points = 240;                                // per curve without marks; longer curves are thinned by averaging neighbours
  bool log_x = false;                                     // points with x <= 0 are left out
  std::optional<std::pair<double, double>> y_range = {};  // low, high (decimal logarithms with log_y); points beyond are drawn on the edge
  bool zero_stands_out = false;                           // draw the line at y = 0 like an axis
  std::string note = {};                                  // follows the legend
};

// A <figure>, with the text "No data" when no curve has a point.
std::string CurveChart(const std::vector<Curve>& curves, const ChartOptions& options);
// Averages runs of neighbours so that at most `max_points` remain; first and last stay in place.
std::vector<std::pair<double, double>> Thin(const std::vector<std::pair<double, double>>& points, size_t max_points);

}  // namespace skyquilt::page
