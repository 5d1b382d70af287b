#include "evaluate/metrics/metrics.h"

#include <algorithm>

namespace skyquilt::evaluate::metrics {

const char* const kCoverageDefinition =
    "Coverage: covered pixels divided by the pixels that the photo's mask does not exclude. The surface point of a pixel is where its rendered ray "
    "becomes half opaque, moved along the ray into the height range of the blocks, so that neither floaters nor holes change what counts. The pixel "
    "is covered when this point lies inside the blocks and inside the unmasked frame of at least two training photos. Whether something hides the "
    "point from these photos is not tested. Where photos look level, sky is not covered: rays above all sparse points on their side that meet "
    "nothing "
    "within the heights.";
const char* const kPsnrDefinition =
    "PSNR, SSIM and FLIP: computed per held-out photo over its covered pixels in sRGB display values, then averaged over the photos. Full frame: the "
    "same over every pixel that no mask excludes. PSNR of a block: from the squared errors of all covered pixels of all held-out photos whose "
    "surface point lies in the block's core box, seen from above.";
const char* const kSeamDefinition =
    "Seam gap: PSNR of covered pixels whose surface point lies inside a block, farther from its border than the margin, minus PSNR of those where "
    "two or more blocks with their margins overlap. Strong texture is harder to render, and there may be more of it in one of the two. So the pixels "
    "are sorted into eight classes by the photo's gradient (each class twice the one before), and the squared errors inside are weighted to the "
    "number of seam pixels in each class. Pixels near the outer border of the survey belong to neither. There is no seam gap with a single block.";
const char* const kRightHalfDefinition =
    "PSNR of right halves: mean over photos of the PSNR over the covered pixels of the right half, rendered as for PSNR. With fitted gains: the same "
    "pixels after three gains in linear light, one per colour, were fitted to the left half of the photo. The difference is what tags and training "
    "do not know about the brightness of the photo.";

const BlockScore* Metrics::FindBlock(const std::string& name) const {
  const auto match = std::find_if(blocks.begin(), blocks.end(), [&](const BlockScore& block) { return block.name == name; });
  return match == blocks.end() ? nullptr : &*match;
}

}  // namespace skyquilt::evaluate::metrics
