#include "prepare/poses/retrieval.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/prepare/poses/made_photos.h"
#include "tests/support/error_of.h"

namespace skyquilt::prepare::poses {
namespace {

constexpr size_t kPlaces = 2, kPhotosPerPlace = 15, kIndexedPhotos = kPlaces * kPhotosPerPlace;

// Photo i shows place i % 2: half of that place's features, and as many that no other photo has.
std::vector<std::vector<uint8_t>> TwoPlaces(uint64_t seed) {
  base::Random random(seed);
  std::vector<std::vector<std::array<uint8_t, 128>>> place(kPlaces);
  for (auto& features : place) {
    for (int i = 0; i < 300; ++i) features.push_back(test::RandomDescriptor(random));
  }
  std::vector<std::vector<uint8_t>> photos(kIndexedPhotos);
  for (size_t photo = 0; photo < kIndexedPhotos; ++photo) {
    for (const auto& feature : place[photo % kPlaces]) {
      test::AddRow(photos[photo], random.Below(2) == 0 ? test::SeenAgain(feature, 8, random) : test::RandomDescriptor(random));
    }
  }
  return photos;
}

PhotoIndex IndexOf(const std::vector<std::vector<uint8_t>>& photos, int n_threads) {
  base::ThreadPool threads(n_threads);
  RetrievalOptions options;
  options.words = 512;
  return PhotoIndex(
      photos.size(), [&](size_t photo) { return photos[photo]; }, options, threads);
}

TEST(PhotoIndex, FindsThePhotosOfTheSamePlace) {
  for (const uint64_t seed : {1U, 2U, 3U}) {
    const PhotoIndex index = IndexOf(TwoPlaces(seed), 2);
    size_t n_right = 0, n_found = 0;
    for (size_t photo = 0; photo < kIndexedPhotos; ++photo) {
      const std::vector<uint32_t> similar = index.MostSimilar(photo, 8);
      ASSERT_EQ(similar.size(), 8U);
      for (const uint32_t other : similar) {
        EXPECT_NE(other, photo);
        n_right += other % kPlaces == photo % kPlaces ? 1 : 0;
        ++n_found;
      }
    }
    EXPECT_GE(n_right * 100, n_found * 95) << "seed " << seed;
  }
}

TEST(PhotoIndex, IsTheSameForAnyNumberOfThreads) {
  const auto photos = TwoPlaces(4);
  const PhotoIndex one = IndexOf(photos, 1), three = IndexOf(photos, 3);
  EXPECT_GT(one.n_words(), 100U);
  for (size_t photo = 0; photo < kIndexedPhotos; ++photo) EXPECT_EQ(one.Similarities(photo), three.Similarities(photo));
}

TEST(PhotoIndex, SimilaritiesAreCosinesAndSymmetric) {
  const PhotoIndex index = IndexOf(TwoPlaces(5), 2);
  for (size_t a = 0; a < kIndexedPhotos; ++a) {
    const std::vector<float> similarities = index.Similarities(a);
    EXPECT_EQ(similarities[a], 0.0F);
    for (size_t b = 0; b < kIndexedPhotos; ++b) {
      EXPECT_GE(similarities[b], 0.0F);
      EXPECT_LE(similarities[b], 1.0F);
      EXPECT_NEAR(similarities[b], index.Similarities(b)[a], 1e-5F);
    }
  }
}

TEST(PhotoIndex, KnowsNothingOfPhotosWithoutFeatures) {
  std::vector<std::vector<uint8_t>> photos = TwoPlaces(6);
  photos[3].clear();
  photos[4].assign(128 * 20, 0);  // descriptors without a direction
  const PhotoIndex index = IndexOf(photos, 2);
  EXPECT_TRUE(index.MostSimilar(3, 5).empty());
  EXPECT_TRUE(index.MostSimilar(4, 5).empty());
  for (const uint32_t other : index.MostSimilar(0, kIndexedPhotos)) EXPECT_TRUE(other != 3 && other != 4);
  const PhotoIndex nothing = IndexOf(std::vector<std::vector<uint8_t>>(4), 1);
  EXPECT_EQ(nothing.n_words(), 0U);
  EXPECT_TRUE(nothing.MostSimilar(1, 3).empty());
}

TEST(PhotoIndex, TwoPhotosOfTheSameFeaturesAreAlike) {
  base::Random random(8);
  std::vector<uint8_t> rows;
  for (int i = 0; i < 100; ++i) test::AddRow(rows, test::RandomDescriptor(random));
  const PhotoIndex index = IndexOf({rows, rows}, 1);
  EXPECT_NEAR(index.Similarities(0)[1], 1.0F, 1e-5F);
}

TEST(LearnWords, AreMeansOfWhatIsNearest) {
  // Five features seen a hundred times each: as many words find them again.
  base::Random random(9);
  std::vector<std::array<uint8_t, 128>> features;
  std::vector<uint8_t> sample;
  for (int i = 0; i < 5; ++i) features.push_back(test::RandomDescriptor(random));
  for (int i = 0; i < 500; ++i) test::AddRow(sample, test::SeenAgain(features[static_cast<size_t>(i % 5)], 5, random));
  base::ThreadPool threads(2);
  RetrievalOptions options;
  options.words = 20;
  const std::vector<uint8_t> words = LearnWords(sample, options, threads);
  ASSERT_EQ(words.size(), 20U * 128U);
  for (const auto& feature : features) {
    int nearest = 1 << 30;
    for (size_t w = 0; w < 20; ++w) {
      int distance2 = 0;
      for (size_t k = 0; k < 128; ++k) distance2 += (feature[k] - words[w * 128 + k]) * (feature[k] - words[w * 128 + k]);
      nearest = std::min(nearest, distance2);
    }
    // One sample is sqrt(128 * 10) = 36 away on average.
    EXPECT_LT(nearest, 30 * 30);
  }
  ExpectStopsWhenAsked([&] { LearnWords(sample, options, threads); });
}

}  // namespace
}  // namespace skyquilt::prepare::poses
