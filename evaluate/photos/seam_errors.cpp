#include "evaluate/photos/seam_errors.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::evaluate::photos {
namespace {

skyquilt::metrics::SquaredError Sum(const std::array<skyquilt::metrics::SquaredError, kTextureClasses>& classes) {
  skyquilt::metrics::SquaredError sum;
  for (const skyquilt::metrics::SquaredError& one : classes) sum += one;
  return sum;
}

// Both groups over the classes they have in common, the interior weighted like the seams.
struct Matched {
  skyquilt::metrics::SquaredError interior, seam;

  explicit Matched(const SeamErrors& errors) {
    for (size_t k = 0; k < kTextureClasses; ++k) {
      const skyquilt::metrics::SquaredError& inside = errors.interior[k];
      const skyquilt::metrics::SquaredError& at_seam = errors.seam[k];
      if (inside.n_values == 0 || at_seam.n_values == 0) continue;
      interior.sum += inside.sum / static_cast<double>(inside.n_values) * static_cast<double>(at_seam.n_values);
      interior.n_values += at_seam.n_values;
      seam += at_seam;
    }
  }
};

}  // namespace

int TextureClass(const image::ImageF& photo, int x, int y) {
  const auto grey = [&photo](int column, int row) {
    const float* rgb = photo.At(std::clamp(column, 0, photo.width - 1), std::clamp(row, 0, photo.height - 1));
    return (rgb[0] + rgb[1] + rgb[2]) / 3.0F;
  };
  const float gradient = 0.5F * std::hypot(grey(x + 1, y) - grey(x - 1, y), grey(x, y + 1) - grey(x, y - 1));
  int texture = 0;
  for (float edge = 1.0F / 128.0F; texture + 1 < kTextureClasses && gradient >= edge; edge *= 2.0F) ++texture;
  return texture;
}

SeamErrors& SeamErrors::operator+=(const SeamErrors& other) {
  for (size_t k = 0; k < kTextureClasses; ++k) {
    interior[k] += other.interior[k];
    seam[k] += other.seam[k];
  }
  return *this;
}

skyquilt::metrics::SquaredError SeamErrors::AllInterior() const {
  return Sum(interior);
}

skyquilt::metrics::SquaredError SeamErrors::AllSeam() const {
  return Sum(seam);
}

double SeamErrors::MatchedInteriorDb() const {
  return skyquilt::metrics::PsnrOf(Matched(*this).interior);
}

double SeamErrors::GapDb() const {
  const Matched matched(*this);
  return skyquilt::metrics::PsnrOf(matched.interior) - skyquilt::metrics::PsnrOf(matched.seam);
}

}  // namespace skyquilt::evaluate::photos
