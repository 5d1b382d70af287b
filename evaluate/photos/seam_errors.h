// Measures how much worse a scene is in the seams between blocks than inside them. Squared errors are kept by class of texture, because errors in a
// forest are larger than in a meadow, wherever the seam is.
#pragma once

#include <array>
#include <cstdint>

#include "core/image/image.h"
#include "core/metrics/psnr.h"

namespace skyquilt::evaluate::photos {

constexpr int kTextureClasses = 8;

// Class of a pixel of the true photo (RGB, display values) by its grey gradient (central differences, edge pixels repeated). Class 0: less than 1/128
// per pixel; the limit doubles from class to class; class 7: at least 1/2.
int TextureClass(const image::ImageF& photo, int x, int y);

struct SeamErrors {
  std::array<skyquilt::metrics::SquaredError, kTextureClasses> interior{}, seam{};

  SeamErrors& operator+=(const SeamErrors& other);
  skyquilt::metrics::SquaredError AllInterior() const;
  skyquilt::metrics::SquaredError AllSeam() const;
  // PSNR of the interior in dB, weighted to have the textures of the seams. Classes missing in one of the groups are left out. NaN when the groups
  // have no class in common.
  double MatchedInteriorDb() const;
  // MatchedInteriorDb() minus the PSNR of the seams over the same classes; NaN likewise.
  double GapDb() const;
};

}  // namespace skyquilt::evaluate::photos
