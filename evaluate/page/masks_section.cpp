#include "evaluate/page/masks_section.h"

#include <fmt/core.h>

#include <algorithm>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "core/image/image.h"
#include "evaluate/page/page_parts.h"

namespace skyquilt::evaluate::page {
namespace {

double ShareOf(int64_t part, int64_t all) {
  return all == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(all);
}

// A row of the table: photos that have such pixels, their number and share of all.
std::string MaskRow(const std::string& what, const survey::MadeMasks& masks, int64_t survey::MadeMask::*part, int64_t all) {
  int64_t photos = 0, pixels = 0;
  for (const survey::MadeMask& mask : masks.photos) {
    photos += mask.*part > 0 ? 1 : 0;
    pixels += mask.*part;
  }
  return "<tr>" + TextCell(what) + CountCell(photos) + CountCell(pixels) + PercentCell(ShareOf(pixels, all), 2) + "</tr>";
}

}  // namespace

MasksReport CopyMasks(const std::filesystem::path& survey_folder, const std::filesystem::path& report_folder) {
  MasksReport report;
  try {
    const std::optional<survey::MadeMasks> masks = survey::LoadMadeMasks(survey_folder);
    if (!masks) return report;
    report.masks = *masks;
  } catch (const base::InputError& error) {
    base::LogWarning("the report is without masks: {}", error.what());
    return report;
  }
  std::vector<const survey::MadeMask*> shown;
  for (const survey::MadeMask& mask : report.masks.photos) {
    if (!mask.look.empty()) shown.push_back(&mask);
  }
  std::stable_sort(shown.begin(), shown.end(), [](const survey::MadeMask* a, const survey::MadeMask* b) {
    return ShareOf(a->ignored, a->pixels) > ShareOf(b->ignored, b->pixels);
  });
  const size_t n = std::min(kMaskPictures, shown.size());
  std::error_code ignored;
  std::filesystem::create_directories(report_folder / "images", ignored);
  for (size_t i = 0; i < n; ++i) {
    const survey::MadeMask& mask = *shown[n == 1 ? 0 : i * (shown.size() - 1) / (n - 1)];
    MaskPicture picture{.photo = mask.photo, .image = fmt::format("images/mask_{}.jpg", i), .ignored = ShareOf(mask.ignored, mask.pixels)};
    try {
      const std::filesystem::path look = survey::MadeMasksFolder(survey_folder) / mask.look;
      image::ReadImageSize(look, &picture.width_px, &picture.height_px);
      std::filesystem::copy_file(look, report_folder / picture.image, std::filesystem::copy_options::overwrite_existing);
      report.pictures.push_back(std::move(picture));
    } catch (const std::exception& error) {
      base::LogWarning("the report is without the mask of {}: {}", mask.photo, error.what());
    }
  }
  return report;
}

std::string MasksSection(const MasksReport& report) {
  const survey::MadeMasks& masks = report.masks;
  if (masks.photos.empty()) return "";
  int64_t pixels = 0;
  for (const survey::MadeMask& mask : masks.photos) pixels += mask.pixels;
  std::string html = SectionBegin("masks", "Masks") +
                     Lead(
                         "What masks ignore is neither trained on nor scored. All photos with ignored pixels are in "
                         "<code>survey/made_masks/look/</code>: red by the network, blue on ignored ground, grey by given masks.") +
                     TableBegin(Headings({"Ignored"}) + NumberHeadings({"Photos", "Pixels", "Share of all"}), "");
  if (!masks.network.empty()) {
    html += MaskRow("by network " + masks.network + ": " + base::Join(masks.classes), masks, &survey::MadeMask::network, pixels);
  }
  if (!masks.ground.empty()) html += MaskRow("on ground inside " + masks.ground, masks, &survey::MadeMask::ground, pixels);
  html += MaskRow("by given masks", masks, &survey::MadeMask::given, pixels);
  html += MaskRow("by any", masks, &survey::MadeMask::ignored, pixels) + kTableEnd;
  if (report.pictures.empty()) return html + "</section>\n";
  html += "<div class=\"views\">";
  for (const MaskPicture& one : report.pictures) {
    html += "<article class=\"card photo\"><header><h3>" + EscapeHtml(one.photo) + "</h3></header>" +
            Picture("mask-pic", one.image, one.width_px, one.height_px, FormatPercent(one.ignored, 2) + " ignored") + "</article>\n";
  }
  return html + "</div></section>\n";
}

}  // namespace skyquilt::evaluate::page
