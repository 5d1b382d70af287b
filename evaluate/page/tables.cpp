#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "evaluate/control/tag_positions.h"
#include "evaluate/page/geo_section.h"
#include "evaluate/page/page_parts.h"
#include "evaluate/page/sections.h"

namespace skyquilt::evaluate::page {

namespace {

std::string StatusOf(const scene::FieldTraining* log, const partition::Block* block) {
  const auto state = [](const char* kind, const char* word, const std::string& why) { return State(kind, word) + "<small>" + why + "</small>"; };
  if (block != nullptr && block->empty) return state("idle", "empty", EscapeHtml(block->empty_reason));
  if (log == nullptr) return State("idle", "no record");
  if (!log->ok) return state("bad", "failed", EscapeHtml(log->reason));
  if (log->shows_context) return state("warn", "context", "worse than the context, which is shown in its place");
  if (!log->falls.empty()) {
    return state("warn", log->ended_early ? "ended early" : "done",
                 "fell apart and was taken back " + (log->falls.size() == 1 ? "once" : fmt::format("{} times", log->falls.size())));
  }
  if (log->dropped_steps > 0) return state("warn", "done", FormatInteger(log->dropped_steps) + " steps left out: not finite");
  return State("good", "done");
}

// Cells without a figure.
std::string EmptyCells(int n) {
  std::string html;
  for (int i = 0; i < n; ++i) html += FixedCell(kNotMeasured, 0);
  return html;
}

std::string TrainingCells(const scene::FieldTraining* log) {
  if (log == nullptr)
    return "<td class=\"num\">\xE2\x80\x93</td><td class=\"num\">\xE2\x80\x93</td><td class=\"num\">\xE2\x80\x93</td><td "
           "class=\"num\">\xE2\x80\x93</td><td class=\"num\">\xE2\x80\x93</td><td class=\"num\">\xE2\x80\x93</td>";
  const auto number = [](int64_t value) { return NumberCell(static_cast<double>(value), FormatLarge(static_cast<double>(value))); };
  return FixedCell(log->psnr_db, 2, "dB") + CountCell(log->steps) + NumberCell(log->seconds, ShownDuration(log->seconds)) + number(log->rays) +
         number(log->samples) + number(log->parameters);
}

}  // namespace

std::string BlockTable(const ReportInput& input) {
  const char* length_unit = input.survey->georeferenced ? "m" : "units";
  std::string html = TableBegin(Headings({"Block", "State"}) +
                                NumberHeadings({"Held-out PSNR", "Scored pixels", "Training PSNR", "Steps", "Training time", "Rays", "Samples",
                                                "Parameters", "Size", "Heights from, to", "Height above ground", "GSD", "Photos"}));
  if (const scene::FieldTraining* context = input.training->Find("context")) {
    html += "<tr><td><b>context</b></td><td class=\"status\">" + StatusOf(context, nullptr) + "</td>" + EmptyCells(2) + TrainingCells(context) +
            EmptyCells(5) + "</tr>";
  }
  for (const partition::Block& block : input.blocks->blocks) {
    const metrics::BlockScore* score = input.metrics->FindBlock(block.name);
    const double psnr_db = score == nullptr ? kNotMeasured : score->psnr_db;
    const double pixels = score == nullptr ? kNotMeasured : static_cast<double>(score->pixels);
    const scene::FieldTraining* log = input.training->Find(block.name);
    const Eigen::Vector3d size = block.max_enu - block.min_enu;
    const double gsd_m = input.survey->georeferenced ? block.gsd_m : kNotMeasured;
    html +=
        fmt::format("<tr id=\"block-{0}\"><td><b>{0}</b></td>", EscapeHtml(block.name)) + "<td class=\"status\">" + StatusOf(log, &block) + "</td>";
    html += FixedCell(psnr_db, 2, "dB") + NumberCell(pixels, FormatLarge(pixels)) + TrainingCells(log);
    html += NumberCell(size.x() * size.y(), fmt::format("{:.0f} \xC3\x97 {:.0f}\xE2\x80\xAF{}", size.x(), size.y(), length_unit));
    html += NumberCell(block.min_enu.z(),
                       fmt::format("{} \xE2\x80\xA6 {}", FormatFixed(block.min_enu.z(), 1), FormatFixed(block.max_enu.z(), 1, length_unit)));
    html += FixedCell(block.altitude_agl_m, 1, length_unit) + NumberCell(gsd_m, FormatFixed(gsd_m * 100.0, 1, "cm")) +
            CountCell(static_cast<int64_t>(block.photos.size())) + "</tr>";
  }
  return html + kTableEnd + "\n";
}

std::string ResidualTable(const survey::Survey& survey) {
  if (!survey.georeferenced) return "";
  const std::vector<std::optional<control::TagPosition>> tags = control::TagPositions(survey);
  std::vector<size_t> tagged;
  for (size_t i = 0; i < tags.size(); ++i) {
    if (tags[i]) tagged.push_back(i);
  }
  if (tagged.empty()) return EmptyCard("No photo has a GPS tag to compare the positions with.") + "\n";
  const auto residual_of = [&](size_t i) {
    const double residual_m = survey.photos[i].gps_residual_m;
    return std::isfinite(residual_m) ? residual_m : -1.0;
  };
  std::stable_sort(tagged.begin(), tagged.end(), [&](size_t a, size_t b) { return residual_of(a) > residual_of(b); });
  const double worst_m = residual_of(tagged.front());
  const auto row = [&](size_t i) {
    const survey::Photo& photo = survey.photos[i];
    const double bar = worst_m > 0.0 ? std::max(residual_of(i), 0.0) / worst_m : 0.0;
    std::string html = "<tr>" + TextCell(photo.name) + BarCell(residual_of(i), bar, FormatFixed(photo.gps_residual_m, 2, "m"));
    for (const double along_m : tags[i]->residual) html += FixedCell(along_m, 2);
    html += "<td>" + (photo.gps_inlier ? State("good", "used") : State("bad", "not used")) + "</td>" + FixedCell(photo.agl_m, 1, "m");
    const double relative_m = photo.relative_altitude_m.value_or(kNotMeasured);
    html += FixedCell(relative_m, 1, "m") + NumberCell(photo.flight + 1, std::to_string(photo.flight + 1));
    return html + TextCell(photo.is_test ? "testing" : "training") + "</tr>";
  };
  const std::string begin = TableBegin(Headings({"Photo"}) + NumberHeadings({"Residual", "East", "North", "Up"}) + Headings({"GPS tag"}) +
                                       NumberHeadings({"Height above ground", "Height above take-off (XMP)", "Flight"}) + Headings({"Used for"}));
  constexpr size_t kShown = 12;
  std::string html = BlockBegin("Residuals by photo") + begin;
  for (size_t k = 0; k < tagged.size() && k < kShown; ++k) html += row(tagged[k]);
  html += kTableEnd;
  if (tagged.size() > kShown) {
    html += fmt::format("<details><summary>The other {} photos</summary>", FormatInteger(static_cast<int64_t>(tagged.size() - kShown))) + begin;
    for (size_t k = kShown; k < tagged.size(); ++k) html += row(tagged[k]);
    html += std::string(kTableEnd) + "</details>";
  }
  const size_t n_untagged = survey.photos.size() - tagged.size();
  if (n_untagged > 0) {
    html += Note(fmt::format("{} {} no usable GPS tag and {} not listed.", n_untagged, n_untagged == 1 ? "photo has" : "photos have",
                             n_untagged == 1 ? "is" : "are"));
  }
  return html + "</div>\n";
}

}  // namespace skyquilt::evaluate::page
