#include <fmt/core.h>

#include <cmath>

#include "evaluate/page/page_parts.h"
#include "evaluate/page/sections.h"

namespace skyquilt::evaluate::page {

namespace {

std::string Db(double value) {
  return FormatFixed(value, 2, "dB");
}

void AddPictureRows(const metrics::Metrics& metrics, FigureTable* table) {
  table->Group("Picture similarity, mean over the held-out photos");
  table->Row(
      "PSNR", Db(metrics.psnr),
      "Peak signal-to-noise ratio of the rendered picture against the photo, over covered pixels. Higher is better; twice the error is 6 dB less.");
  if (!std::isnan(metrics.psnr_1000)) {
    table->Row(fmt::format("PSNR at a width of {} pixels", photos::kCommonWidth), Db(metrics.psnr_1000),
               "With photo and rendering reduced to this width, so that trainings at different widths can be compared.");
  }
  table->Row("PSNR, full frame", Db(metrics.psnr_full_frame), "The same over all pixels that no mask excludes.");
  table->Row("SSIM", FormatFixed(metrics.ssim, 3), "Structural similarity over covered pixels. 1 is identical.");
  table->Row("SSIM, full frame", FormatFixed(metrics.ssim_full_frame, 3), "The same over all pixels that no mask excludes.");
  table->Row("FLIP", FormatFixed(metrics.flip, 3),
             "Difference that a person sees who flips between rendering and photo on a screen, over covered pixels. 0 is identical, 1 is the most.");
  table->Row("FLIP, full frame", FormatFixed(metrics.flip_full_frame, 3), "The same over all pixels that no mask excludes.");
  table->Row("LPIPS", FormatFixed(metrics.lpips, 3), "Perceptual distance, " + metrics.lpips_note + ". Lower is better.");
  table->Row("Coverage", FormatPercent(metrics.coverage),
             fmt::format("Pixels of {} held-out photos that show ground seen by at least two training photos.", metrics.photos.size()));
  if (!std::isnan(metrics.psnr_exif_gain)) {
    table->Row("PSNR with the EXIF gain alone", Db(metrics.psnr_exif_gain),
               "With the brightness that the tags state, without what training learned.");
  }
  if (!std::isnan(metrics.psnr_right_half)) {
    table->Row("PSNR of right halves, as rendered", Db(metrics.psnr_right_half), "Over the covered pixels of the right half of each photo.");
    table->Row("PSNR of right halves, with gains fitted to the left halves", Db(metrics.psnr_right_half_fitted),
               "The same, if the brightness of each photo were known.");
  }
  if (!std::isnan(metrics.psnr_tiles_shading)) {
    table->Row("PSNR of alternate tiles, as rendered", Db(metrics.psnr_tiles), "Over the covered pixels of every second tile of 16 pixels.");
    table->Row("PSNR of alternate tiles, with gains fitted to the others", Db(metrics.psnr_tiles_gains),
               "The same with the brightness of each photo fitted to the tiles between them.");
    table->Row("PSNR of alternate tiles, with shading fitted to the others", Db(metrics.psnr_tiles_shading),
               "The same with brightness and shading (shadows of clouds) fitted. Where this is much higher, light moved over the photos.");
  }
  if (!std::isnan(metrics.psnr_normal)) {
    table->Row("PSNR at normal brightness", Db(metrics.psnr_normal), "Against the normally exposed photos in evaluate.normal_photos.");
    table->Row("SSIM at normal brightness", FormatFixed(metrics.ssim_normal, 3), "The same with structural similarity.");
  }
}

void AddSurfaceRows(const metrics::Metrics& metrics, FigureTable* table) {
  if (!metrics.has_truth) return;
  table->Group("Surface, against the true depth of the simulated survey");
  table->Row("Depth error, median", FormatFixed(metrics.depth_median_abs_m, 2, "m"), "Half of the covered pixels have a smaller error.");
  table->Row("Depth error, RMSE", FormatFixed(metrics.depth_rmse_m, 2, "m"), "Root mean square error. Edges of roofs weigh heavily.");
  table->Row("Floater opacity", FormatPercent(metrics.floater_opacity, 2),
             "How much a ray loses in the air between the camera and 1 m in front of the true surface. Air should be empty: 0 % is best.");
}

void AddKeptPointRows(const metrics::Metrics& metrics, FigureTable* table) {
  const photos::KeptPointErrors& errors = metrics.kept_points;
  if (errors.rays == 0) return;
  table->Group("Surface, against sparse points that were kept from training");
  const auto row = [&](const char* name, double gsd, double metres, const std::string& meaning) {
    std::string value = FormatFixed(gsd, 2, "GSD");
    if (std::isfinite(metres)) value += " (" + FormatFixed(metres, 3, "m") + ")";
    table->Row(name, value, meaning);
  };
  row("Distance error, median", errors.median_gsd, errors.median_m,
      fmt::format("Where {} rays from photos to {} points find the surface, minus where the point is; positive behind it. GSD is the size of a pixel "
                  "of the photo there.",
                  FormatInteger(errors.rays), FormatInteger(errors.points)));
  row("Distance error, median size", errors.median_abs_gsd, errors.median_abs_m, "Half of the rays have a smaller error.");
  row("Distance error, NMAD", errors.nmad_gsd, errors.nmad_m,
      "Spread about the median: the standard deviation, if errors are normal. The points have errors of their own.");
  table->Row("Rays beyond 10 GSD", FormatPercent(errors.share_beyond_10_gsd), "Rays that miss the point by more, or meet no surface.");
}

void AddSeamRows(const metrics::Metrics& metrics, FigureTable* table) {
  table->Group("Seams");
  if (std::isfinite(metrics.seam_psnr_gap_db)) {
    table->Row("Seam gap", Db(metrics.seam_psnr_gap_db), "PSNR inside blocks minus PSNR where blocks overlap, at the same texture. Near 0 is good.");
    table->Row("PSNR inside blocks, at the texture of the seams", Db(metrics.psnr_matched_interior_db), "First part of the seam gap.");
    table->Row("PSNR where blocks overlap", Db(metrics.psnr_seam_db), "Second part of the seam gap.");
    table->Row("PSNR inside blocks", Db(metrics.psnr_interior_db), "Farther from the border of the block than the margin.");
  } else {
    table->Row("Seam gap", Db(metrics.seam_psnr_gap_db), "No overlap of blocks was scored.");
  }
  table->Row("Exposure seams", FormatFixed(metrics.exposure_seam, 4),
             "Brightness step on the map along the borders of single photos, median, 1 is white. Good when it is no larger than the control value.");
  table->Row("Exposure seams, control", FormatFixed(metrics.exposure_seam_control, 4),
             "The same along lines where no photo ends: the step that texture alone gives.");
}

void AddTrustRows(const trust::TrustScores& trust, FigureTable* table) {
  if (trust.pixels == 0) return;
  table->Group("Trust");
  table->Row("Error to expect", FormatFixed(trust.expected_rms, 3),
             "Root mean square over the scored pixels, 1 is white: what tiles of training photos say that nothing was learned from.");
  table->Row("Error found", FormatFixed(trust.found_rms, 3), "The same of the held-out photos. Near the expected one is good.");
  table->Row("Least over most trusted", FormatFixed(trust.least_over_most, 1),
             "Mean squared error of the tenth of the pixels that is trusted least, over that of the tenth that is trusted most.");
  table->Row(
      "AUSE", FormatFixed(trust.ause, 3),
      fmt::format("How far the order of trust is from the true order of errors: 0 is the same. By the number of photos {}, by the gradient of the "
                  "picture {}, by opacity {}.",
                  FormatFixed(trust.ause_photos, 3), FormatFixed(trust.ause_gradient, 3), FormatFixed(trust.ause_opacity, 3)));
}

void AddFlightRows(const metrics::Metrics& metrics, FigureTable* table) {
  if (!metrics.georeferenced) return;  // lengths are in units of unknown size
  table->Group("Flight");
  table->Row("Height above ground, median", FormatFixed(metrics.median_agl_m, 1, "m"), "Camera above the sparse points below it.");
  table->Row("Height above take-off, median", FormatFixed(metrics.median_relative_altitude_m, 1, "m"),
             "The drone's own figure (RelativeAltitude), as a cross-check.");
  table->Row("Ground sampling distance", FormatFixed(metrics.gsd_m * 100.0, 1, "cm"), "Size of a pixel on the ground, in the finest block.");
}

void AddCostRows(const metrics::Metrics& metrics, FigureTable* table) {
  table->Group("Computing");
  table->Row("Training time", ShownDuration(metrics.train_seconds), "Context and all blocks, by the clock.");
  table->Row("Training speed", FormatLarge(metrics.samples_per_second), "Samples along rays per second, all ranks together.");
  table->Row("Memory for training, peak", FormatBytes(metrics.peak_rss_bytes), metrics.ranks > 1 ? "Of the largest rank." : "Of the process.");
  table->Row("Parameters", FormatLarge(static_cast<double>(metrics.parameters)), "Trained numbers in all fields of the scene.");
  table->Row("Evaluation time", ShownDuration(metrics.evaluate_seconds), "Rendering and scoring the held-out photos.");
  table->Row("Memory for evaluation, peak", FormatBytes(metrics.evaluate_peak_rss_bytes), "Of this process.");
}

}  // namespace

std::string DetailsSection(const ReportInput& input) {
  const metrics::Metrics& metrics = *input.metrics;
  FigureTable table;
  AddPictureRows(metrics, &table);
  AddSurfaceRows(metrics, &table);
  AddKeptPointRows(metrics, &table);
  AddSeamRows(metrics, &table);
  AddTrustRows(metrics.trust, &table);
  AddFlightRows(metrics, &table);
  AddCostRows(metrics, &table);
  return SectionBegin("details", "Details") + table.Html() + ClassTable(metrics) + "</section>\n";
}

std::string MethodSection(const ReportInput& input) {
  const metrics::Metrics& metrics = *input.metrics;
  std::string html = SectionBegin("method", "How this was measured") + "<div class=\"facts-grid\"><dl class=\"card facts\">";
  const auto fact = [&](const char* name, const std::string& value) { html += Fact(name, value); };
  fact("Date", EscapeHtml(ShownDate(metrics.date)));
  fact("Machine", EscapeHtml(metrics.machine));
  const scene::RenderStatistics& rendering = metrics.rendering;
  if (rendering.bytes_sent > 0) {
    fact("Rendered by", fmt::format("{} {}, {} between them", rendering.ranks, rendering.ranks == 1 ? "rank" : "ranks",
                                    FormatBytes(rendering.bytes_sent + rendering.bytes_received)));
  }
  fact("Photos", fmt::format("{} placed, {} not placed, {} held out, {} scored", FormatInteger(metrics.n_photos),
                             FormatInteger(metrics.n_unregistered), FormatInteger(metrics.n_test), metrics.photos.size()));
  if (metrics.n_test > 0) {
    fact("Poses of held-out photos", metrics.resected_holdout ? "resected: placed last, by points that they had not helped to place"
                                                              : "given: found together with those of all other photos");
  }
  fact("Scored at", metrics.image_width > 0 ? fmt::format("a width of {} pixels", metrics.image_width) : FormatFixed(kNotMeasured, 0));
  html += "</dl><div class=\"card prose\"><h3>Definitions</h3>";
  for (const char* definition : {metrics::kPsnrDefinition, metrics::kCoverageDefinition, metrics::kSeamDefinition, metrics::kRightHalfDefinition}) {
    html += "<p>" + EscapeHtml(definition) + "</p>";
  }
  html +=
      "<p>Each photo is rendered at the exposure that its EXIF tags state. Where training learned gains, those of the photos taken before and after "
      "are added. Nothing is fitted to the held-out photo itself.</p></div></div>";
  if (!metrics.config.empty())
    html += "<details class=\"card config\"><summary>Configuration</summary><pre>" + EscapeHtml(metrics.config) + "</pre></details>";
  return html + "</section>\n";
}

}  // namespace skyquilt::evaluate::page
