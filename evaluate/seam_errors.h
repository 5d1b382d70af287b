// How much worse a scene is where blocks meet: squared errors inside blocks and in seams, by class of texture, because a seam through a wood must
// not be measured against the inside of a meadow.
#pragma once

#include <array>
#include <cstdint>

#include "core/image/image.h"
#include "core/metrics/psnr.h"

namespace skyquilt::evaluate {

constexpr int kTextureClasses = 8;

// Class of a pixel of the true photo (RGB, display values): its grey gradient by central differences, doubling from class to class. Class 0 is
// less than 1/128 per pixel, class 7 at least 1/2. Beyond the frame the edge's pixel is repeated.
int TextureClass(const image::ImageF& photo, int x, int y);

struct SeamErrors {
  std::array<metrics::SquaredError, kTextureClasses> interior{}, seam{};

  SeamErrors& operator+=(const SeamErrors& other);
  metrics::SquaredError AllInterior() const;
  metrics::SquaredError AllSeam() const;
  // PSNR inside blocks, dB, if the interior had the seams' textures; classes that are missing on one side are left out on both.
  // NaN when no class is on both sides.
  double MatchedInteriorDb() const;
  // MatchedInterior_db less the PSNR of the seams over the same classes; NaN likewise.
  double GapDb() const;
};

}  // namespace skyquilt::evaluate
