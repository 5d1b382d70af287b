#include <fmt/core.h>

#include <cmath>

#include "evaluate/page/page_parts.h"
#include "evaluate/page/sections.h"

namespace skyquilt::evaluate::page {

namespace {

std::string Legend(const ReportInput& input, const std::string& low, const std::string& high) {
  if (input.color_ramp.empty()) return "";
  return fmt::format("<span class=\"ramp\">{}<i style=\"background-image:url({})\"></i>{}</span>", low, EscapeHtml(input.color_ramp), high);
}

std::string PhotoCard(const ReportInput& input, size_t index) {
  const photos::PhotoScore& score = input.metrics->photos[index];
  const PhotoImages& images = input.images[index];
  std::string html =
      fmt::format("<article class=\"card photo\" id=\"photo-{}\" data-order=\"{}\" data-psnr=\"{}\"><header><h3>{}</h3><div class=\"chips\">", index,
                  index, std::isfinite(score.psnr_db) ? fmt::format("{:.4f}", score.psnr_db) : "", EscapeHtml(score.name));
  html += Chip("PSNR", FormatFixed(score.psnr_db, 2, "dB"), "main");
  html += Chip("SSIM", FormatFixed(score.ssim, 3));
  html += Chip("FLIP", FormatFixed(score.flip, 3));
  html += Chip("coverage", FormatPercent(score.Coverage()));
  if (std::isfinite(score.expected_psnr_db)) html += Chip("PSNR to expect", FormatFixed(score.expected_psnr_db, 2, "dB"));
  html += Chip("full frame", FormatFixed(score.psnr_full_db, 2, "dB"));
  if (input.metrics->has_truth) html += Chip("median depth error", FormatFixed(score.depth_median_abs_m, 2, "m"));
  // Photo, render, error, error to expect and depth in one row; with normals there are two.
  html += fmt::format("</div></header><div class=\"pics{}\">", !images.trust.empty() && images.normals.empty() ? " five" : "");
  html += fmt::format(
      "<figure class=\"pic slider\"><div class=\"compare\" style=\"aspect-ratio:{0}/{1}\"><img src=\"{2}\" loading=\"lazy\" alt=\"Render\"><img "
      "class=\"top\" src=\"{3}\" loading=\"lazy\" alt=\"Photo\"><i></i><span class=\"tag l\">Photo</span><span class=\"tag r\">Render</span><input "
      "type=\"range\" min=\"0\" max=\"100\" step=\"0.1\" value=\"50\" aria-label=\"Move between photo and render\"></div><figcaption>Drag to compare "
      "photo and render</figcaption></figure>",
      images.width, images.height, EscapeHtml(images.render), EscapeHtml(images.photo));
  const auto picture = [&](const char* kind, const std::string& file, const char* caption, const std::string& legend = "") {
    html += Picture(kind, file, images.width, images.height, caption, legend);
  };
  picture("photo-pic", images.photo, "Photo");
  picture("render-pic", images.render, "Render");
  picture("error-pic", images.error, "Error", Legend(input, "0", FormatFixed(input.error_high, 2)));
  picture("trust-pic", images.trust, "Error to expect", Legend(input, "0", FormatFixed(input.error_high, 2)));
  picture("depth-pic", images.depth, "Depth", Legend(input, FormatFixed(images.depth_low_m, 1), FormatFixed(images.depth_high_m, 1, "m")));
  picture("normals-pic", images.normals, "Normals of the render");
  picture("true-normals-pic", images.true_normals, "True normals");
  return html + "</div></article>\n";
}

std::string PhotoTable(const ReportInput& input) {
  const bool truth = input.metrics->has_truth;
  std::string columns = Headings({"Held-out photo"}) +
                        NumberHeadings({"PSNR", "SSIM", "FLIP", "Coverage", "PSNR, full frame", "SSIM, full frame", "FLIP, full frame", "LPIPS"});
  const bool trust = input.metrics->trust.pixels > 0;
  if (trust) columns += NumberHeadings({"PSNR to expect"});
  if (truth) columns += NumberHeadings({"Depth error, RMSE", "Depth error, median"});
  std::string html = TableBegin(columns + NumberHeadings({"Exposure gain", "Size", "Render time"}));
  for (size_t i = 0; i < input.metrics->photos.size(); ++i) {
    const photos::PhotoScore& score = input.metrics->photos[i];
    const bool pictured = i < input.images.size() && !input.images[i].photo.empty();
    html += pictured ? fmt::format("<tr><td><a href=\"#photo-{}\">{}</a></td>", i, EscapeHtml(score.name)) : "<tr>" + TextCell(score.name);
    html += FixedCell(score.psnr_db, 2, "dB") + FixedCell(score.ssim, 3) + FixedCell(score.flip, 3) + PercentCell(score.Coverage()) +
            FixedCell(score.psnr_full_db, 2, "dB") + FixedCell(score.ssim_full, 3) + FixedCell(score.flip_full, 3) + FixedCell(score.lpips, 3);
    if (trust) html += FixedCell(score.expected_psnr_db, 2, "dB");
    if (truth) html += FixedCell(score.depth_rmse_m, 2, "m") + FixedCell(score.depth_median_abs_m, 2, "m");
    html += FixedCell(score.exposure_gain, 3);
    html += NumberCell(score.width, fmt::format("{} \xC3\x97 {}", score.width, score.height));
    html += FixedCell(score.render_seconds, 2, "s") + "</tr>";
  }
  return html + kTableEnd + "\n";
}

}  // namespace

std::string PhotoSection(const ReportInput& input) {
  if (input.metrics->photos.empty()) {
    return SectionBegin("photos", "Held-out photos") + EmptyCard("No photo was scored.") + "</section>\n";
  }
  const std::string controls =
      "<div class=\"controls\"><div class=\"segmented\" role=\"group\" aria-label=\"View\"><button data-view=\"side\" class=\"on\">Side by "
      "side</button><button data-view=\"slide\">Slider</button></div><label>Order <select id=\"order\"><option value=\"name\">by "
      "name</option><option value=\"worst\">worst first</option><option value=\"best\">best first</option></select></label></div>";
  std::string html =
      SectionBegin("photos", "Held-out photos", controls) +
      Lead(
          "These photos were kept out of training, so they test the result. Error is the mean absolute difference of red, green and blue in display "
          "values from 0 to 1. Grey pixels do not count: fewer than two training photos see them, or a mask excludes them. <span "
          "class=\"screen\">Click a picture to enlarge it.</span>") +
      "<div id=\"photo-list\">";
  size_t pictured = 0;
  for (size_t i = 0; i < input.metrics->photos.size() && i < input.images.size(); ++i) {
    if (input.images[i].photo.empty()) continue;
    html += PhotoCard(input, i);
    ++pictured;
  }
  html += "</div>";
  if (pictured < input.metrics->photos.size()) {
    html += Note(fmt::format("Pictures are shown for {} of {} scored photos; the table has all of them.", pictured, input.metrics->photos.size()));
  }
  return html + PhotoTable(input) + "</section>\n";
}

}  // namespace skyquilt::evaluate::page
