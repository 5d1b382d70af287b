#include "evaluate/page/control_section.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "evaluate/control/control_summary.h"
#include "evaluate/page/page_parts.h"

namespace skyquilt::evaluate::page {

namespace {

using survey::ControlPointFit;
using survey::ControlUse;

std::string LeadOf(const survey::ControlFit& fit) {
  std::string html;
  if (fit.placed) {
    html += "The survey's place on Earth comes from the control points";
    html += fit.adjusted ? ", in a bundle adjustment of photos, lenses and points. " : ", by a similarity transform: the poses were not adjusted. ";
  } else {
    html += "The survey's place on Earth comes from GPS tags; the points are only compared with it. ";
  }
  html += "Coordinates are from " + EscapeHtml(fit.file);
  if (!fit.crs.empty()) html += ", " + EscapeHtml(fit.crs);
  if (!fit.heights.empty()) html += " (heights: " + EscapeHtml(fit.heights) + ")";
  return Lead(
      html +
      ". Errors are estimated less given position. Control points made the result, so their errors flatter it; check points and points that are "
      "left out in turn did not.");
}

std::string MetresCell(double metres) {
  return FixedCell(metres, 3, "m");
}

std::string StatisticsRows(const char* name, const control::ControlErrors& errors) {
  if (errors.n == 0) return "";
  constexpr std::array<const char*, 3> kAxes = {"east", "north", "up"};
  std::string html;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const int n = axis < 2 ? errors.n : errors.n_heights;
    if (n == 0) continue;
    html += fmt::format("<tr><td>{}, {}</td>", name, kAxes[static_cast<size_t>(axis)]) + CountCell(n) + MetresCell(errors.mean_m[axis]) +
            MetresCell(errors.sigma_m[axis]) + MetresCell(errors.rmse_m[axis]) + "<td class=\"num\"></td></tr>";
  }
  const auto total = [&](const char* what, int n, double rmse_m, double rmse_gsd) {
    html += fmt::format("<tr><td><b>{}, {}</b></td>", name, what) + CountCell(n) + "<td class=\"num\"></td><td class=\"num\"></td>" +
            MetresCell(rmse_m) + FixedCell(rmse_gsd, 2, "GSD") + "</tr>";
  };
  total("horizontal", errors.n, errors.rmse_horizontal_m, errors.rmse_horizontal_gsd);
  if (errors.n_heights > 0) total("vertical", errors.n_heights, errors.rmse_vertical_m, errors.rmse_vertical_gsd);
  return html;
}

std::string StatisticsTable(const control::ControlSummary& summary) {
  const std::string rows = StatisticsRows("Check points", summary.check) + StatisticsRows("Control points left out in turn", summary.left_out) +
                           StatisticsRows("Control points", summary.control);
  if (rows.empty()) return EmptyCard("No point has an error: fewer than two usable marks each.");
  return TableBegin(Headings({"Errors"}) + NumberHeadings({"Points", "Mean", "Standard deviation", "RMSE", "RMSE in GSD"}), "") + rows + kTableEnd +
         "\n";
}

std::string SystematicFinding(const control::ControlErrors& errors) {
  constexpr std::array<const char*, 3> kAxes = {"east", "north", "up"};
  const std::array<bool, 3> by_rule = errors.Systematic(), sure = errors.SystematicBeyondChance();
  std::string html;
  for (size_t axis = 0; axis < 3; ++axis) {
    if (!by_rule[axis]) continue;
    html += fmt::format("<li>The mean error {} ({}) is more than a quarter of its RMSE: {}.</li>", kAxes[axis],
                        FormatFixed(errors.mean_m[static_cast<Eigen::Index>(axis)], 3, "m"),
                        sure[axis] ? "a systematic error" : "with so few points this may be chance");
  }
  return html.empty() ? "<li>No mean error is more than a quarter of its RMSE: no sign of a systematic error.</li>" : html;
}

std::string Verdict(const control::ControlSummary& summary) {
  std::string html = "<div class=\"card prose verdicts\"><h3>What the errors say</h3><ul>";
  if (const control::ControlErrors* const judged = summary.Judged()) {
    const char* const whose = judged == &summary.check ? "check points" : "control points left out in turn";
    if (const std::optional<bool> within = judged->WithinRule()) {
      html += fmt::format("<li>The {} are {} the usual limits of {:.0f} GSD horizontally and {:.0f} GSD vertically.</li>", whose,
                          *within ? "within" : "<b>not within</b>", control::kMostHorizontal_gsd, control::kMostVertical_gsd);
    }
    html += SystematicFinding(*judged);
  }
  if (summary.n_rejected > 0) {
    html += fmt::format("<li><b>{} control point{} the others and {} not used</b>: see the table.</li>", summary.n_rejected,
                        summary.n_rejected == 1 ? " contradicts" : "s contradict", summary.n_rejected == 1 ? "was" : "were");
  }
  if (summary.n_unseen > 0) html += fmt::format("<li>{} of the points have fewer than two usable marks.</li>", summary.n_unseen);
  return html + "<li>" + control::AccuracyStatement(summary) + "</li></ul></div>\n";
}

std::string PointTable(const survey::ControlFit& fit) {
  std::string html =
      TableBegin(Headings({"Point", "Use"}) + NumberHeadings({"East", "North", "Up", "Error east", "north", "up", "1 \xCF\x83 east", "north", "up",
                                                              "Left out: horizontal", "up", "Pixel error", "Marks used", "GSD"}));
  for (const ControlPointFit& point : fit.points) {
    const auto n_used = std::count_if(point.marks.begin(), point.marks.end(), [](const survey::ControlMarkFit& mark) { return mark.used; });
    const bool rejected = point.use == ControlUse::kRejected;
    const char* const use = survey::NameOf(point.use);
    html += "<tr>" + TextCell(point.label) + (rejected ? fmt::format("<td><b>{}</b></td>", use) : TextCell(use));
    for (const Eigen::Vector3d& v : {point.given_in_enu, point.error_m, point.sigma_m}) {
      for (const double value : {v.x(), v.y(), v.z()}) html += MetresCell(value);
    }
    html += MetresCell(point.left_out_error_m.head<2>().norm()) + MetresCell(point.left_out_error_m.z()) + FixedCell(point.error_px, 2, "px");
    html += NumberCell(static_cast<double>(n_used), fmt::format("{} of {}", n_used, point.marks.size()));
    html += NumberCell(point.gsd_m, FormatFixed(100.0 * point.gsd_m, 1, "cm")) + "</tr>";
  }
  return html + kTableEnd + "\n";
}

// The picture with its cross and ring.
std::string Drawing(const control::MarkPicture& picture, const std::string& file, const char* what) {
  const Eigen::Vector2d& at = picture.marked_px;
  std::string svg = fmt::format(
      "<svg viewBox=\"0 0 {0} {1}\" role=\"img\" aria-label=\"{2}\"><image href=\"{3}\" width=\"{0}\" height=\"{1}\"/><path class=\"cross\" "
      "d=\"M{4:.2f} {5:.2f}h12M{6:.2f} {7:.2f}v12\"/>",
      picture.width, picture.height, what, EscapeHtml(file), at.x() - 6.0, at.y(), at.x(), at.y() - 6.0);
  if (picture.projected_px) {
    const Eigen::Vector2d& seen = *picture.projected_px;
    svg += fmt::format("<path class=\"way\" d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}\"/><circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"4\"/>", at.x(), at.y(),
                       seen.x(), seen.y(), seen.x(), seen.y());
  }
  return svg + "</svg>";
}

}  // namespace

std::string MarkPictures(const survey::ControlFit& fit, const std::vector<control::MarkPicture>& pictures) {
  if (pictures.empty()) return "";
  std::string html = "<h3>Marks</h3>" +
                     Note(
                         "Each mark in its photo and in the scene as that camera would see it, 64 pixels of the photo across. The cross is the mark, "
                         "the ring the projection of the estimated point.") +
                     "<div class=\"mark-list\">";
  for (size_t i = 0; i < pictures.size();) {
    const ControlPointFit& point = fit.points[pictures[i].point];
    html += fmt::format("<div class=\"card marks\"><h3>{} <span class=\"note\">{}</span></h3><div class=\"crops\">", EscapeHtml(point.label),
                        survey::NameOf(point.use));
    for (const size_t first = pictures[i].point; i < pictures.size() && pictures[i].point == first; ++i) {
      const survey::ControlMarkFit& mark = point.marks[pictures[i].mark];
      html += fmt::format("<figure class=\"crop{}\">", mark.used ? "" : " unused") + Drawing(pictures[i], pictures[i].photo, "Photo");
      if (!pictures[i].render.empty()) html += Drawing(pictures[i], pictures[i].render, "Render");
      html += fmt::format("<figcaption>{}<br>{}{}</figcaption></figure>", EscapeHtml(mark.photo), FormatFixed(mark.error_px, 2, "px"),
                          mark.used ? "" : ", not used");
    }
    html += "</div></div>\n";
  }
  return html + "</div>\n";
}

std::string ControlSection(const ReportInput& input) {
  const survey::ControlFit& fit = input.survey->control;
  if (fit.points.empty()) return "";
  const control::ControlSummary summary = control::SummariseControl(fit);
  return SectionBegin("control", "Control points") + LeadOf(fit) + StatisticsTable(summary) + Verdict(summary) + ControlMap(*input.survey) +
         PointTable(fit) + MarkPictures(fit, input.mark_pictures) + "</section>\n";
}

}  // namespace skyquilt::evaluate::page
