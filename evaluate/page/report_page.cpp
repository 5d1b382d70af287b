#include "evaluate/page/report_page.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/errors.h"
#include "core/page/curve_chart.h"
#include "core/page/page_frame.h"
#include "evaluate/page/buildings_section.h"
#include "evaluate/page/control_section.h"
#include "evaluate/page/geo_section.h"
#include "evaluate/page/ortho_section.h"
#include "evaluate/page/page_parts.h"
#include "evaluate/page/sections.h"

namespace skyquilt::evaluate::page {

namespace {

std::string Toggle(const char* layer, const std::string& label, const char* mark) {
  return fmt::format("<label><input type=\"checkbox\" data-layer=\"layer-{}\" checked><i class=\"{}\"></i>{}</label>", layer, mark, label);
}

std::string BlockBars(const ReportInput& input) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const metrics::BlockScore& block : input.metrics->blocks) {
    if (!std::isfinite(block.psnr_db)) continue;
    low = std::min(low, block.psnr_db);
    high = std::max(high, block.psnr_db);
  }
  std::string html = "<div class=\"card bars\"><h3>Held-out PSNR per block</h3>";
  if (input.metrics->blocks.empty() || !std::isfinite(low)) return html + "<p class=\"empty\">No block was scored.</p></div>";
  // Bars start a little below the worst block: differences of tenths of a decibel are what one looks for.
  const double base = std::max(0.0, std::floor(low - 0.35 * std::max(high - low, 1.0)));
  std::vector<const metrics::BlockScore*> order;
  for (const metrics::BlockScore& block : input.metrics->blocks) order.push_back(&block);
  std::stable_sort(order.begin(), order.end(), [](const metrics::BlockScore* a, const metrics::BlockScore* b) {
    return std::isfinite(a->psnr_db) && (!std::isfinite(b->psnr_db) || a->psnr_db > b->psnr_db);
  });
  html += "<div class=\"rows\">";
  for (const metrics::BlockScore* block : order) {
    const double share = std::isfinite(block->psnr_db) ? std::clamp((block->psnr_db - base) / std::max(high - base, 1e-9), 0.0, 1.0) : 0.0;
    html += BarRow(fmt::format("<a href=\"#block-{0}\">{0}</a>", EscapeHtml(block->name)), 100.0 * share, FormatFixed(block->psnr_db, 2, "dB"));
  }
  return html + "</div>" + Note("The bars start at " + FormatFixed(base, 0, "dB") + ".") + "</div>";
}

std::string BlockFacts(const ReportInput& input) {
  std::vector<double> gsd_cm, margin_m, altitude_m;
  size_t n_empty = 0;
  for (const partition::Block& block : input.blocks->blocks) {
    if (block.empty) {
      ++n_empty;
      continue;
    }
    gsd_cm.push_back(100.0 * block.gsd_m);
    margin_m.push_back(block.margin_m);
    altitude_m.push_back(block.altitude_agl_m);
  }
  std::string html = "<dl class=\"card facts small\">";
  const auto fact = [&](const char* name, const std::string& value) { html += Fact(name, value); };
  fact("Blocks", fmt::format("{} \xC3\x97 {}{}", input.blocks->rows, input.blocks->columns, n_empty > 0 ? fmt::format(", {} empty", n_empty) : ""));
  if (!input.survey->georeferenced) return html + "</dl>";  // lengths are in units of unknown size
  fact("Height above ground", RangeOf(altitude_m, 0, "m"));
  fact("Ground sampling distance", RangeOf(gsd_cm, 1, "cm"));
  fact("Overlap on each side", RangeOf(margin_m, 1, "m"));
  return html + "</dl>";
}

std::string OrthophotoLabel(const MapBackground& background) {
  return background.preview.empty() ? "Orthophoto" : "Orthophoto (preview: from the " + EscapeHtml(background.preview) + ")";
}

std::string MapSection(const ReportInput& input) {
  std::string html =
      SectionBegin("map-section", "Map and blocks") +
      Lead("The ground is cut into blocks, and each block is trained by itself. The figure in a block is the PSNR of the held-out photos there.") +
      "<div class=\"map-grid\"><div class=\"card map-card\">" + BlockMapSvg(input);
  html += "<div class=\"toggles\">";
  if (input.background) html += Toggle("ortho", OrthophotoLabel(*input.background), "k-ortho");
  html += Toggle("blocks", "Blocks and margins", "k-block") + Toggle("cameras", "Training photos", "k-camera") +
          Toggle("tests", "Held-out photos", "k-test");
  if (input.survey->georeferenced) html += Toggle("gps", "GPS tracks", "k-gps");
  return html + "</div></div><div class=\"side\">" + BlockBars(input) + BlockFacts(input) + "</div></div>" + BlockTable(input) + "</section>\n";
}

// Where the time of all training steps went.
std::string PhaseBars(const ReportInput& input) {
  std::vector<std::pair<std::string, double>> phases;
  double total = 0.0;
  for (const scene::FieldTraining& field : input.training->fields) {
    for (const auto& [phase, seconds] : field.phase_seconds) {
      auto known = std::find_if(phases.begin(), phases.end(), [&, &name = phase](const auto& s) { return s.first == name; });
      if (known == phases.end()) known = phases.insert(phases.end(), {phase, 0.0});
      known->second += seconds;
      total += seconds;
    }
  }
  if (total <= 0.0) return "";
  std::stable_sort(phases.begin(), phases.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string html = "<div class=\"card bars\"><h3>Where training time goes</h3><div class=\"rows\">";
  for (const auto& [phase, seconds] : phases) {
    html += BarRow("<em>" + EscapeHtml(phase) + "</em>", 100.0 * seconds / phases.front().second, FormatFixed(100.0 * seconds / total, 1, "%"));
  }
  return html + "</div>" +
         Note(fmt::format("{} of work, summed over all threads. {} samples per ray.", ShownDuration(total),
                          FormatFixed(input.training->SamplesPerRay(), 1))) +
         "</div>";
}

std::string TrainingSection(const ReportInput& input) {
  std::vector<Curve> loss, psnr;
  for (const scene::FieldTraining& field : input.training->fields) {
    Curve loss_curve{field.name, {}, field.name == "context"};
    Curve psnr_curve = loss_curve;
    const auto curve = input.curves.find(field.name);
    static const std::vector<metrics::CurvePoint> kNone;
    const std::vector<metrics::CurvePoint>& points = curve == input.curves.end() ? kNone : curve->second;
    for (const metrics::CurvePoint& point : points) {
      const double x = std::isfinite(point.seconds) ? point.seconds : point.step;
      loss_curve.points.emplace_back(x, point.loss);
      psnr_curve.points.emplace_back(x, point.psnr_db);
    }
    loss.push_back(std::move(loss_curve));
    psnr.push_back(std::move(psnr_curve));
  }
  return SectionBegin("training", "Training") + "<div class=\"chart-grid\">" +
         CurveChart(loss, {.title = "Loss", .x_label = "training time of the block (s)", .y_label = "loss", .log_y = true}) +
         CurveChart(psnr, {.title = "PSNR of the training rays", .x_label = "training time of the block (s)", .y_label = "PSNR (dB)"}) +
         PhaseBars(input) + "</div></section>\n";
}

}  // namespace

std::string BuildReportPage(const ReportInput& input) {
  SKYQUILT_CHECK(input.metrics != nullptr && input.survey != nullptr && input.blocks != nullptr && input.training != nullptr,
                 "all parts of the input");
  SKYQUILT_CHECK(input.images.empty() || input.images.size() == input.metrics->photos.size(), "one entry of images per scored photo");
  const std::string brightness = BrightnessSection(input), made = SurfaceSection(input), found = BuildingsSection(input);
  const std::string map = input.metrics->ortho ? OrthoSection(*input.metrics->ortho, input.ortho_pictures) : "";
  const std::string walls = ElevationSection(input.elevations, input.survey->georeferenced);
  const std::string control = ControlSection(input), files = InputSection(input), masks = MasksSection(input.masks),
                    time = TimeSection(*input.metrics);
  PageFrame frame{.title = input.title,
                  .window_title = "Skyquilt report",
                  .subtitle = fmt::format("Survey report \xC2\xB7 {} \xC2\xB7 {} photos, {} blocks", ShownDate(input.metrics->date),
                                          FormatInteger(input.metrics->n_photos), input.blocks->blocks.size()),
                  .anchors = {{"summary", "Summary"}, {"map-section", "Map"}, {"photos", "Photos"}}};
  if (!map.empty()) frame.anchors.emplace_back("orthophoto", "Orthophoto");
  if (!walls.empty()) frame.anchors.emplace_back("elevations", "Elevations");
  if (!made.empty()) frame.anchors.emplace_back("surface", "Surface");
  if (!found.empty()) frame.anchors.emplace_back("buildings", "Buildings");
  frame.anchors.emplace_back("geo", "Geo-reference");
  if (!control.empty()) frame.anchors.emplace_back("control", "Control points");
  if (!files.empty()) frame.anchors.emplace_back("input", "Photo folder");
  if (!masks.empty()) frame.anchors.emplace_back("masks", "Ignored pixels");
  frame.anchors.emplace_back("details", "Details");
  if (!brightness.empty()) frame.anchors.emplace_back("brightness", "Brightness");
  frame.anchors.emplace_back("training", "Training");
  if (!time.empty()) frame.anchors.emplace_back("time", "Time");
  frame.anchors.emplace_back("method", "Method");
  return PageBegin(frame) + SummarySection(input) + WarningsBanner(*input.metrics) + MapSection(input) + PhotoSection(input) + map + walls + made +
         found + GeoSection(input) + control + files + masks + DetailsSection(input) + brightness + TrainingSection(input) + time +
         MethodSection(input) + PageEnd();
}

}  // namespace skyquilt::evaluate::page
