// Horizontal bars as inline SVG, coloured by the page's style sheet (light and dark).
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace skyquilt::page {

struct Bar {
  std::string label;       // shortened with an ellipsis when long; the tooltip has it in full
  double value = 0.0;      // length of the bar, linear from zero; no bar for NaN, infinity, and values of zero or below
  std::string shown = {};  // text at the end of the row, with unit; empty: the number as on the axis; NaN is always shown as an en dash
  double limit = std::numeric_limits<double>::quiet_NaN();  // drawn as a mark across the row; none unless finite and at least zero
  std::string limit_shown = {};                             // as `shown`, in the tooltip
};

struct BarChartOptions {
  std::string title;
  std::string x_label;                  // with unit
  std::string value_name = "measured";  // in the legend, which is drawn only when a bar has a limit
  std::string limit_name = "limit";
};

// A <figure> with the bars in the order given, or with the text "No data" when no bar has a finite value or limit. A very small value is drawn as a
// thin line.
std::string BarChart(const std::vector<Bar>& bars, const BarChartOptions& options);

}  // namespace skyquilt::page
