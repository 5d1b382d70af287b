#include "bench/study/scales_pictures.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <optional>

#include "core/base/file.h"
#include "core/image/draw_text.h"

namespace skyquilt::bench {
namespace {

constexpr int kCropWidth = 80, kCropHeight = 60;  // of the sheet; crops of other widths have its shape
constexpr int kShownWidth = 320;
constexpr int kGap_px = 10;
constexpr double kCapital_px = 11.0;

// kind: one, averaged or truth. Empty when the file is gone.
std::optional<image::Image8> Saved(const std::filesystem::path& study, const VariantResult& result, const std::string& group, const std::string& kind,
                                   int divisor) {
  const std::filesystem::path file = study / result.scale_pictures / ScalePicture(group, kind, divisor);
  if (result.scale_pictures.empty() || !std::filesystem::is_regular_file(file)) return std::nullopt;
  return image::LoadRgb8(file);
}

// At most `pixels` wide, enlarged to about kShownWidth.
image::Image8 Crop(const image::Image8& image, int pixels) {
  const int width = std::min(pixels, image.width);
  return EnlargedMiddle(image, width, width * kCropHeight / kCropWidth, std::max(1, kShownWidth / width));
}

std::string RaysCaption(const MethodResults& m, int divisor) {
  return fmt::format("{}, {} x {} rays", m.label, divisor, divisor);
}

}  // namespace

image::Image8 EnlargedMiddle(const image::Image8& image, int width, int height, int times) {
  const int w = std::min(width, image.width), h = std::min(height, image.height);
  const int left = (image.width - w) / 2, top = (image.height - h) / 2;
  image::Image8 enlarged(w * times, h * times, image.channels);
  for (int y = 0; y < enlarged.height; ++y) {
    for (int x = 0; x < enlarged.width; ++x) std::copy_n(image.At(left + x / times, top + y / times), image.channels, enlarged.At(x, y));
  }
  return enlarged;
}

image::Image8 PictureSheet(const std::vector<std::vector<CaptionedImage>>& rows) {
  const int caption_px = static_cast<int>(2.0 * kCapital_px);
  int width = kGap_px, height = kGap_px;
  for (const auto& row : rows) {
    int row_width = kGap_px, row_height = 0;
    for (const CaptionedImage& cell : row) {
      row_width += std::max(cell.image.width, image::TextWidth(cell.caption, kCapital_px)) + kGap_px;
      row_height = std::max(row_height, cell.image.height);
    }
    width = std::max(width, row_width);
    height += caption_px + row_height + kGap_px;
  }
  image::Image8 sheet(width, height, 3, 255);
  int top = kGap_px;
  for (const auto& row : rows) {
    int left = kGap_px, row_height = 0;
    for (const CaptionedImage& cell : row) {
      image::DrawText(&sheet, cell.caption, left, top + static_cast<int>(1.3 * kCapital_px), kCapital_px);
      for (int y = 0; y < cell.image.height; ++y) std::copy_n(cell.image.At(0, y), cell.image.width * 3, sheet.At(left, top + caption_px + y));
      left += std::max(cell.image.width, image::TextWidth(cell.caption, kCapital_px)) + kGap_px;
      row_height = std::max(row_height, cell.image.height);
    }
    top += caption_px + row_height + kGap_px;
  }
  return sheet;
}

BenchSection CropSection(const std::vector<MethodResults>& methods, const CropRequest& request) {
  BenchSection section{.id = request.id,
                       .title = request.title,
                       .lead = "The middle of one held-out photo, and of its rendering with one ray per pixel, enlarged without smoothing.",
                       .charts = {},
                       .tables = {},
                       .pictures = {},
                       .magnified = false};
  const std::filesystem::path study = request.folder / request.runs;
  const auto add = [&](const std::optional<image::Image8>& image, const std::string& name, const std::string& caption) {
    if (!image) return;
    const std::filesystem::path file = std::filesystem::path("scales_images") / (request.id + "_" + name + ".png");
    base::RequireWritableFolder(request.folder / "scales_images");
    image::SavePng(Crop(*image, request.pixels), request.folder / file);
    section.pictures.push_back({file.generic_string(), caption});
  };
  for (const MethodResults& m : methods) {
    if (section.pictures.empty()) add(Saved(study, m.First(), request.group, "truth", request.divisor), "truth", "photo");
    add(Saved(study, m.First(), request.group, "one", request.divisor), m.First().name, m.label);
  }
  if (request.averaged && !methods.empty()) {
    const MethodResults& m = methods.front();
    add(Saved(study, m.First(), request.group, "averaged", request.divisor), m.First().name + "_averaged", RaysCaption(m, request.divisor));
  }
  return section;
}

void WriteScaleSheet(const std::vector<MethodResults>& methods, const std::vector<int>& divisors, const std::filesystem::path& folder) {
  const MethodResults* points = Find(methods, {});
  const MethodResults* cones = BestCones(methods);
  if (points == nullptr || cones == nullptr) return;
  std::vector<std::vector<CaptionedImage>> rows;
  for (const int divisor : divisors) {
    std::vector<CaptionedImage> row;
    const auto add = [&](const MethodResults& m, const std::string& kind, const std::string& caption) {
      if (const auto image = Saved(folder, m.First(), "", kind, divisor)) {
        row.push_back({caption, Crop(*image, kCropWidth)});
      }
    };
    add(*points, "truth", "photo at " + FractionName(divisor));
    add(*points, "one", points->label);
    add(*cones, "one", cones->label);
    add(*points, "averaged", RaysCaption(*points, divisor));
    if (!row.empty()) rows.push_back(std::move(row));
  }
  if (!rows.empty()) image::SavePng(PictureSheet(rows), folder / "scales.png");
}

}  // namespace skyquilt::bench
