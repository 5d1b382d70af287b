#include "evaluate/page/ortho_section.h"

#include <fmt/core.h>

#include <cmath>

#include "evaluate/page/page_parts.h"

namespace skyquilt::evaluate::page {
namespace {

std::string OrthoFigures(const ortho::OrthoScores& scores) {
  FigureTable table;
  const auto row = [&](const char* name, double value, int decimals, const char* unit, const char* meaning) {
    if (!std::isnan(value)) table.Row(name, FormatFixed(value, decimals, unit), meaning);
  };
  table.Group("The map");
  table.Row("Cells", FormatInteger(scores.cells), "Cells with data.");
  row("Size of a cell", 100.0 * scores.cell_m, 1, "cm", "On the ground.");
  if (std::isfinite(scores.share_photos)) {
    table.Row("From photos", FormatPercent(scores.share_photos), "Part of the cells that show a photo.");
    table.Row("From the field", FormatPercent(scores.share_field), "Part of the cells that no photo sees well enough; they show the trained scene.");
  }
  if (scores.photos_in_use >= 0) table.Row("Photos in use", FormatInteger(scores.photos_in_use), "Photos that at least one cell shows.");
  if (scores.cells_compared == 0 && !std::isfinite(scores.mtf50_per_cell)) return table.Html();
  table.Group("Against the true map");
  if (scores.cells_compared > 0) {
    table.Row("Cells compared", FormatInteger(scores.cells_compared), "Cells between the outermost cameras where both maps have data.");
  }
  row("PSNR", scores.psnr_db, 2, "dB", "How close the colours are; higher is better.");
  row("SSIM", scores.ssim, 3, "", "How alike structure and contrast are; 1 is the same.");
  row("Uneven light", scores.light_error_stops, 3, "stops",
      "How much the light of the map differs from the truth's from place to place, as where it shows shadows of clouds.");
  row("Shift to the east", 100.0 * scores.shift_east_m, 1, "cm", "Error of the geo-reference. The map is moved back by it before it is compared.");
  row("Shift to the north", 100.0 * scores.shift_north_m, 1, "cm", "The same to the north.");
  row("MTF50", scores.mtf50_per_cell, 3, "cycles per cell", "Sharpness: how fine stripes may be until half of their contrast is lost.");
  row("MTF50 on the ground", scores.mtf50_per_m, 2, "cycles per metre", "The same in metres.");
  row("MTF50 of a photo straight down", scores.photo_mtf50_per_px, 3, "cycles per pixel", "As much sharpness as there was to begin with.");
  row("The same on the ground", scores.photo_mtf50_per_m, 2, "cycles per metre", "The same in metres.");
  row("Seams", scores.seam_levels, 2, "of 255",
      "Step in the map's error where one photo ends and the next begins, on flat ground; mean over pairs of photos.");
  row("Worst seam", scores.seam_levels_worst, 2, "of 255", "The pair with the largest step.");
  if (scores.moving_car_cells >= 0) {
    table.Row("Cells under moving cars", FormatInteger(scores.moving_car_cells), "Cells where a photo in use shows a moving car or its shadow.");
  }
  if (std::isfinite(scores.moving_car_share)) {
    table.Row("Of them different", FormatPercent(scores.moving_car_share), "Part that differs from the truth by more than 20 of 255 in any colour.");
  }
  return table.Html();
}

}  // namespace

std::vector<OrthoPicture> WriteOrthoPictures(const std::vector<ortho::OrthoCrop>& crops, const std::filesystem::path& report_folder) {
  std::vector<OrthoPicture> pictures;
  for (const ortho::OrthoCrop& crop : crops) {
    const std::string name = fmt::format("images/ortho_{}", pictures.size() + 1);
    OrthoPicture& picture = pictures.emplace_back();
    picture.map = name + "_map.png";
    picture.truth = name + "_truth.png";
    picture.width_px = crop.map.width;
    picture.height_px = crop.map.height;
    picture.what = crop.what;
    picture.psnr_db = crop.psnr_db;
    image::SavePng(crop.map, report_folder / picture.map);
    image::SavePng(crop.truth, report_folder / picture.truth);
  }
  return pictures;
}

std::string OrthoSection(const ortho::OrthoScores& scores, const std::vector<OrthoPicture>& pictures) {
  std::string chips;
  if (std::isfinite(scores.psnr_db)) chips += Chip("PSNR", FormatFixed(scores.psnr_db, 2, "dB"), "main");
  if (std::isfinite(scores.share_photos)) chips += Chip("from photos", FormatPercent(scores.share_photos));
  std::string html = SectionBegin("orthophoto", "Orthophoto", chips.empty() ? "" : Chips(chips)) +
                     Lead("The map of the survey seen straight from above, <code>products/orthophoto.tif</code>.") + OrthoFigures(scores);
  if (pictures.empty()) return html + "</section>\n";
  html += BlockBegin("The map beside the truth", "Parts of both at full size, one pixel per cell.") + "<div class=\"views\">";
  for (const OrthoPicture& one : pictures) {
    html += "<article class=\"card photo\"><header><h3>" + EscapeHtml(one.what) + "</h3>" + Chips(Chip("PSNR", FormatFixed(one.psnr_db, 2, "dB"))) +
            "</header><div class=\"pics two\">";
    html += Picture("ortho-map-pic", one.map, one.width_px, one.height_px, "Orthophoto");
    html += Picture("ortho-truth-pic", one.truth, one.width_px, one.height_px, "Truth");
    html += "</div></article>\n";
  }
  return html + "</div></div></section>\n";
}

}  // namespace skyquilt::evaluate::page
