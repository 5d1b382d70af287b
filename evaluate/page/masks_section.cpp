#include "evaluate/page/masks_section.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <utility>

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

// A photo that may be shown; look: path of its picture.
struct Candidate {
  std::string photo;
  std::filesystem::path look;
  double ignored = 0.0;
};

// Copies pictures of some of them to images/<name>_<i>.jpg.
std::vector<MaskPicture> CopyPictures(std::vector<Candidate> shown, const std::string& name, const std::filesystem::path& report_folder) {
  std::ranges::stable_sort(shown, [](const Candidate& a, const Candidate& b) { return a.ignored > b.ignored; });
  const size_t n = std::min(kMaskPictures, shown.size());
  std::error_code ignored;
  std::filesystem::create_directories(report_folder / "images", ignored);
  std::vector<MaskPicture> pictures;
  for (size_t i = 0; i < n; ++i) {
    const Candidate& one = shown[n == 1 ? 0 : i * (shown.size() - 1) / (n - 1)];
    MaskPicture picture{.photo = one.photo, .image = fmt::format("images/{}_{}.jpg", name, i), .ignored = one.ignored};
    try {
      image::ReadImageSize(one.look, &picture.width_px, &picture.height_px);
      std::filesystem::copy_file(one.look, report_folder / picture.image, std::filesystem::copy_options::overwrite_existing);
      pictures.push_back(std::move(picture));
    } catch (const std::exception& error) {
      base::LogWarning("the report is without what is ignored in {}: {}", one.photo, error.what());
    }
  }
  return pictures;
}

// Nothing where there is none or it is damaged.
template <typename Table>
std::optional<Table> ReadTable(std::optional<Table> (*load)(const std::filesystem::path&), const std::filesystem::path& folder) {
  try {
    return load(folder);
  } catch (const base::InputError& error) {
    base::LogWarning("the report is without masks: {}", error.what());
    return std::nullopt;
  }
}

std::string PicturesHtml(const std::vector<MaskPicture>& pictures) {
  if (pictures.empty()) return "";
  std::string html = "<div class=\"views\"><article class=\"card photo\"><div class=\"pics three\">";
  for (const MaskPicture& one : pictures) {
    html += Picture("mask-pic", one.image, one.width_px, one.height_px, one.photo + ": " + FormatPercent(one.ignored, 2) + " ignored");
  }
  return html + "</div></article></div>\n";
}

std::string MasksBlock(const MasksReport& report) {
  const survey::MadeMasks& masks = report.masks;
  if (masks.photos.empty()) return "";
  int64_t pixels = 0;
  for (const survey::MadeMask& mask : masks.photos) pixels += mask.pixels;
  std::string html = BlockBegin("Masks",
                                "What masks ignore is neither trained on nor scored. All photos with ignored pixels are in "
                                "<code>survey/made_masks/look/</code>: red by the network, blue on ignored ground, grey by given masks.") +
                     TableBegin(Headings({"Ignored"}) + NumberHeadings({"Photos", "Pixels", "Share of all"}), "");
  if (!masks.network.empty()) {
    html += MaskRow("by network " + masks.network + ": " + base::Join(masks.classes), masks, &survey::MadeMask::network, pixels);
  }
  if (!masks.ground.empty()) html += MaskRow("on ground inside " + masks.ground, masks, &survey::MadeMask::ground, pixels);
  html += MaskRow("by given masks", masks, &survey::MadeMask::given, pixels);
  return html + MaskRow("by any", masks, &survey::MadeMask::ignored, pixels) + kTableEnd + PicturesHtml(report.pictures) + "</div>";
}

std::string ComparedBlock(const MasksReport& report) {
  const survey::ComparedPhotos& compared = report.compared;
  if (compared.photos.empty()) return "";
  const auto with = std::ranges::count_if(compared.photos, [](const survey::ComparedPhoto& photo) { return photo.rejected > 0.0; });
  std::string html =
      BlockBegin("What moved",
                 "Blocks do not learn from pixels of training photos where other photos agree on another colour. Scores count all pixels. All photos "
                 "with such pixels, in red, are in <code>movers/</code>.") +
      TableBegin(Headings({"Found by comparing photos"}) + NumberHeadings({"Share of training photos"}), "");
  const auto row = [&](const char* what, double share) { html += "<tr>" + TextCell(what) + PercentCell(share, 2) + "</tr>"; };
  if (compared.movers != "off") {
    row("seen by enough photos to compare", compared.compared);
    row(compared.unclear ? "photos disagree; too much to tell what moved, so all of it was trained on" : "shows what moved", compared.moved);
  }
  if (compared.prefer == "latest") row("of earlier flights: later flights show something else", compared.replaced);
  double rejected = 0.0;
  for (const survey::ComparedPhoto& photo : compared.photos) rejected += photo.rejected / static_cast<double>(compared.photos.size());
  row(with == 1 ? "not trained on, in 1 photo, with its rim" : fmt::format("not trained on, in {} photos, with its rim", with).c_str(), rejected);
  return html + kTableEnd + PicturesHtml(report.compared_pictures) + "</div>";
}

}  // namespace

MasksReport CopyMasks(const std::filesystem::path& project_folder, const std::filesystem::path& report_folder) {
  MasksReport report;
  const std::filesystem::path survey_folder = project_folder / "survey", movers_folder = project_folder / "movers";
  if (std::optional<survey::MadeMasks> masks = ReadTable(survey::LoadMadeMasks, survey_folder)) {
    report.masks = *std::move(masks);
    std::vector<Candidate> shown;
    for (const survey::MadeMask& mask : report.masks.photos) {
      if (!mask.look.empty()) shown.push_back({mask.photo, survey::MadeMasksFolder(survey_folder) / mask.look, ShareOf(mask.ignored, mask.pixels)});
    }
    report.pictures = CopyPictures(std::move(shown), "mask", report_folder);
  }
  if (std::optional<survey::ComparedPhotos> compared = ReadTable(survey::LoadComparedPhotos, movers_folder)) {
    report.compared = *std::move(compared);
    std::vector<Candidate> shown;
    for (const survey::ComparedPhoto& photo : report.compared.photos) {
      if (!photo.look.empty()) shown.push_back({photo.photo, movers_folder / photo.look, photo.rejected});
    }
    report.compared_pictures = CopyPictures(std::move(shown), "moved", report_folder);
  }
  return report;
}

std::string MasksSection(const MasksReport& report) {
  const std::string blocks = MasksBlock(report) + ComparedBlock(report);
  return blocks.empty() ? "" : SectionBegin("masks", "Ignored pixels") + blocks + "</section>\n";
}

}  // namespace skyquilt::evaluate::page
