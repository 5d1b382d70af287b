// Horizontal bars as inline SVG, coloured by the page's style sheet (light and dark).
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace skyquilt::page {

struct Bar {
  std::string label;       // cut with an ellipsis when long; in full where the mouse rests
  double value = 0.0;      // length from zero, linear; no bar for NaN, infinity and what is not above zero
  std::string shown = {};  // at the end of the row, with its unit; empty: the number as on the axis; NaN is always an en dash
  double limit = std::numeric_limits<double>::quiet_NaN();  // to compare with, as a mark across the row; none unless finite and at least zero
  std::string limit_shown = {};
};

struct BarChartOptions {
  std::string title;
  std::string x_label;                  // with unit
  std::string value_name = "measured";  // in the legend, which stands only where there is a limit
  std::string limit_name = "limit";
};

// A <figure>, bars in the order given; says "no data" inside when no bar has a finite value or limit. What is small beside a large value is drawn as
// a sliver; its number stands at the end of the row.
std::string BarChart(const std::vector<Bar>& bars, const BarChartOptions& options);

}  // namespace skyquilt::page
