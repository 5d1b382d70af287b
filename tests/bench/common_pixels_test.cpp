#include "bench/study/common_pixels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/random.h"
#include "core/metrics/psnr.h"
#include "evaluate/photos/scored_pixels.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::bench {
namespace {

constexpr int kSize = 64;

image::Image8 NoisyRender(const image::Image8& photo, int amplitude, uint64_t seed) {
  base::Random random(seed);
  image::Image8 render = photo;
  for (uint8_t& value : render.data) {
    const int noise = static_cast<int>(random.Below(static_cast<uint32_t>(2 * amplitude + 1))) - amplitude;
    value = static_cast<uint8_t>(std::clamp(value + noise, 0, 255));
  }
  return render;
}

// Of columns [first, last).
image::Image8 Columns(int first, int last) {
  image::Image8 mask(kSize, kSize, 1);
  for (int y = 0; y < kSize; ++y) {
    for (int x = first; x < last; ++x) *mask.At(x, y) = 1;
  }
  return mask;
}

double PsnrOver(const image::Image8& photo, const image::Image8& render, const image::Image8& mask) {
  return metrics::Psnr(image::ToImageF(photo), image::ToImageF(render), &mask);
}

// Of errors as pictures keep them, in 8 bits.
double PsnrOfRounded(const image::Image8& photo, const image::Image8& render, const image::Image8& mask) {
  const image::Image8 picture = evaluate::photos::ScoredPixels(photo, render, mask);
  double sum = 0.0, n = 0.0;
  for (const uint8_t value : picture.data) {
    if (value == 0) continue;
    sum += evaluate::photos::SquaredErrorOf(value);
    n += 1.0;
  }
  return -10.0 * std::log10(sum / n);
}

class CommonPixels : public testing::Test {
 protected:
  void Save(const std::string& variant, const std::string& photo, const image::Image8& render, const image::Image8& mask) {
    const std::filesystem::path file = folder_ / "runs" / variant / "covered" / (photo + ".png");
    base::RequireWritableFolder(file.parent_path());
    image::SavePng(evaluate::photos::ScoredPixels(photo_, render, mask), file);
  }
  static VariantResult Result(const std::string& name) {
    VariantResult result;
    result.name = name;
    result.psnr_db = 25.0;
    return result;
  }
  void Score(std::vector<VariantResult>& results) {
    std::vector<VariantResult*> pointers;
    for (VariantResult& result : results) pointers.push_back(&result);
    ScoreCommonPixels(folder_.path(), pointers);
  }

  const TemporaryFolder folder_;
  const image::Image8 photo_ = image::Image8(kSize, kSize, 3, 120);
};

TEST(ScoredPixels, KeepSmallAndLargeErrors) {
  const image::Image8 photo(kSize, kSize, 3, 120), all = Columns(0, kSize);
  for (const auto& [amplitude, off_db] : {std::pair{2, 0.1}, {5, 0.05}, {20, 0.02}, {110, 0.01}}) {
    const image::Image8 render = NoisyRender(photo, amplitude, 3);
    const image::Image8 pixels = evaluate::photos::ScoredPixels(photo, render, all);
    metrics::SquaredError error;
    for (const uint8_t value : pixels.data) error += {evaluate::photos::SquaredErrorOf(value), 1};
    EXPECT_NEAR(metrics::PsnrOf(error), PsnrOver(photo, render, all), off_db) << amplitude;
  }
  const image::Image8 white(2, 2, 3, 255), black(2, 2, 3, 0);
  EXPECT_EQ(evaluate::photos::ScoredPixels(white, black, image::Image8(2, 2, 1, 1)).data, std::vector<uint8_t>(4, 255));
  EXPECT_EQ(evaluate::photos::ScoredPixels(white, white, image::Image8(2, 2, 1, 1)).data, std::vector<uint8_t>(4, 1)) << "scored, without error";
  EXPECT_EQ(evaluate::photos::ScoredPixels(white, black, image::Image8(2, 2, 1, 0)).data, std::vector<uint8_t>(4, 0));
}

TEST_F(CommonPixels, AreThoseThatAllVariantsScore) {
  image::Image8 first = NoisyRender(photo_, 10, 1), second = NoisyRender(photo_, 20, 2);
  const image::Image8 west = Columns(0, 40), east = Columns(24, kSize), middle = Columns(24, 40);
  // Where only one is scored it is far better than where both are: its own score says nothing about the other.
  for (int y = 0; y < kSize; ++y) std::copy_n(photo_.At(0, y), 3 * 24, first.At(0, y));
  Save("first", "flight/a.jpg", first, west);
  Save("second", "flight/a.jpg", second, east);
  Save("first", "flight/b.jpg", second, west);
  Save("second", "flight/b.jpg", second, east);
  std::vector<VariantResult> results = {Result("first"), Result("second")};
  Score(results);
  const double same_db = PsnrOver(photo_, second, middle);
  EXPECT_NEAR(results[0].psnr_common_db, 0.5 * (PsnrOver(photo_, first, middle) + same_db), 0.03) << "mean over photos, not over pixels";
  EXPECT_NEAR(results[1].psnr_common_db, same_db, 0.03);
  EXPECT_EQ(results[0].psnr_db, 25.0);
}

TEST_F(CommonPixels, ThatOneHasNoneOfMakeNoScore) {
  Save("first", "a.jpg", NoisyRender(photo_, 10, 1), Columns(0, 30));
  Save("second", "a.jpg", NoisyRender(photo_, 10, 2), Columns(30, kSize));
  std::vector<VariantResult> results = {Result("first"), Result("second")};
  Score(results);
  EXPECT_TRUE(std::isnan(results[0].psnr_common_db));
}

TEST_F(CommonPixels, AreOnlyOfComparableVariants) {
  const image::Image8 render = NoisyRender(photo_, 10, 1), all = Columns(0, kSize);
  for (const char* name : {"first", "second", "failed"}) Save(name, "a.jpg", render, name == std::string("failed") ? Columns(0, 1) : all);
  Save("other_photos", "b.jpg", render, all);
  base::RequireWritableFolder(folder_ / "runs/other_size/covered");
  image::SavePng(image::Image8(32, 32, 1, 9), folder_ / "runs/other_size/covered/a.jpg.png");
  std::vector<VariantResult> results;
  for (const char* name : {"first", "other_photos", "other_size", "older_program", "failed", "second"}) results.push_back(Result(name));
  results[4].failure = "no memory";
  Score(results);
  for (const size_t i : {size_t{0}, size_t{5}}) EXPECT_NEAR(results[i].psnr_common_db, PsnrOver(photo_, render, all), 0.03) << i;
  for (size_t i = 1; i < 5; ++i) EXPECT_TRUE(std::isnan(results[i].psnr_common_db)) << results[i].name;
  // One variant alone is compared with nothing.
  results.resize(1);
  Score(results);
  EXPECT_TRUE(std::isnan(results[0].psnr_common_db));
}

TEST_F(CommonPixels, OfSeveralSeedsAreCommonToAllTrainings) {
  const image::Image8 all = Columns(0, kSize);
  std::vector<VariantResult> results = {Result("small"), Result("large")};
  int amplitude = 8;
  for (VariantResult& result : results) {
    for (const char* seed : {"", "_s2", "_s3"}) {
      result.seeds.push_back(Result(result.name + seed));
      Save(result.seeds.back().name, "a.jpg", NoisyRender(photo_, amplitude, 1), result.seeds.size() == 2 ? Columns(8, kSize) : all);
      amplitude += 8;
    }
  }
  Score(results);
  EXPECT_NEAR(results[0].seeds[0].psnr_common_db, PsnrOfRounded(photo_, NoisyRender(photo_, 8, 1), Columns(8, kSize)), 1e-9);
  EXPECT_EQ(results[0].psnr_common_db, results[0].seeds[1].psnr_common_db) << "the median";
  EXPECT_EQ(results[1].psnr_common_db, results[1].seeds[1].psnr_common_db);
  EXPECT_GT(results[0].psnr_common_db, results[1].psnr_common_db);
}

TEST_F(CommonPixels, NeedReadablePictures) {
  for (const char* name : {"first", "second"}) Save(name, "a.jpg", photo_, Columns(0, 9));
  base::WriteFileAtomically(folder_ / "runs/second/covered/a.jpg.png", "not a picture");
  std::vector<VariantResult> results = {Result("first"), Result("second")};
  EXPECT_THROW(Score(results), base::InputError);
}

}  // namespace
}  // namespace skyquilt::bench
