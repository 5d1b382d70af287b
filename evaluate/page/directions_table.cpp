#include <fmt/core.h>

#include "core/page/curve_chart.h"
#include "core/page/html.h"
#include "evaluate/page/geo_section.h"
#include "evaluate/page/page_parts.h"

namespace skyquilt::evaluate {

std::string DirectionsTable(const survey::Survey& survey) {
  const survey::DominantDirections& directions = survey.directions;
  if (directions.lines == 0) return "";
  page::Curve curve{.name = "lines", .points = {}, .in_legend = false};
  for (size_t degree = 0; degree < directions.histogram.size(); ++degree) {
    curve.points.emplace_back(static_cast<double>(degree) + 0.5, 100.0 * directions.histogram[degree]);
  }
  std::string html = "<h3>Directions of buildings and streets</h3><p class=\"lead\">From " + page::FormatInteger(directions.lines) +
                     " straight lines in " + page::FormatInteger(directions.photos) +
                     " photos. Yaw is counter-clockwise from east; the four directions of a right angle count as one, so it ends at 90\xC2\xB0.</p>" +
                     page::CurveChart({curve}, {.title = "Length of lines by yaw", .x_label = "yaw (degrees)", .y_label = "share of the length (%)"});
  if (directions.modes.empty()) return html + "<p class=\"note\">No direction stands out.</p>";
  html +=
      "<div class=\"scroll\"><table><thead><tr><th>yaw</th><th>uncertainty</th><th>spread</th><th>share of the "
      "length</th><th>lines</th></tr></thead><tbody>";
  for (const survey::YawMode& mode : directions.modes) {
    html += "<tr>" + page::NumberCell(mode.yaw_deg, page::FormatFixed(mode.yaw_deg, 1, kDegree)) +
            page::NumberCell(mode.sigma_deg, page::FormatFixed(mode.sigma_deg, 2, kDegree)) +
            page::NumberCell(mode.spread_deg, page::FormatFixed(mode.spread_deg, 1, kDegree)) +
            page::NumberCell(mode.share, page::FormatPercent(mode.share)) + page::NumberCell(mode.lines, page::FormatInteger(mode.lines)) + "</tr>";
  }
  return html + "</tbody></table></div>";
}

}  // namespace skyquilt::evaluate
