#include "core/metrics/depth_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/not_finite.h"

namespace skyquilt::metrics {
namespace {

using image::Image8;
using image::ImageF;

ImageF Row(const std::vector<float>& values) {
  ImageF image(static_cast<int>(values.size()), 1, 1);
  image.data = values;
  return image;
}

TEST(DepthErrors, AreRootMeanSquareAndMedian) {
  const DepthErrors errors = CompareDepth(Row({11.0F, 8.0F, 10.0F, 20.0F}), Row({10.0F, 10.0F, 10.0F, 10.0F}), nullptr);
  EXPECT_EQ(errors.n, 4);
  EXPECT_NEAR(errors.rmse_m, std::sqrt((1.0 + 4.0 + 0.0 + 100.0) / 4.0), 1e-12);
  EXPECT_NEAR(errors.median_abs_m, 1.5, 1e-12);
  EXPECT_NEAR(CompareDepth(Row({11.0F, 8.0F, 20.0F}), Row({10.0F, 10.0F, 10.0F}), nullptr).median_abs_m, 2.0, 1e-12);
}

TEST(DepthErrors, SkipGapsAndMaskedPixels) {
  Image8 mask(5, 1, 1, 255);
  *mask.At(4, 0) = 0;
  const DepthErrors errors = CompareDepth(Row({kNanFloat, 12.0F, 10.5F, std::numeric_limits<float>::infinity(), 99.0F}),
                                          Row({10.0F, kNanFloat, 10.0F, 10.0F, 10.0F}), &mask);
  EXPECT_EQ(errors.n, 1);
  EXPECT_EQ(errors.n_missing, 2);
  EXPECT_NEAR(errors.rmse_m, 0.5, 1e-12);
}

TEST(DepthErrors, OfNothingAreNotANumber) {
  const DepthErrors errors = CompareDepth(Row({kNanFloat}), Row({5.0F}), nullptr);
  EXPECT_EQ(errors.n, 0);
  EXPECT_EQ(errors.n_missing, 1);
  EXPECT_TRUE(std::isnan(errors.rmse_m));
  EXPECT_TRUE(std::isnan(errors.median_abs_m));
}

TEST(DepthErrors, OfSeveralPhotosAreThoseOfAllPixels) {
  DepthErrorCollector collector;
  collector.Add(Row({1.0F, 2.0F}), Row({0.0F, 0.0F}), nullptr);
  collector.Add(Row({3.0F, 4.0F, 5.0F}), Row({0.0F, 0.0F, 0.0F}), nullptr);
  EXPECT_EQ(collector.Result().n, 5);
  EXPECT_NEAR(collector.Result().median_abs_m, 3.0, 1e-12);
  EXPECT_NEAR(collector.Result().rmse_m, std::sqrt(11.0), 1e-12);
}

TEST(DepthErrors, GoOnFromSavedOnes) {
  DepthErrorCollector whole, first, second;
  const ImageF truth = Row({0.0F, 0.0F, 0.0F}), near = Row({1.0F, kNanFloat, 0.1F}), far = Row({0.3F, 4e7F, kInfinityFloat});
  whole.Add(near, truth, nullptr);
  whole.Add(far, truth, nullptr);
  first.Add(near, truth, nullptr);
  base::BytePacker saved;
  first.Save(&saved);
  second.Add(far, truth, nullptr);  // forgotten
  base::ByteUnpacker in(saved.bytes(), "damaged");
  second.Load(&in);
  EXPECT_NO_THROW(in.End());
  second.Add(far, truth, nullptr);
  EXPECT_EQ(second.Result().rmse_m, whole.Result().rmse_m);
  EXPECT_EQ(second.Result().median_abs_m, whole.Result().median_abs_m);
  EXPECT_EQ(second.Result().n, whole.Result().n);
  EXPECT_EQ(second.Result().n_missing, 2);
}

}  // namespace
}  // namespace skyquilt::metrics
