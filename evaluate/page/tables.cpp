#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "evaluate/control/tag_positions.h"
#include "evaluate/page/geo_section.h"
#include "evaluate/page/page_parts.h"
#include "evaluate/page/report_page.h"

namespace skyquilt::evaluate::page {

namespace {

std::string StatusCell(const scene::FieldTraining* log, const partition::Block* block) {
  if (block != nullptr && block->empty)
    return fmt::format("<td class=\"status\"><span class=\"state idle\">empty</span><small>{}</small></td>", EscapeHtml(block->empty_reason));
  if (log == nullptr) return "<td class=\"status\"><span class=\"state idle\">no record</span></td>";
  if (!log->ok) return fmt::format("<td class=\"status\"><span class=\"state bad\">failed</span><small>{}</small></td>", EscapeHtml(log->reason));
  if (log->shows_context) {
    return "<td class=\"status\"><span class=\"state warn\">context</span><small>worse than the context, which is shown in its place</small></td>";
  }
  if (!log->falls.empty()) {
    return fmt::format("<td class=\"status\"><span class=\"state warn\">{}</span><small>fell apart and was taken back {}</small></td>",
                       log->ended_early ? "ended early" : "done", log->falls.size() == 1 ? "once" : fmt::format("{} times", log->falls.size()));
  }
  if (log->dropped_steps > 0) {
    return fmt::format("<td class=\"status\"><span class=\"state warn\">done</span><small>{} steps left out: not finite</small></td>",
                       FormatInteger(log->dropped_steps));
  }
  return "<td class=\"status\"><span class=\"state good\">done</span></td>";
}

std::string TrainingCells(const scene::FieldTraining* log) {
  if (log == nullptr)
    return "<td class=\"num\">\xE2\x80\x93</td><td class=\"num\">\xE2\x80\x93</td><td class=\"num\">\xE2\x80\x93</td>"
           "<td class=\"num\">\xE2\x80\x93</td><td class=\"num\">\xE2\x80\x93</td><td class=\"num\">\xE2\x80\x93</td>";
  const auto number = [](int64_t value) { return NumberCell(static_cast<double>(value), FormatLarge(static_cast<double>(value))); };
  return NumberCell(log->psnr_db, FormatFixed(log->psnr_db, 2, "dB")) + NumberCell(static_cast<double>(log->steps), FormatInteger(log->steps)) +
         NumberCell(log->seconds, ShownDuration(log->seconds)) + number(log->rays) + number(log->samples) + number(log->parameters);
}

}  // namespace

std::string BlockTable(const ReportInput& input) {
  const char* length_unit = input.survey->georeferenced ? "m" : "units";
  std::string html =
      "<div class=\"card scroll\"><table class=\"sortable\"><thead><tr><th>Block</th><th>State</th><th class=\"num\">Held-out PSNR</th><th "
      "class=\"num\">Scored pixels</th><th class=\"num\">Training PSNR</th><th class=\"num\">Steps</th><th class=\"num\">Training time</th><th "
      "class=\"num\">Rays</th><th class=\"num\">Samples</th>"
      "<th class=\"num\">Parameters</th><th class=\"num\">Size</th><th class=\"num\">Heights from, to</th><th class=\"num\">Height above "
      "ground</th><th class=\"num\">GSD</th>"
      "<th class=\"num\">Photos</th></tr></thead><tbody>";
  if (const scene::FieldTraining* context = input.training->Find("context")) {
    html += "<tr><td><b>context</b></td>" + StatusCell(context, nullptr) +
            "<td class=\"num\" data-v=\"\">\xE2\x80\x93</td><td class=\"num\" data-v=\"\">\xE2\x80\x93</td>" + TrainingCells(context);
    for (int i = 0; i < 5; ++i) html += "<td class=\"num\" data-v=\"\">\xE2\x80\x93</td>";
    html += "</tr>";
  }
  for (const partition::Block& block : input.blocks->blocks) {
    const metrics::BlockScore* score = input.metrics->FindBlock(block.name);
    const double psnr_db = score == nullptr ? kNotMeasured : score->psnr_db;
    const double pixels = score == nullptr ? kNotMeasured : static_cast<double>(score->pixels);
    const scene::FieldTraining* log = input.training->Find(block.name);
    const Eigen::Vector3d size = block.max_enu - block.min_enu;
    const double gsd_m = input.survey->georeferenced ? block.gsd_m : kNotMeasured;
    html += fmt::format("<tr id=\"block-{0}\"><td><b>{0}</b></td>", EscapeHtml(block.name)) + StatusCell(log, &block);
    html += NumberCell(psnr_db, FormatFixed(psnr_db, 2, "dB")) + NumberCell(pixels, FormatLarge(pixels)) + TrainingCells(log);
    html += NumberCell(size.x() * size.y(), fmt::format("{:.0f} \xC3\x97 {:.0f}\xE2\x80\xAF{}", size.x(), size.y(), length_unit));
    html += NumberCell(block.min_enu.z(),
                       fmt::format("{} \xE2\x80\xA6 {}", FormatFixed(block.min_enu.z(), 1), FormatFixed(block.max_enu.z(), 1, length_unit)));
    html += NumberCell(block.altitude_agl_m, FormatFixed(block.altitude_agl_m, 1, length_unit));
    html += NumberCell(gsd_m, FormatFixed(gsd_m * 100.0, 1, "cm"));
    html += NumberCell(static_cast<double>(block.photos.size()), FormatInteger(static_cast<int64_t>(block.photos.size())));
    html += "</tr>";
  }
  return html + "</tbody></table></div>\n";
}

std::string ResidualTable(const survey::Survey& survey) {
  if (!survey.georeferenced) return "";
  const std::vector<std::optional<control::TagPosition>> tags = control::TagPositions(survey);
  std::vector<size_t> tagged;
  for (size_t i = 0; i < tags.size(); ++i) {
    if (tags[i]) tagged.push_back(i);
  }
  if (tagged.empty()) return "<p class=\"card empty\">No photo has a GPS tag to compare the positions with.</p>\n";
  const auto residual_of = [&](size_t i) {
    const double residual_m = survey.photos[i].gps_residual_m;
    return std::isfinite(residual_m) ? residual_m : -1.0;
  };
  std::stable_sort(tagged.begin(), tagged.end(), [&](size_t a, size_t b) { return residual_of(a) > residual_of(b); });
  const double worst_m = residual_of(tagged.front());
  const auto row = [&](size_t i) {
    const survey::Photo& photo = survey.photos[i];
    const double bar = worst_m > 0.0 ? std::max(residual_of(i), 0.0) / worst_m : 0.0;
    std::string html = "<tr>" + TextCell(photo.name);
    html += fmt::format("<td class=\"num bar\" data-v=\"{}\"><i style=\"--share:{:.3f}\"></i>{}</td>", residual_of(i), bar,
                        FormatFixed(photo.gps_residual_m, 2, "m"));
    for (const double along_m : tags[i]->residual) html += NumberCell(along_m, FormatFixed(along_m, 2));
    html += fmt::format("<td><span class=\"state {}</span></td>", photo.gps_inlier ? "good\">used" : "bad\">not used");
    html += NumberCell(photo.agl_m, FormatFixed(photo.agl_m, 1, "m"));
    const double relative_m = photo.relative_altitude_m.value_or(kNotMeasured);
    html += NumberCell(relative_m, FormatFixed(relative_m, 1, "m")) + NumberCell(photo.flight + 1, std::to_string(photo.flight + 1));
    return html + TextCell(photo.is_test ? "testing" : "training") + "</tr>";
  };
  const std::string head =
      "<thead><tr><th>Photo</th><th class=\"num\">Residual</th><th class=\"num\">East</th><th class=\"num\">North</th><th class=\"num\">Up</th>"
      "<th>GPS tag</th><th class=\"num\">Height above ground</th><th class=\"num\">Height above take-off (XMP)</th>"
      "<th class=\"num\">Flight</th><th>Used for</th></tr></thead>";
  constexpr size_t kShown = 12;
  std::string html = "<div class=\"block\"><h3>Residuals by photo</h3><div class=\"card scroll\"><table class=\"sortable\">" + head + "<tbody>";
  for (size_t k = 0; k < tagged.size() && k < kShown; ++k) html += row(tagged[k]);
  html += "</tbody></table></div>";
  if (tagged.size() > kShown) {
    html += fmt::format("<details><summary>The other {} photos</summary><div class=\"card scroll\"><table class=\"sortable\">{}<tbody>",
                        FormatInteger(static_cast<int64_t>(tagged.size() - kShown)), head);
    for (size_t k = kShown; k < tagged.size(); ++k) html += row(tagged[k]);
    html += "</tbody></table></div></details>";
  }
  const size_t n_untagged = survey.photos.size() - tagged.size();
  if (n_untagged > 0) {
    html += fmt::format("<p class=\"note\">{} {} no usable GPS tag and {} not listed.</p>", n_untagged, n_untagged == 1 ? "photo has" : "photos have",
                        n_untagged == 1 ? "is" : "are");
  }
  return html + "</div>\n";
}

}  // namespace skyquilt::evaluate::page
