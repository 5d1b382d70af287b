#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <optional>

#include "bench/study/methods_parts.h"
#include "bench/study/picture_sheet.h"
#include "bench/study/scene_views.h"
#include "core/base/file.h"
#include "core/survey/surface_class.h"

namespace skyquilt::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kCutWidth = 160;  // pixels of the photo; the height is three quarters of it
constexpr int kCutShown = 320;  // pixels of the picture, about
constexpr std::array<survey::SurfaceClass, 2> kCutClasses = {survey::SurfaceClass::kRoof, survey::SurfaceClass::kTree};
constexpr const char* kFolder = "methods_images";

// A part of one of the pictures that a variant leaves.
struct ShownPart {
  int view = 0;
  PicturePart part;
};

std::optional<fs::path> ViewOf(const fs::path& folder, const VariantResult& result, int view, const std::string& kind) {
  if (result.views.empty()) return std::nullopt;
  const fs::path file = folder / result.views / ViewPicture(view, kind);
  return fs::is_regular_file(file) ? std::optional(file) : std::nullopt;
}

int CutWidth(int image_width) {
  return std::max(1, std::min(kCutWidth, image_width / 2));
}

// By the views of a variant, which show the same photos as those of all others.
std::vector<ShownPart> ChooseParts(const fs::path& folder, const VariantResult& result) {
  std::array<ClassCrop, kCutClasses.size()> best;
  std::array<int, kCutClasses.size()> best_view = {};
  std::vector<ShownPart> middles;
  for (int view = 0; const auto photo = ViewOf(folder, result, view, "photo"); ++view) {
    int width = 0, height = 0;
    image::ReadImageSize(*photo, &width, &height);
    const int w = CutWidth(width), h = std::min(height, std::max(1, w * 3 / 4));
    middles.push_back({view, {(width - w) / 2, (height - h) / 2, w, h}});
    const auto file = ViewOf(folder, result, view, "classes");
    if (!file) continue;
    const image::Image8 classes = image::LoadLabels(*file);
    for (size_t k = 0; k < kCutClasses.size(); ++k) {
      const ClassCrop own = CropWithMost(classes, kCutClasses[k], w, h);
      if (own.pixels <= best[k].pixels) continue;
      best[k] = own;
      best_view[k] = view;
    }
  }
  std::vector<ShownPart> parts;
  for (size_t k = 0; k < kCutClasses.size(); ++k) {
    if (best[k].pixels > 0) parts.push_back({best_view[k], best[k].part});
  }
  if (!parts.empty() || middles.empty()) return parts;
  parts.push_back(middles.front());
  if (middles.size() > 1) parts.push_back(middles.back());
  return parts;
}

// Nothing when the picture is gone.
std::optional<image::Image8> Shown(const fs::path& folder, const VariantResult& result, const ShownPart& shown, const std::string& kind) {
  const auto file = ViewOf(folder, result, shown.view, kind);
  if (!file) return std::nullopt;
  return EnlargedPart(image::LoadRgb8(*file), shown.part, std::max(1, kCutShown / shown.part.width));
}

}  // namespace

std::vector<BenchSection> WriteMethodPictures(const std::vector<MethodPair>& pairs, const fs::path& folder) {
  const VariantResult* reference = nullptr;
  for (const MethodPair& pair : pairs) {
    for (const VariantResult* result : {&pair.one, &pair.blocks}) {
      if (reference == nullptr && ViewOf(folder, *result, 0, "photo")) reference = result;
    }
  }
  if (reference == nullptr) return {};
  const std::vector<ShownPart> parts = ChooseParts(folder, *reference);
  BenchSection photos{.id = "photos",
                      .title = "Photos",
                      .lead = "Two parts of held-out photos, enlarged without smoothing.",
                      .charts = {},
                      .tables = {},
                      .pictures = {},
                      .magnified = false};
  BenchSection methods{.id = "pictures",
                       .title = "Pictures",
                       .lead = "The same parts by every method, one in each row: the first part by one field and by blocks, then the second part.",
                       .charts = {},
                       .tables = {},
                       .pictures = {},
                       .magnified = false};
  std::vector<std::vector<CaptionedImage>> rows(1);
  base::RequireWritableFolder(folder / kFolder);
  const auto add = [&](const VariantResult& result, size_t part, const std::string& kind, const std::string& name, const std::string& caption,
                       BenchSection* section) {
    std::optional<image::Image8> picture = Shown(folder, result, parts[part], kind);
    if (!picture) return;
    const std::string file = fmt::format("{}/{}_{}.png", kFolder, name, part + 1);
    image::SavePng(*picture, folder / file);
    section->pictures.push_back({file, caption});
    rows.back().push_back({caption, std::move(*picture)});
  };
  for (size_t part = 0; part < parts.size(); ++part) add(*reference, part, "photo", "photo", fmt::format("photo, part {}", part + 1), &photos);
  for (const MethodPair& pair : pairs) {
    rows.emplace_back();
    for (size_t part = 0; part < parts.size(); ++part) {
      add(pair.one, part, "render", pair.name + "_one", pair.name + ", one field", &methods);
      add(pair.blocks, part, "render", pair.name + "_blocks", pair.name + ", blocks", &methods);
    }
    if (rows.back().empty()) rows.pop_back();
  }
  image::SavePng(PictureSheet(rows), folder / "methods.png");
  return {std::move(photos), std::move(methods)};
}

}  // namespace skyquilt::bench
