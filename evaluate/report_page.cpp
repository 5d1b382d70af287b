#include "evaluate/report_page.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/errors.h"
#include "core/base/progress.h"
#include "core/page/curve_chart.h"
#include "core/page/html.h"
#include "core/page/page_frame.h"
#include "evaluate/page_parts.h"

namespace skyquilt::evaluate {

namespace {

std::string Duration(double seconds) {
  return std::isfinite(seconds) ? base::FormatDuration(seconds) : page::FormatFixed(seconds, 0);
}

std::string Headline(const ReportInput& input) {
  const Metrics& metrics = *input.metrics;
  std::string html = "<section id=\"summary\" class=\"kpis\">";
  html += page::KeyFigure("PSNR, held-out photos", page::FormatFixed(metrics.psnr, 2, "dB"),
                          "full frame " + page::FormatFixed(metrics.psnr_full_frame, 2, "dB"), true);
  if (!std::isnan(metrics.psnr_exif_gain)) {
    html += page::KeyFigure("PSNR with the EXIF gain alone", page::FormatFixed(metrics.psnr_exif_gain, 2, "dB"), "brightness as the tags state it");
  }
  if (!std::isnan(metrics.psnr_right_half)) {
    html += page::KeyFigure("PSNR of right halves, as rendered", page::FormatFixed(metrics.psnr_right_half, 2, "dB"),
                            page::FormatFixed(metrics.psnr_right_half_fitted, 2, "dB") + " with gains fitted to the left halves");
  }
  html += page::KeyFigure("SSIM", page::FormatFixed(metrics.ssim, 3), "full frame " + page::FormatFixed(metrics.ssim_full_frame, 3));
  html +=
      page::KeyFigure("Coverage", page::FormatPercent(metrics.coverage), fmt::format("of the pixels of {} held-out photos", metrics.photos.size()));
  html += page::KeyFigure("LPIPS", page::FormatFixed(metrics.lpips, 3), page::EscapeHtml(metrics.lpips_note));
  if (metrics.has_truth) {
    html += page::KeyFigure("Median depth error", page::FormatFixed(metrics.depth_median_abs_m, 2, "m"),
                            "RMSE " + page::FormatFixed(metrics.depth_rmse_m, 2, "m"));
    html += page::KeyFigure("Floater opacity", page::FormatPercent(metrics.floater_opacity, 2),
                            "of light from the true surface swallowed more than 1 m in front of it");
  }
  html += page::KeyFigure("Seam gap", page::FormatFixed(metrics.seam_psnr_gap_db, 2, "dB"),
                          std::isfinite(metrics.seam_psnr_gap_db) ? "same textures inside " + page::FormatFixed(metrics.psnr_matched_interior_db, 2) +
                                                                        ", in seams " + page::FormatFixed(metrics.psnr_seam_db, 2, "dB")
                                                                  : "no seams were scored");
  html += page::KeyFigure("Training time", Duration(metrics.train_seconds),
                          fmt::format("{} {}{}", metrics.ranks, metrics.ranks == 1 ? "process" : "ranks",
                                      metrics.threads > 0 ? fmt::format(", {} threads", metrics.threads) : ""));
  html += page::KeyFigure("Training speed", page::FormatLarge(metrics.samples_per_second), "samples per second");
  html += page::KeyFigure("Peak memory", page::FormatBytes(metrics.peak_rss_bytes), metrics.ranks > 1 ? "training, largest rank" : "training");
  html += page::KeyFigure("Parameters", page::FormatLarge(static_cast<double>(metrics.parameters)), "of all fields in the scene, context included");
  const survey::GeoFit& fit = metrics.geo_fit;
  html += page::KeyFigure(
      "Geo-reference", metrics.georeferenced ? page::FormatFixed(fit.rmse_m, 2, "m") : "none",
      metrics.georeferenced ? fmt::format("RMSE to GPS, {} of {} photos", fit.n_inliers, fit.n_matches) : "no GPS: local frame, unknown scale");
  html += page::KeyFigure("Height above ground", page::FormatFixed(metrics.median_agl_m, 1, "m"),
                          std::isfinite(metrics.median_relative_altitude_m)
                              ? "median; drone's own figure " + page::FormatFixed(metrics.median_relative_altitude_m, 1, "m")
                              : "median over photos");
  return html + "</section>\n";
}

std::string Warnings(const Metrics& metrics) {
  if (metrics.warnings.empty()) return "<p class=\"banner good\"><b>No warnings.</b> Every photo is registered and every block was trained.</p>\n";
  std::string html = fmt::format("<details class=\"banner warn\" open><summary><b>{} {}</b></summary><ul>", metrics.warnings.size(),
                                 metrics.warnings.size() == 1 ? "warning" : "warnings");
  for (const std::string& warning : metrics.warnings) html += "<li>" + page::EscapeHtml(warning) + "</li>";
  return html + "</ul></details>\n";
}

std::string Toggle(const char* layer, const char* label, const char* mark) {
  return fmt::format("<label><input type=\"checkbox\" data-layer=\"layer-{}\" checked><i class=\"{}\"></i>{}</label>", layer, mark, label);
}

std::string BlockBars(const ReportInput& input) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const BlockScore& block : input.metrics->blocks) {
    if (!std::isfinite(block.psnr_db)) continue;
    low = std::min(low, block.psnr_db);
    high = std::max(high, block.psnr_db);
  }
  std::string html = "<div class=\"card bars\"><h3>Held-out PSNR per block</h3>";
  if (input.metrics->blocks.empty() || !std::isfinite(low)) return html + "<p class=\"empty\">No block was scored.</p></div>";
  // Bars start a little below the worst block: differences of tenths of a decibel are what one looks for.
  const double base = std::max(0.0, std::floor(low - 0.35 * std::max(high - low, 1.0)));
  std::vector<const BlockScore*> order;
  for (const BlockScore& block : input.metrics->blocks) order.push_back(&block);
  std::stable_sort(order.begin(), order.end(), [](const BlockScore* a, const BlockScore* b) {
    return std::isfinite(a->psnr_db) && (!std::isfinite(b->psnr_db) || a->psnr_db > b->psnr_db);
  });
  html += "<div class=\"rows\">";
  for (const BlockScore* block : order) {
    const double share = std::isfinite(block->psnr_db) ? std::clamp((block->psnr_db - base) / std::max(high - base, 1e-9), 0.0, 1.0) : 0.0;
    html += BarRow(fmt::format("<a href=\"#block-{0}\">{0}</a>", page::EscapeHtml(block->name)), 100.0 * share,
                   page::FormatFixed(block->psnr_db, 2, "dB"));
  }
  return html + fmt::format("</div><p class=\"note\">Bars start at {}.</p></div>", page::FormatFixed(base, 0, "dB"));
}

// One figure for equal values, otherwise the range.
std::string RangeOf(const std::vector<double>& values, int decimals, const char* unit) {
  if (values.empty()) return page::FormatFixed(kNotMeasured, decimals);
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const std::string low_text = page::FormatFixed(*low, decimals), high_text = page::FormatFixed(*high, decimals, unit);
  return page::FormatFixed(*low, decimals, unit) == high_text ? high_text : low_text + " \xE2\x80\x93 " + high_text;
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
  const Metrics& metrics = *input.metrics;
  std::string html = "<dl class=\"card facts small\">";
  const auto fact = [&](const char* name, const std::string& value) { html += Fact(name, value); };
  fact("Blocks", fmt::format("{} \xC3\x97 {}{}", input.blocks->rows, input.blocks->columns, n_empty > 0 ? fmt::format(", {} empty", n_empty) : ""));
  fact("Flown at", RangeOf(altitude_m, 0, "m above ground"));
  fact("GSD", RangeOf(gsd_cm, 1, "cm"));
  fact("Margin", RangeOf(margin_m, 1, "m"));
  fact("Inside blocks", page::FormatFixed(metrics.psnr_interior_db, 2, "dB"));
  fact("In seams", page::FormatFixed(metrics.psnr_seam_db, 2, "dB"));
  fact("Seam gap", page::FormatFixed(metrics.seam_psnr_gap_db, 2, "dB"));
  return html + "</dl>";
}

std::string MapSection(const ReportInput& input) {
  std::string html = "<section id=\"map-section\"><div class=\"heading\"><h2>Blocks</h2></div><div class=\"map-grid\"><div class=\"card map-card\">" +
                     BlockMapSvg(input);
  html += "<div class=\"toggles\">";
  if (input.background) html += Toggle("ortho", "Orthophoto", "k-ortho");
  html += Toggle("blocks", "Blocks and margins", "k-block") + Toggle("cameras", "Training photos", "k-camera") +
          Toggle("tests", "Held-out photos", "k-test");
  if (input.survey->georeferenced) html += Toggle("gps", "GPS tracks", "k-gps");
  return html + "</div></div>" + "<div class=\"side\">" + BlockBars(input) + BlockFacts(input) + "</div></div>" + BlockTable(input) + "</section>\n";
}

// Where the time of all training steps went.
std::string StageBars(const ReportInput& input) {
  std::vector<std::pair<std::string, double>> stages;
  double total = 0.0;
  for (const scene::FieldTraining& field : input.training->fields) {
    for (const auto& [phase, seconds] : field.phase_seconds) {
      auto known = std::find_if(stages.begin(), stages.end(), [&, &name = phase](const auto& s) { return s.first == name; });
      if (known == stages.end()) known = stages.insert(stages.end(), {phase, 0.0});
      known->second += seconds;
      total += seconds;
    }
  }
  if (total <= 0.0) return "";
  std::stable_sort(stages.begin(), stages.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string html = "<div class=\"card bars\"><h3>Where training time goes</h3><div class=\"rows\">";
  for (const auto& [phase, seconds] : stages) {
    html += BarRow("<em>" + page::EscapeHtml(phase) + "</em>", 100.0 * seconds / stages.front().second,
                   page::FormatFixed(100.0 * seconds / total, 1, "%"));
  }
  return html + fmt::format("</div><p class=\"note\">{} of work on all threads, {} samples per ray.</p></div>", base::FormatDuration(total),
                            page::FormatFixed(input.training->SamplesPerRay(), 1));
}

std::string TrainingSection(const ReportInput& input) {
  std::vector<page::Curve> loss, psnr;
  for (const scene::FieldTraining& field : input.training->fields) {
    page::Curve loss_curve{field.name, {}, field.name == "context"};
    page::Curve psnr_curve = loss_curve;
    const auto curve = input.curves.find(field.name);
    static const std::vector<CurvePoint> kNone;
    const std::vector<CurvePoint>& points = curve == input.curves.end() ? kNone : curve->second;
    for (const CurvePoint& point : points) {
      const double x = std::isfinite(point.seconds) ? point.seconds : point.step;
      loss_curve.points.emplace_back(x, point.loss);
      psnr_curve.points.emplace_back(x, point.psnr_db);
    }
    loss.push_back(std::move(loss_curve));
    psnr.push_back(std::move(psnr_curve));
  }
  return "<section id=\"training\"><div class=\"heading\"><h2>Training</h2></div><div class=\"chart-grid\">" +
         page::CurveChart(loss, {.title = "Loss", .x_label = "training time of the field (s)", .y_label = "loss", .log_y = true}) +
         page::CurveChart(psnr, {.title = "PSNR of the training batches", .x_label = "training time of the field (s)", .y_label = "PSNR (dB)"}) +
         StageBars(input) + "</div></section>\n";
}

std::string GeoSection(const ReportInput& input) {
  const survey::GeoFit& fit = input.metrics->geo_fit;
  std::string html = "<section id=\"geo\"><div class=\"heading\"><h2>Geo-reference</h2></div>";
  if (input.metrics->georeferenced) {
    html += fmt::format(
        "<p class=\"lead\">Similarity fit of the reconstruction to the GPS tags: RMSE {} over {} of {} tagged photos (horizontal {}, vertical {}).",
        page::FormatFixed(fit.rmse_m, 2, "m"), fit.n_inliers, fit.n_matches, page::FormatFixed(fit.rmse_horizontal_m, 2, "m"),
        page::FormatFixed(fit.rmse_vertical_m, 2, "m"));
    html +=
        fmt::format(" Local frame: east, north, up about {}, {}, height {}.", page::FormatFixed(input.survey->origin.latitude_deg, 6, "\xC2\xB0"),
                    page::FormatFixed(input.survey->origin.longitude_deg, 6, "\xC2\xB0"), page::FormatFixed(input.survey->origin.height_m, 1, "m"));
    for (size_t i = 0; i < fit.flight_vertical_offset_m.size(); ++i) {
      html += fmt::format(" Tags of flight {} were moved by {} in height.", i + 1, page::FormatFixed(fit.flight_vertical_offset_m[i], 2, "m"));
    }
    html += "</p>";
  }
  return html + ResidualTable(input) + "</section>\n";
}

std::string Facts(const ReportInput& input) {
  const Metrics& metrics = *input.metrics;
  std::string html =
      "<section id=\"details\"><div class=\"heading\"><h2>How this was measured</h2></div><div class=\"facts-grid\"><dl class=\"card facts\">";
  const auto fact = [&](const char* name, const std::string& value) { html += Fact(name, value); };
  const scene::RenderStatistics& rendering = metrics.rendering;
  if (rendering.bytes_sent > 0) {
    fact("Rendered by", fmt::format("{} rank(s), {}B on the wire", rendering.ranks,
                                    base::FormatCount(static_cast<double>(rendering.bytes_sent + rendering.bytes_received))));
  }
  fact("Machine", page::EscapeHtml(metrics.machine));
  fact("Date", page::EscapeHtml(metrics.date));
  fact("Photos", fmt::format("{} registered, {} not registered, {} held out, {} scored", page::FormatInteger(metrics.n_photos),
                             page::FormatInteger(metrics.n_unregistered), page::FormatInteger(metrics.n_test), metrics.photos.size()));
  fact("Scored at", metrics.image_width > 0 ? fmt::format("{} pixels width", metrics.image_width) : page::FormatFixed(kNotMeasured, 0));
  fact("Ground sampling distance", page::FormatFixed(metrics.gsd_m * 100.0, 1, "cm") + " (finest block)");
  fact("Evaluation", fmt::format("{}, peak memory {}", Duration(metrics.evaluate_seconds), page::FormatBytes(metrics.evaluate_peak_rss_bytes)));
  html += "</dl><div class=\"card prose\"><h3>Definitions</h3><p>";
  html +=
      page::EscapeHtml(kPsnrDefinition) + "</p><p>" + page::EscapeHtml(kCoverageDefinition) + "</p><p>" + page::EscapeHtml(kSeamDefinition) + "</p>";
  html += "<p>" + page::EscapeHtml(kRightHalfDefinition) + "</p>";
  html +=
      "<p>Renders are shown at the exposure of each photo as its EXIF states it and, where gains were learned, with what the photos before and after "
      "it needed beside theirs; nothing is fitted to the held-out photo.</p></div></div>";
  if (!metrics.config.empty())
    html += "<details class=\"card config\"><summary>Configuration</summary><pre>" + page::EscapeHtml(metrics.config) + "</pre></details>";
  return html + "</section>\n";
}

}  // namespace

std::string BuildReportPage(const ReportInput& input) {
  SKYQUILT_CHECK(input.metrics != nullptr && input.survey != nullptr && input.blocks != nullptr && input.training != nullptr,
                 "all parts of the input");
  SKYQUILT_CHECK(input.images.empty() || input.images.size() == input.metrics->photos.size(), "one entry of images per scored photo");
  const std::string brightness = BrightnessSection(input);
  page::PageFrame frame{.title = input.title,
                        .window_title = "Skyquilt report",
                        .subtitle = fmt::format("{} photos, {} blocks \xC2\xB7 {} \xC2\xB7 {}", page::FormatInteger(input.metrics->n_photos),
                                                input.blocks->blocks.size(), input.metrics->date, input.metrics->machine),
                        .anchors = {{"summary", "Summary"}, {"map-section", "Blocks"}, {"photos", "Photos"}}};
  if (!brightness.empty()) frame.anchors.emplace_back("brightness", "Brightness");
  for (const auto& [id, name] : {std::pair{"training", "Training"}, {"geo", "Geo-reference"}, {"details", "Details"}})
    frame.anchors.emplace_back(id, name);
  std::string html = page::PageBegin(frame);
  html += Headline(input) + Warnings(*input.metrics) + MapSection(input) + PhotoSection(input) + brightness + TrainingSection(input) +
          GeoSection(input) + Facts(input);
  return html + page::PageEnd();
}

}  // namespace skyquilt::evaluate
