#include "evaluate/metrics.h"

#include <algorithm>
#include <cmath>

#include "core/base/order_statistics.h"

namespace skyquilt::evaluate {

const char* const kCoverageDefinition =
    "A pixel's surface point is where its rendered ray becomes half opaque, moved along the ray into the height range of the scene's blocks "
    "(so that floaters and holes do not change which pixels count). The pixel is covered when that point is inside the area of the scene's blocks "
    "and inside the unmasked image of at least two training photos; occlusion between photos is not tested. "
    "coverage = covered pixels / pixels that the photo's mask does not exclude.";
const char* const kPsnrDefinition =
    "psnr, ssim: computed per held-out photo over its covered pixels in sRGB display values, then averaged over photos. "
    "*_full_frame: the same over every pixel that is not masked. psnr_per_block: from the squared errors of all covered pixels of all held-out "
    "photos whose surface point is in the block's core box, seen from above.";
const char* const kSeamDefinition =
    "seam_psnr_gap_db = PSNR of covered pixels whose surface point is farther than the margin inside a block, minus PSNR of those where the boxes of "
    "two or more blocks overlap with their margins. To compare equal textures, the interior's squared errors are averaged per class of the photo's "
    "gradient (eight classes, each twice the one before) and weighted by the seams' share of each class. Pixels near the outer edge of the survey "
    "are in neither group. Null with a single block.";
const char* const kRightHalfDefinition =
    "psnr_right_half: mean over photos of the PSNR over the covered pixels of the right half, rendered as for psnr. psnr_right_half_fitted: the same "
    "pixels after three gains in linear light, one per colour, were fitted to the left half of the photo; the difference is the error of the photo's "
    "brightness as known from tags and training.";

double PhotoScore::Coverage() const {
  return used_pixels > 0 ? static_cast<double>(covered_pixels) / static_cast<double>(used_pixels) : kNotMeasured;
}

const BlockScore* Metrics::FindBlock(const std::string& name) const {
  const auto match = std::find_if(blocks.begin(), blocks.end(), [&](const BlockScore& block) { return block.name == name; });
  return match == blocks.end() ? nullptr : &*match;
}

double MeanOfMeasured(const std::vector<double>& values) {
  double sum = 0.0;
  int n = 0;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    sum += value;
    ++n;
  }
  return n > 0 ? sum / n : kNotMeasured;
}

double MedianOfMeasured(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  return values.empty() ? kNotMeasured : base::Median(std::move(values));
}

}  // namespace skyquilt::evaluate
