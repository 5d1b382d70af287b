
#include "core/page/curve_chart.h"
#include "evaluate/page/geo_section.h"
#include "evaluate/page/page_parts.h"

namespace skyquilt::evaluate::page {

std::string DirectionsTable(const survey::Survey& survey) {
  const survey::DominantDirections& directions = survey.directions;
  if (directions.lines == 0) return "";
  Curve curve{.name = "lines", .points = {}, .in_legend = false};
  for (size_t degree = 0; degree < directions.histogram.size(); ++degree) {
    curve.points.emplace_back(static_cast<double>(degree) + 0.5, 100.0 * directions.histogram[degree]);
  }
  const std::string lead =
      "From " + FormatInteger(directions.lines) + " straight lines in " + FormatInteger(directions.photos) +
      " photos. Yaw is counter-clockwise from east; the four directions of a right angle count as one, so it ends at 90\xC2\xB0.";
  std::string html = "<h3>Directions of buildings and streets</h3>" + Lead(lead) + "<div class=\"chart-grid\">" +
                     CurveChart({curve}, {.title = "Length of lines by yaw", .x_label = "yaw (degrees)", .y_label = "share of the length (%)"});
  if (directions.modes.empty()) return html + Note("No direction stands out.") + "</div>";
  html += TableBegin(NumberHeadings({"Yaw", "Uncertainty", "Spread", "Share of the length", "Lines"}));
  for (const survey::YawMode& mode : directions.modes) {
    html += "<tr>" + FixedCell(mode.yaw_deg, 1, kDegree) + FixedCell(mode.sigma_deg, 2, kDegree) + FixedCell(mode.spread_deg, 1, kDegree) +
            PercentCell(mode.share) + CountCell(mode.lines) + "</tr>";
  }
  return html + kTableEnd + "</div>\n";
}

}  // namespace skyquilt::evaluate::page
