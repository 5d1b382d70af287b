#include "prepare/bundle/feature_tracks.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <set>

#include "core/base/random.h"

namespace skyquilt::test {
namespace {

using namespace prepare::bundle;

std::vector<TrackEntry> EntriesOf(const FeatureTracks& tracks, size_t t) {
  return {tracks.entries.begin() + tracks.first[t], tracks.entries.begin() + tracks.first[t + 1]};
}

TEST(JoinMatches, FollowsMatchesOverPhotos) {
  const FeatureTracks tracks = JoinMatches({{0, 1, {{{3, 5}}}}, {1, 2, {{{5, 7}}, {{0, 1}}}}}, {4, 6, 8});
  ASSERT_EQ(tracks.size(), 2U);
  EXPECT_EQ(EntriesOf(tracks, 0).size(), 3U);
  EXPECT_EQ(EntriesOf(tracks, 0)[2].feature, 7U);
  EXPECT_EQ(EntriesOf(tracks, 1).size(), 2U);
}

RC_GTEST_PROP(JoinMatches, NoTrackShowsAPhotoTwice, ()) {
  const auto seed = *rc::gen::inRange<uint64_t>(0, 1000000);
  base::Random random(seed);
  std::vector<IndexedPair> pairs;
  for (uint32_t a = 0; a < 6; ++a) {
    for (uint32_t b = a + 1; b < 6; ++b) {
      IndexedPair pair{a, b, {}};
      for (uint32_t k = 0; k < 10; ++k) pair.features.push_back({k, random.Below(10) < 7 ? k : random.Below(10)});
      pairs.push_back(pair);
    }
  }
  const FeatureTracks tracks = JoinMatches(pairs, std::vector<size_t>(6, 10));
  std::set<std::pair<uint32_t, uint32_t>> used;
  for (size_t t = 0; t < tracks.size(); ++t) {
    const auto entries = EntriesOf(tracks, t);
    RC_ASSERT(entries.size() >= 2);
    for (size_t k = 0; k < entries.size(); ++k) {
      if (k > 0) RC_ASSERT(entries[k - 1].photo < entries[k].photo);
      RC_ASSERT(used.insert({entries[k].photo, entries[k].feature}).second);
    }
  }
}

// The adjustment stays linear in the number of photos, however many tracks there are.
TEST(ChooseTracks, BoundsTheObservationsOfEachPhoto) {
  constexpr uint32_t kPhotos = 10;
  BundleProblem bundle;
  bundle.lenses.resize(1);
  bundle.lenses[0].camera = {camera::CameraModel::kPinhole, 1600, 1200, {1200.0, 1200.0, 800.0, 600.0}};
  bundle.photos.resize(kPhotos);
  base::Random random(4);
  for (uint32_t t = 0; t < 20000; ++t) {
    const uint32_t start = random.Below(kPhotos - 4), length = 2 + random.Below(4);
    for (uint32_t k = 0; k < length && start + k < kPhotos; ++k) {
      bundle.tracks.entries.push_back({start + k, t});
      bundle.pixel.push_back({random.Uniform(0.0, 1600.0), random.Uniform(0.0, 1200.0)});
    }
    bundle.tracks.first.push_back(static_cast<uint32_t>(bundle.tracks.entries.size()));
  }
  const std::vector<char> all(bundle.tracks.size(), 1), counts(bundle.tracks.entries.size(), 1);
  const std::vector<uint32_t> chosen = ChooseTracks(bundle, all, counts, 320);
  std::vector<size_t> n(kPhotos, 0);
  for (const uint32_t t : chosen) {
    for (uint32_t e = bundle.tracks.first[t]; e < bundle.tracks.first[t + 1]; ++e) ++n[bundle.tracks.entries[e].photo];
  }
  for (const size_t count : n) {
    EXPECT_GE(count, 240U);  // kLeastFilled, at the ends of the strip
    EXPECT_LE(count, 900U);
  }
  EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
  EXPECT_TRUE(ChooseTracks(bundle, std::vector<char>(bundle.tracks.size(), 0), counts, 320).empty());
}

}  // namespace
}  // namespace skyquilt::test
