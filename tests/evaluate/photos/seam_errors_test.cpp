#include "evaluate/photos/seam_errors.h"

#include <gtest/gtest.h>

#include <cmath>

namespace skyquilt::evaluate::photos {
namespace {

skyquilt::metrics::SquaredError Errors(double mean, int64_t n_values) {
  return {mean * static_cast<double>(n_values), n_values};
}

TEST(SeamErrors, EqualQualityPerTextureIsNoGap) {
  // Rough ground has ten times the error of smooth ground, inside and in seams; the seams happen to be on rough ground.
  SeamErrors errors;
  errors.interior[0] = Errors(1e-4, 3000);
  errors.interior[5] = Errors(1e-3, 300);
  errors.seam[0] = Errors(1e-4, 30);
  errors.seam[5] = Errors(1e-3, 900);
  EXPECT_NEAR(errors.GapDb(), 0.0, 1e-9);
  EXPECT_GT(skyquilt::metrics::PsnrOf(errors.AllInterior()) - skyquilt::metrics::PsnrOf(errors.AllSeam()), 5.0);
}

TEST(SeamErrors, SeesWorseSeams) {
  SeamErrors errors;
  errors.interior[2] = Errors(1e-3, 300);
  errors.seam[2] = Errors(2e-3, 30);
  EXPECT_NEAR(errors.GapDb(), 10.0 * std::log10(2.0), 1e-9);
}

TEST(SeamErrors, LeavesOutClassesOfOneSideOnly) {
  SeamErrors errors;
  errors.interior[2] = Errors(1e-3, 300);
  errors.seam[2] = Errors(1e-3, 30);
  errors.seam[7] = Errors(1.0, 30);
  EXPECT_NEAR(errors.GapDb(), 0.0, 1e-9);
  EXPECT_TRUE(std::isnan(SeamErrors().GapDb()));
}

TEST(SeamErrors, Adds) {
  SeamErrors a, b;
  a.seam[1] = Errors(1e-3, 30);
  b.seam[1] = Errors(3e-3, 30);
  b.interior[4] = Errors(1e-2, 3);
  a += b;
  EXPECT_EQ(a.AllSeam().n_values, 60);
  EXPECT_NEAR(a.AllSeam().sum, 0.12, 1e-12);
  EXPECT_EQ(a.AllInterior().n_values, 3);
}

TEST(TextureClass, DoublesFromClassToClass) {
  const auto ramp = [](float slope) {
    image::ImageF photo(5, 5, 3);
    for (int y = 0; y < 5; ++y) {
      for (int x = 0; x < 5; ++x) {
        for (int c = 0; c < 3; ++c) photo.At(x, y)[c] = slope * static_cast<float>(x);
      }
    }
    return photo;
  };
  EXPECT_EQ(TextureClass(ramp(0.0F), 2, 2), 0);
  EXPECT_EQ(TextureClass(ramp(0.007F), 2, 2), 0);
  EXPECT_EQ(TextureClass(ramp(0.01F), 2, 2), 1);
  EXPECT_EQ(TextureClass(ramp(0.02F), 2, 2), 2);
  EXPECT_EQ(TextureClass(ramp(0.04F), 2, 2), 3);
  EXPECT_EQ(TextureClass(ramp(0.9F), 2, 2), 7);
  // The edge's pixel is repeated: half the slope.
  EXPECT_EQ(TextureClass(ramp(0.01F), 0, 2), 0);
}

}  // namespace
}  // namespace skyquilt::evaluate::photos
