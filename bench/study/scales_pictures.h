// Crops of renderings at small widths, enlarged without smoothing so that aliasing can be seen.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/bench_page.h"
#include "bench/study/picture_sheet.h"
#include "bench/study/scales_parts.h"
#include "core/image/image.h"

namespace skyquilt::bench {

// The same crop of the photo and of the rendering by each method, at one width. Writes NAME_*.png into folder/scales_images. All images are missing,
// and so is the section's list, when the pictures of the first training are gone. folder: of the page, in which the study lies. runs: folder of the
// study relative to it, with a '/' at the end or empty.
struct CropRequest {
  std::filesystem::path folder;
  std::string runs;
  std::string id, title;
  std::string group;
  int divisor = 1;
  int pixels = 80;       // width of the crop
  bool averaged = true;  // also k x k rays of the first method
};
BenchSection CropSection(const std::vector<MethodResults>& methods, const CropRequest& request);

// Writes folder/scales.png: photo, points, cones, and points with k x k rays, at the given divisors. Nothing without points and cones.
void WriteScaleSheet(const std::vector<MethodResults>& methods, const std::vector<int>& divisors, const std::filesystem::path& folder);

}  // namespace skyquilt::bench
