#include "evaluate/photos/tile_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/brightness/exposure.h"
#include "evaluate/photos/alternate_tiles.h"

namespace skyquilt::evaluate::photos {
namespace {

constexpr int kWidth = 160, kHeight = 112;

float Pattern(int x, int y, int c) {
  return 0.45F + 0.15F * std::sin(0.31F * static_cast<float>(x + 5 * c)) * std::cos(0.23F * static_cast<float>(y));
}

double LogLight(int x) {
  return 0.35 * std::tanh((x - 70) / 25.0);  // a shadow to the left
}

struct Pair {
  image::ImageF render = image::ImageF(kWidth, kHeight, 3), photo = image::ImageF(kWidth, kHeight, 3);
  image::Image8 scored = image::Image8(kWidth, kHeight, 1, 1);
};

Pair ShadedPair() {
  Pair pair;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < 3; ++c) {
        pair.render.At(x, y)[c] = Pattern(x, y, c);
        const auto exposure = brightness::Exposure::FromLogGain(static_cast<float>(LogLight(x) + 0.1 * (c - 1)));
        pair.photo.At(x, y)[c] = brightness::Expose(Pattern(x, y, c), exposure).value;
      }
    }
  }
  return pair;
}

TEST(AlternateTiles, AreACheckerboard) {
  EXPECT_TRUE(IsFittedTile(0, 0));
  EXPECT_TRUE(IsFittedTile(15, 15));
  EXPECT_FALSE(IsFittedTile(16, 0));
  EXPECT_FALSE(IsFittedTile(0, 16));
  EXPECT_TRUE(IsFittedTile(16, 31));
  EXPECT_TRUE(IsFittedTile(8, 8, 4));
  EXPECT_FALSE(IsFittedTile(4, 8, 4));
}

TEST(TileFit, RegainsWhatGainsAndAShadowTook) {
  const Pair pair = ShadedPair();
  const TileScores scores = ScoreAlternateTiles(pair.render, pair.photo, pair.scored, {8, 6}, 0.35);
  const double rendered = skyquilt::metrics::PsnrOf(scores.rendered), gains = skyquilt::metrics::PsnrOf(scores.gains);
  EXPECT_GT(gains, rendered + 0.3);
  EXPECT_GT(skyquilt::metrics::PsnrOf(scores.shaded), gains + 12.0);
  EXPECT_EQ(scores.shaded.n_values, 3 * kWidth * kHeight / 2);
  EXPECT_NEAR(scores.log_gain[2] - scores.log_gain[0], 0.2F, 0.01F);
  EXPECT_NEAR(scores.log_shading[7] - scores.log_shading[0], LogLight(kWidth) - LogLight(0), 0.12);
}

TEST(TileFit, DoesNotReadTheTilesThatItScores) {
  Pair pair = ShadedPair();
  const TileScores before = ScoreAlternateTiles(pair.render, pair.photo, pair.scored, {8, 6}, 0.35);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (!IsFittedTile(x, y)) pair.photo.At(x, y)[1] = 0.9F;
    }
  }
  const TileScores after = ScoreAlternateTiles(pair.render, pair.photo, pair.scored, {8, 6}, 0.35);
  EXPECT_EQ(before.log_shading, after.log_shading);
  EXPECT_EQ(before.log_gain, after.log_gain);
  EXPECT_LT(skyquilt::metrics::PsnrOf(after.shaded), skyquilt::metrics::PsnrOf(before.shaded) - 3.0);
}

TEST(TileFit, FitsNothingWhereNothingIsScoredOrAllIsWhite) {
  Pair pair = ShadedPair();
  pair.scored = image::Image8(kWidth, kHeight, 1, 0);
  const TileScores none = ScoreAlternateTiles(pair.render, pair.photo, pair.scored, {8, 6}, 0.35);
  EXPECT_EQ(none.shaded.n_values, 0);
  pair.scored = image::Image8(kWidth, kHeight, 1, 1);
  pair.photo = image::ImageF(kWidth, kHeight, 3, 1.0F);
  const TileScores white = ScoreAlternateTiles(pair.render, pair.photo, pair.scored, {8, 6}, 0.35);
  EXPECT_EQ(white.log_gain[0], 0.0F);
  for (const float value : white.log_shading) EXPECT_EQ(value, 0.0F);
}

}  // namespace
}  // namespace skyquilt::evaluate::photos
