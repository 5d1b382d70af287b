#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <optional>

#include "bench/study/picture_sheet.h"
#include "bench/study/priors_parts.h"
#include "bench/study/scene_views.h"
#include "core/base/file.h"

namespace skyquilt::bench {
namespace {

constexpr int kPartWidth = 160;    // pixels of the photo; the height is three quarters of it
constexpr int kPartShown = 320;    // pixels of the picture, about
constexpr size_t kOtherViews = 3;  // without true classes
constexpr size_t kVariantsShown = 3;

std::optional<std::filesystem::path> SavedView(const std::filesystem::path& folder, const PriorResults& results, int view, const std::string& kind) {
  if (results.seeds.empty() || results.seeds.front().views.empty()) return std::nullopt;
  const std::filesystem::path file = folder / results.seeds.front().views / ViewPicture(view, kind);
  return std::filesystem::is_regular_file(file) ? std::optional(file) : std::nullopt;
}

// Before, and after: the variants in use.
std::vector<const PriorResults*> ShownVariants(const std::vector<PriorResults>& results) {
  std::vector<const PriorResults*> after;
  for (const char* name : {"default", "all"}) {
    for (const PriorResults& r : results) {
      if (r.name == name) after.push_back(&r);
    }
  }
  for (size_t i = 1; after.empty() && i < std::min(results.size(), kVariantsShown); ++i) after.push_back(&results[i]);
  after.insert(after.begin(), &results.front());
  return after;
}

// Half of a small photo, so that a crop is a choice even there.
int PartWidth(int image_width) {
  return std::max(1, std::min(kPartWidth, image_width / 2));
}

int PartHeight(int image_width) {
  return std::max(1, PartWidth(image_width) * 3 / 4);
}

PriorCrops CropsAt(const std::filesystem::path& folder, const std::vector<const PriorResults*>& variants, int view, const PicturePart& part) {
  PriorCrops crops;
  const auto add = [&](const PriorResults& of, const std::string& kind, const std::string& caption, std::vector<CaptionedImage>* row) {
    const auto file = SavedView(folder, of, view, kind);
    if (file) row->push_back({caption, EnlargedPart(image::LoadRgb8(*file), part, std::max(1, kPartShown / part.width))});
    return file.has_value();
  };
  add(*variants.front(), "photo", "photo", &crops.colors);
  if (!add(*variants.front(), "true_normals", "true surface", &crops.normals)) crops.normals = crops.colors;
  for (const PriorResults* of : variants) {
    add(*of, "render", of->label, &crops.colors);
    add(*of, "normals", of->label + ", surface", &crops.normals);
  }
  return crops;
}

struct ShownClass {
  survey::SurfaceClass surface;
  const char* id;
  const char* title;
};
constexpr std::array<ShownClass, 3> kShownClasses = {{{survey::SurfaceClass::kRoof, "roofs", "Roofs"},
                                                      {survey::SurfaceClass::kWall, "walls", "Walls"},
                                                      {survey::SurfaceClass::kTree, "trees", "Trees"}}};

}  // namespace

std::vector<PriorCrops> CropsOfPriors(const std::vector<PriorResults>& results, const std::filesystem::path& folder) {
  std::vector<PriorCrops> crops;
  if (results.empty()) return crops;
  const std::vector<const PriorResults*> variants = ShownVariants(results);
  std::array<ClassCrop, kShownClasses.size()> best;
  std::array<int, kShownClasses.size()> best_view = {};
  bool classes_known = false;
  int views = 0;
  for (; SavedView(folder, results.front(), views, "photo"); ++views) {
    const auto file = SavedView(folder, results.front(), views, "classes");
    if (!file) continue;
    classes_known = true;
    const image::Image8 classes = image::LoadLabels(*file);
    for (size_t k = 0; k < kShownClasses.size(); ++k) {
      const ClassCrop own = CropWithMost(classes, kShownClasses[k].surface, PartWidth(classes.width), PartHeight(classes.width));
      if (own.pixels <= best[k].pixels) continue;
      best[k] = own;
      best_view[k] = views;
    }
  }
  for (size_t k = 0; k < kShownClasses.size(); ++k) {
    if (best[k].pixels == 0) continue;
    crops.push_back(CropsAt(folder, variants, best_view[k], best[k].part));
    crops.back().id = kShownClasses[k].id;
    crops.back().title = kShownClasses[k].title;
  }
  if (classes_known) return crops;
  std::vector<int> middle;  // evenly spread over the views
  const size_t shown = std::min(kOtherViews, static_cast<size_t>(views));
  for (size_t i = 0; i < shown; ++i) middle.push_back(static_cast<int>((2 * i + 1) * static_cast<size_t>(views) / (2 * shown)));
  for (const int view : middle) {
    int width = 0, height = 0;
    image::ReadImageSize(*SavedView(folder, results.front(), view, "photo"), &width, &height);
    const int w = PartWidth(width), h = std::min(PartHeight(width), height);
    crops.push_back(CropsAt(folder, variants, view, {(width - w) / 2, (height - h) / 2, w, h}));
    crops.back().id = fmt::format("photo_{}", crops.size());
    crops.back().title = fmt::format("Middle of photo {}", crops.size());
  }
  return crops;
}

std::vector<BenchSection> WritePriorPictures(const std::vector<PriorCrops>& crops, const std::filesystem::path& folder) {
  std::vector<BenchSection> sections;
  if (crops.empty()) return sections;
  base::RequireWritableFolder(folder / "priors_images");
  std::vector<std::vector<CaptionedImage>> rows;
  for (const PriorCrops& of : crops) {
    BenchSection section{.id = "crops_" + of.id,
                         .title = of.title,
                         .lead =
                             "A part of one held-out photo of the first seed, and the same part of its renderings, enlarged without smoothing. Below "
                             "are the normals of the surface: red, green and blue are their components to the east, north and up.",
                         .charts = {},
                         .tables = {},
                         .pictures = {},
                         .magnified = false};
    for (const std::vector<CaptionedImage>* row : {&of.colors, &of.normals}) {
      for (size_t i = 0; i < row->size(); ++i) {
        const std::string file = fmt::format("priors_images/{}_{}_{}.png", of.id, row == &of.colors ? "colors" : "normals", i);
        image::SavePng((*row)[i].image, folder / file);
        section.pictures.push_back({file, (*row)[i].caption});
      }
    }
    sections.push_back(std::move(section));
    rows.push_back(of.colors);
    rows.push_back(of.normals);
    rows[rows.size() - 2].front().caption = of.title + ": photo";
  }
  image::SavePng(PictureSheet(rows), folder / "priors.png");
  return sections;
}

}  // namespace skyquilt::bench
