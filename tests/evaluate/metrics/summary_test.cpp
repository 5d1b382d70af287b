#include "evaluate/metrics/summary.h"

#include <gtest/gtest.h>

#include <cmath>

namespace skyquilt::evaluate::metrics {
namespace {

photos::ScoredPhoto Photo(double psnr_db, int64_t covered_pixels) {
  photos::ScoredPhoto photo;
  photo.findings.score.psnr_db = psnr_db;
  photo.findings.score.used_pixels = 100;
  photo.findings.score.covered_pixels = covered_pixels;
  photo.findings.per_block = {{1.0, 3}, {2.0, 6}};
  return photo;
}

TEST(Scores, MeansAreOverPhotosAndSharesOverPixels) {
  Scores scores(2);
  EXPECT_TRUE(std::isnan(scores.Psnr()));
  EXPECT_TRUE(std::isnan(scores.Coverage()));
  scores.Add(Photo(20.0, 100));
  scores.Add(Photo(30.0, 50));
  scores.Add(Photo(kNotMeasured, 0));
  EXPECT_DOUBLE_EQ(scores.Psnr(), 25.0);
  EXPECT_DOUBLE_EQ(scores.Coverage(), 0.5);
  ASSERT_EQ(scores.photos.size(), 3U);
  EXPECT_DOUBLE_EQ(scores.per_block[1].sum, 6.0);
  EXPECT_EQ(scores.per_block[1].n_values, 18);
}

}  // namespace
}  // namespace skyquilt::evaluate::metrics
