#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/page/page_frame.h"
#include "evaluate/control/control_summary.h"
#include "evaluate/page/geo_section.h"
#include "evaluate/page/page_parts.h"
#include "evaluate/page/sections.h"

namespace skyquilt::evaluate::page {

namespace {

// "; place ±1.6 m, scale ±0.20 %, tilt ±0.30°"; without what is not known.
std::string PlaceAccuracyNote(const survey::GeoFit& fit) {
  if (FrameIsExact(fit)) return "; the frame is known exactly";
  std::string note;
  const auto add = [&](const char* name, double value, const char* unit) {
    if (std::isfinite(value)) note += fmt::format("{} {} \xC2\xB1{}", note.empty() ? ";" : ",", name, TwoDigits(value, unit));
  };
  add("place", fit.accuracy.horizontal_m, "m");
  add("scale", fit.accuracy.scale_percent, "%");
  add("tilt", fit.accuracy.tilt_deg, "\xC2\xB0");
  return note;
}

// Points that the place was not fitted to say more about it than tags.
std::string ControlFigure(const control::ControlErrors& judged, bool check_points) {
  std::string note = "RMSE horizontally";
  if (std::isfinite(judged.rmse_vertical_m)) note += ", " + FormatFixed(judged.rmse_vertical_m, 3, "m") + " vertically";
  note += fmt::format(" at {} {}", judged.n,
                      !check_points   ? "control points, each left out in turn"
                      : judged.n == 1 ? "check point"
                                      : "check points");
  return KeyFigure(check_points ? "Error at check points" : "Error at points left out", FormatFixed(judged.rmse_horizontal_m, 3, "m"), note);
}

std::string PositionFigure(const metrics::Metrics& metrics) {
  const survey::GeoFit& fit = metrics.geo_fit;
  const std::string label = "Position error against GPS";
  if (!metrics.georeferenced)
    return KeyFigure(label, "none",
                     std::string("no geo-reference: local frame, ") + (fit.scale_bars.empty() ? "unknown scale" : "scale by scale bars"));
  const control::ControlSummary control = control::SummariseControl(metrics.control);
  if (const control::ControlErrors* const judged = control.Judged()) return ControlFigure(*judged, judged == &control.check);
  const double rmse_m = fit.n_inliers > 0 ? fit.rmse_m : kNotMeasured;
  return KeyFigure(label, FormatFixed(rmse_m, 2, "m"),
                   fmt::format("RMSE, {} of {} GPS tags used{}", fit.n_inliers, fit.n_matches, PlaceAccuracyNote(fit)));
}

std::string GroundSamplingFigure(const ReportInput& input) {
  const std::string label = "Ground sampling distance";
  if (!input.metrics->georeferenced && input.metrics->geo_fit.scale_bars.empty())
    return KeyFigure(label, FormatFixed(kNotMeasured, 0), "unknown without a geo-reference");
  std::vector<double> gsd_cm;
  for (const partition::Block& block : input.blocks->blocks) {
    if (!block.empty) gsd_cm.push_back(100.0 * block.gsd_m);
  }
  int width = 0;  // of the largest photos
  for (const camera::Camera& camera : input.survey->cameras) width = std::max(width, camera.width);
  std::string note = fmt::format("per pixel; flown {} above ground", FormatFixed(input.metrics->median_agl_m, 0, "m"));
  const int reduced = input.blocks->image_width;
  if (reduced > 0 && reduced < width) note += fmt::format(", photos reduced to {} pixels width", FormatInteger(reduced));
  return KeyFigure(label, RangeOf(gsd_cm, 1, "cm"), note);
}

std::string AreaFigure(const ReportInput& input) {
  double area_m2 = 0.0;
  size_t n_blocks = 0;
  for (const partition::Block& block : input.blocks->blocks) {
    const scene::FieldTraining* log = input.training->Find(block.name);
    if (block.empty || (log != nullptr && !log->ok)) continue;
    const Eigen::Vector3d size = block.max_enu - block.min_enu;
    area_m2 += size.x() * size.y();
    ++n_blocks;
  }
  const double area_ha = n_blocks > 0 && input.metrics->georeferenced ? area_m2 * 1e-4 : kNotMeasured;
  const int n_photos = input.metrics->n_photos;
  return KeyFigure("Area", FormatFixed(area_ha, area_ha < 10.0 ? 2 : 1, "ha"),
                   fmt::format("inside {} {}; {} of {} photos placed", n_blocks, n_blocks == 1 ? "block" : "blocks", FormatInteger(n_photos),
                               FormatInteger(n_photos + input.metrics->n_unregistered)));
}

// Without true depths the area that photos cover is what can be said of the surface.
std::string SurfaceFigure(const metrics::Metrics& metrics) {
  if (metrics.has_truth) {
    return KeyFigure("Depth error", FormatFixed(metrics.depth_median_abs_m, 2, "m"), "median, against the simulated survey's true depth");
  }
  return KeyFigure("Coverage", FormatPercent(metrics.coverage), "of the test photos' pixels: ground seen by two or more training photos");
}

std::string SimilarityFigure(const metrics::Metrics& metrics) {
  return KeyFigure("Picture similarity", FormatFixed(metrics.psnr, 2, "dB"),
                   metrics.photos.empty() ? "no photo was held out and scored"
                                          : fmt::format("PSNR on {} {} not used in training; higher is better", metrics.photos.size(),
                                                        metrics.photos.size() == 1 ? "photo" : "photos"));
}

std::string TimeFigure(const metrics::Metrics& metrics) {
  std::string note = metrics.ranks == 1 ? "1 process" : fmt::format("{} ranks", metrics.ranks);
  if (metrics.threads > 0)
    note += fmt::format(", {} {}{}", metrics.threads, metrics.threads == 1 ? "thread" : "threads", metrics.ranks > 1 ? " each" : "");
  return KeyFigure("Training time", ShownDuration(metrics.train_seconds), note + "; COLMAP not included");
}

}  // namespace

std::string SummarySection(const ReportInput& input) {
  const metrics::Metrics& metrics = *input.metrics;
  // What a surveyor asks first: where on Earth, how fine, how much ground, how right, how like the photos, how long.
  return "<section id=\"summary\" class=\"kpis six\">" + PositionFigure(metrics) + GroundSamplingFigure(input) + AreaFigure(input) +
         SurfaceFigure(metrics) + SimilarityFigure(metrics) + TimeFigure(metrics) +
         "</section>\n<p class=\"more\"><a href=\"#details\">All figures, and what they mean</a></p>\n";
}

std::string WarningsBanner(const metrics::Metrics& metrics) {
  if (metrics.warnings.empty()) return "<p class=\"banner good\"><b>No warnings.</b> Every photo was placed and every block was trained.</p>\n";
  std::string html = fmt::format("<details class=\"banner warn\" open><summary><b>{} {}</b></summary><ul>", metrics.warnings.size(),
                                 metrics.warnings.size() == 1 ? "warning" : "warnings");
  for (const metrics::Warning& warning : metrics.warnings) {
    html += fmt::format("<li>{}.<span class=\"advice\"><b>What to do:</b> {}.</span></li>", EscapeHtml(warning.finding), EscapeHtml(warning.advice));
  }
  return html + "</ul></details>\n";
}

}  // namespace skyquilt::evaluate::page
