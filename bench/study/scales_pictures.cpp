#include "bench/study/scales_pictures.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>

#include "core/base/file.h"

namespace skyquilt::bench {
namespace {

constexpr int kCropWidth = 80, kCropHeight = 60;  // of the sheet; crops of other widths have its shape
constexpr int kShownWidth = 320;

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
