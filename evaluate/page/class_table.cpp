#include <fmt/core.h>

#include <cmath>

#include "evaluate/page/page_parts.h"
#include "evaluate/page/report_page.h"

namespace skyquilt::evaluate::page {

namespace {

struct FieldNormals {
  bool density = false, head = false;  // measured
};

std::string ScoreRow(const metrics::ClassScore& score, const FieldNormals& measured) {
  const auto metres = [](double value) { return NumberCell(value, FormatFixed(value, 3, "m")); };
  const auto degrees = [](double value) { return NumberCell(value, FormatFixed(value, 1, kDegree)); };
  return "<tr>" + TextCell(score.name) + NumberCell(static_cast<double>(score.pixels), FormatInteger(score.pixels)) + metres(score.depth_bias_m) +
         metres(score.depth_median_abs_m) + metres(score.depth_nmad_m) + metres(score.depth_rmse_m) + degrees(score.normal_median_deg) +
         degrees(score.normal_mean_deg) + (measured.density ? degrees(score.density_normal_median_deg) : "") +
         (measured.head ? degrees(score.head_normal_median_deg) : "") + "</tr>";
}

}  // namespace

std::string ClassTable(const metrics::Metrics& metrics) {
  if (metrics.classes.empty()) return "";
  std::string html =
      "<div class=\"block\"><h3>Surface by class</h3><p class=\"lead\">How well roofs, walls, ground and trees of the simulated survey came out, "
      "over "
      "the covered pixels of all held-out photos. Depth is along the ray, rendered minus true: the bias is its median, NMAD is 1.4826 times the "
      "median "
      "distance from that, which is the standard deviation if errors are normal, but hardly notices outliers. The normal error is the angle between "
      "the rendered and the true surface; rough surfaces have large ones. Roads are part of the ground.</p>"
      "<div class=\"card scroll\"><table class=\"sortable\"><thead><tr><th>Surface</th><th class=\"num\">Pixels</th><th class=\"num\">Depth bias</th>"
      "<th class=\"num\">Median error</th><th class=\"num\">NMAD</th><th class=\"num\">RMSE</th><th class=\"num\">Normal error, median</th>"
      "<th class=\"num\">Normal error, mean</th>";
  FieldNormals measured;
  for (const metrics::ClassScore& score : metrics.classes) {
    measured.density |= std::isfinite(score.density_normal_median_deg);
    measured.head |= std::isfinite(score.head_normal_median_deg);
  }
  if (measured.density) html += "<th class=\"num\">Of the density's normals, median</th>";
  if (measured.head) html += "<th class=\"num\">Of the predicted normals, median</th>";
  html += "</tr></thead><tbody>";
  for (const metrics::ClassScore& score : metrics.classes) html += ScoreRow(score, measured);
  html += "</tbody></table></div>";
  if (metrics.flat_roofs > 0) {
    html += fmt::format(
        "<p class=\"note\">{} flat {} {} about the plane that fits best (rms{}) and {} without the pixels that are far off (NMAD), without the rim, "
        "machines and stair housings.</p>",
        metrics.flat_roofs, metrics.flat_roofs == 1 ? "roof is rough by" : "roofs are rough by", FormatFixed(metrics.flat_roof_rms_m, 3, "m"),
        metrics.flat_roofs == 1 ? "" : ", median over the roofs", FormatFixed(metrics.flat_roof_nmad_m, 3, "m"));
  }
  return html + "</div>\n";
}

}  // namespace skyquilt::evaluate::page
