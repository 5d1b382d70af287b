#include <fmt/core.h>

#include <cmath>

#include "evaluate/page/page_parts.h"
#include "evaluate/page/sections.h"

namespace skyquilt::evaluate::page {

namespace {

struct FieldNormals {
  bool density = false, head = false;  // measured
};

std::string ScoreRow(const metrics::ClassScore& score, const FieldNormals& measured) {
  const auto metres = [](double value) { return FixedCell(value, 3, "m"); };
  const auto degrees = [](double value) { return FixedCell(value, 1, kDegree); };
  return "<tr>" + TextCell(score.name) + CountCell(score.pixels) + metres(score.depth_bias_m) + metres(score.depth_median_abs_m) +
         metres(score.depth_nmad_m) + metres(score.depth_rmse_m) + degrees(score.normal_median_deg) + degrees(score.normal_mean_deg) +
         (measured.density ? degrees(score.density_normal_median_deg) : "") + (measured.head ? degrees(score.head_normal_median_deg) : "") + "</tr>";
}

}  // namespace

std::string ClassTable(const metrics::Metrics& metrics) {
  if (metrics.classes.empty()) return "";
  const std::string lead =

      "How well roofs, walls, ground and trees of the simulated survey came out, over the covered pixels of all held-out photos. Depth is "
      "along the ray, rendered minus true: the bias is its median, NMAD is 1.4826 times the median distance from that, which is the "
      "standard deviation if errors are normal, but hardly notices outliers. The normal error is the angle between the rendered and the "
      "true surface; rough surfaces have large ones. Roads are part of the ground.";
  std::string columns =
      Headings({"Surface"}) + NumberHeadings({"Pixels", "Depth bias", "Median error", "NMAD", "RMSE", "Normal error, median", "Normal error, mean"});
  FieldNormals measured;
  for (const metrics::ClassScore& score : metrics.classes) {
    measured.density |= std::isfinite(score.density_normal_median_deg);
    measured.head |= std::isfinite(score.head_normal_median_deg);
  }
  if (measured.density) columns += NumberHeadings({"Of the density's normals, median"});
  if (measured.head) columns += NumberHeadings({"Of the predicted normals, median"});
  std::string html = BlockBegin("Surface by class", lead) + TableBegin(columns);
  for (const metrics::ClassScore& score : metrics.classes) html += ScoreRow(score, measured);
  html += kTableEnd;
  if (metrics.flat_roofs > 0) {
    html += Note(fmt::format(
        "{} flat {} {} about the plane that fits best (rms{}) and {} without the pixels that are far off (NMAD), without the rim, "
        "machines and stair housings.",
        metrics.flat_roofs, metrics.flat_roofs == 1 ? "roof is rough by" : "roofs are rough by", FormatFixed(metrics.flat_roof_rms_m, 3, "m"),
        metrics.flat_roofs == 1 ? "" : ", median over the roofs", FormatFixed(metrics.flat_roof_nmad_m, 3, "m")));
  }
  return html + "</div>\n";
}

}  // namespace skyquilt::evaluate::page
