#include "evaluate/trust/sparsification.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/random.h"

namespace skyquilt::evaluate::trust {
namespace {

std::vector<float> Errors(size_t n) {
  base::Random random(7);
  std::vector<float> errors(n);
  for (float& error : errors) error = random.Uniform() * random.Uniform();
  return errors;
}

TEST(Ause, IsZeroForTheTrueOrderAndGrowsWithDisorder) {
  const std::vector<float> errors = Errors(5000);
  std::vector<float> noisy = errors, wrong = errors;
  base::Random random(8);
  for (float& value : noisy) value += 0.3F * random.Uniform();
  for (float& value : wrong) value = -value;
  const std::vector<float> same(errors.size(), 1.0F);
  EXPECT_EQ(Ause(errors, errors), 0.0);
  EXPECT_GT(Ause(noisy, errors), 0.02);
  EXPECT_GT(Ause(same, errors), Ause(noisy, errors));
  EXPECT_GT(Ause(wrong, errors), Ause(same, errors));
}

TEST(Ause, OfTwoKindsOfPixelsIsWhatTheFormulaGives) {
  // Half of the pixels have no error. Without order the root mean square stays at that of all; in the true order it is sqrt((0.5 - s) / (1 - s) /
  // 0.5) of it for shares s below one half, and zero above.
  std::vector<float> errors(10000);
  for (size_t i = 0; i < errors.size(); i += 2) errors[i] = 0.04F;
  double truth = 0.0;
  for (int share = 0; share < 50; ++share) {
    const double s = 0.01 * share;
    truth += std::sqrt((0.5 - s) / (1.0 - s) / 0.5) / 100.0;
  }
  EXPECT_NEAR(Ause(std::vector<float>(errors.size(), 0.0F), errors), 1.0 - truth, 1e-3);
}

TEST(Ause, IsNotMeasuredWithoutErrors) {
  EXPECT_TRUE(std::isnan(Ause({}, {})));
  EXPECT_TRUE(std::isnan(Ause(std::vector<float>(5, 1.0F), std::vector<float>(5, 0.0F))));
  EXPECT_EQ(ScoreTrust({}).pixels, 0U);
}

RC_GTEST_PROP(Ause, DependsOnTheOrderAlone, ()) {
  const std::vector<float> errors = Errors(static_cast<size_t>(*rc::gen::inRange(2, 300)));
  std::vector<float> doubt;
  for (size_t i = 0; i < errors.size(); ++i) doubt.push_back(0.01F * static_cast<float>(*rc::gen::inRange(0, 1000)));
  std::vector<float> other = doubt;
  for (float& value : other) value = std::exp(value) + 3.0F;
  const double ause = Ause(doubt, errors);
  RC_ASSERT(std::abs(ause - Ause(other, errors)) < 1e-9);
  RC_ASSERT(ause >= -1e-9);
}

TEST(TrustScores, SayHowGoodTrustIs) {
  TrustPixels pixels;
  pixels.squared_error = Errors(20000);
  base::Random random(9);
  for (const float error : pixels.squared_error) {
    pixels.expected.push_back(std::sqrt(error));
    pixels.photos.push_back(10.0F * random.Uniform());
    pixels.gradient.push_back(random.Uniform());
    pixels.opacity.push_back(random.Uniform());
  }
  const TrustScores scores = ScoreTrust(pixels);
  EXPECT_EQ(scores.pixels, 20000U);
  EXPECT_NEAR(scores.ause, 0.0, 1e-6);
  EXPECT_GT(scores.ause_photos, 0.2);
  EXPECT_GT(scores.ause_gradient, 0.2);
  EXPECT_GT(scores.ause_opacity, 0.2);
  EXPECT_GT(scores.least_over_most, 50.0);
  EXPECT_NEAR(scores.expected_rms, scores.found_rms, 1e-6);
}

TEST(TrustPixels, GoThroughBytes) {
  TrustPixels pixels{{0.1F, 0.2F}, {0.3F, 0.4F}, {5.0F, 6.0F}, {0.7F, 0.8F}, {0.9F, 1.0F}}, more;
  base::BytePacker out;
  pixels.Save(&out);
  base::ByteUnpacker in(out.bytes(), "bytes");
  more.Load(&in);
  in.End();
  more.Add(pixels);
  EXPECT_EQ(more.expected, (std::vector<float>{0.3F, 0.4F, 0.3F, 0.4F}));
  EXPECT_EQ(more.opacity.size(), 4U);
}

}  // namespace
}  // namespace skyquilt::evaluate::trust
