#include "prepare/poses/feature_matcher.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>

#include "core/base/random.h"

namespace skyquilt::prepare::poses {

void PrintTo(const FeatureMatch& match, std::ostream* out) {
  *out << match.a << "-" << match.b;
}

namespace {

using Bytes = std::vector<uint8_t>;
using Matches = std::vector<FeatureMatch>;

// A descriptor of length 512 with the value 128 at 16 of the 128 places: place 0 to 15 of the parts in `shares`, which say how many of them belong to
// each part. Two descriptors that share m places are at the angle acos(m / 16).
struct Share {
  size_t part;  // 0 to 7
  size_t places;
};
void Add(Bytes& rows, std::initializer_list<Share> shares) {
  Bytes row(kernel::kDescriptorBytes, 0);
  size_t sum = 0;
  for (const Share& share : shares) {
    std::fill_n(row.begin() + static_cast<ptrdiff_t>(share.part * 16), share.places, uint8_t{128});
    sum += share.places;
  }
  ASSERT_EQ(sum, 16U);
  rows.insert(rows.end(), row.begin(), row.end());
}

Matches Match(const Bytes& a, const Bytes& b, const MatchRules& rules = {}) {
  return MatchDescriptors(kernel::PackDescriptors(a), kernel::PackDescriptors(b), rules);
}

TEST(MatchDescriptors, AcceptsAnglesUpToTheLimit) {
  Bytes a, near, far;
  Add(a, {{0, 16}});
  Add(near, {{0, 13}, {1, 3}});  // acos(13 / 16) = 0.622
  Add(far, {{0, 12}, {1, 4}});   // acos(12 / 16) = 0.723
  EXPECT_EQ(Match(a, near), (Matches{{0, 0}}));
  EXPECT_EQ(Match(a, far), Matches{});
  EXPECT_EQ(Match(a, far, {.max_distance = 0.73}), (Matches{{0, 0}}));
  EXPECT_EQ(Match(a, near, {.max_distance = 0.62}), Matches{});
}

TEST(MatchDescriptors, RefusesAPartnerThatIsHardlyBetterThanTheNext) {
  Bytes a, clear, unclear;
  Add(a, {{0, 16}});
  for (Bytes* b : {&clear, &unclear}) Add(*b, {{2, 16}});
  Add(clear, {{0, 12}, {1, 4}});
  Add(clear, {{0, 14}, {1, 2}});  // 0.505 / 0.723 = 0.70
  Add(unclear, {{0, 13}, {1, 3}});
  Add(unclear, {{0, 14}, {1, 2}});  // 0.505 / 0.622 = 0.81
  EXPECT_EQ(Match(a, clear), (Matches{{0, 2}}));
  EXPECT_EQ(Match(a, unclear), Matches{});
  EXPECT_EQ(Match(a, unclear, {.max_ratio = 0.82}), (Matches{{0, 2}}));
}

TEST(MatchDescriptors, RefusesTwoEqualPartners) {
  Bytes a, twice;
  Add(a, {{0, 16}});
  for (int i = 0; i < 2; ++i) Add(twice, {{0, 16}});
  EXPECT_EQ(Match(a, twice), Matches{});
  EXPECT_EQ(Match(a, twice, {.max_ratio = 1.0, .mutual = false}), Matches{});
}

// Two features of a find the same feature of b. Mutual means that b's choice has to pass the ratio test too.
TEST(MatchDescriptors, IsMutualByTheSameRules) {
  Bytes a, unclear, b;
  Add(b, {{0, 16}});
  Add(a, {{0, 13}, {1, 3}});
  Add(a, {{0, 15}, {1, 1}});  // 0.355 / 0.622 = 0.57
  Add(unclear, {{0, 13}, {1, 3}});
  Add(unclear, {{0, 14}, {1, 2}});  // 0.81
  EXPECT_EQ(Match(a, b), (Matches{{1, 0}}));
  EXPECT_EQ(Match(unclear, b), Matches{});
  for (const Bytes& either : {a, unclear}) EXPECT_EQ(Match(either, b, {.mutual = false}), (Matches{{0, 0}, {1, 0}}));
}

TEST(MatchDescriptors, FindsNothingWithoutFeaturesOrLikeness) {
  Bytes a, b;
  Add(a, {{0, 16}});
  Add(b, {{1, 16}});
  const Bytes zeros(kernel::kDescriptorBytes, 0);
  EXPECT_EQ(Match({}, {}), Matches{});
  EXPECT_EQ(Match(a, {}), Matches{});
  EXPECT_EQ(Match({}, b), Matches{});
  EXPECT_EQ(Match(a, b, {.max_ratio = 2.0, .max_distance = 2.0}), Matches{}) << "a dot product of 0 is no partner";
  EXPECT_EQ(Match(zeros, zeros, {.max_ratio = 2.0, .max_distance = 2.0}), Matches{});
}

// Descriptors of about length 512, noisy copies of a few so that the rules decide.
Bytes NoisyCopies(size_t n, size_t originals, double noise, base::Random& random) {
  Bytes rows;
  for (size_t i = 0; i < n; ++i) {
    base::Random original(random.Below(static_cast<uint32_t>(originals)));
    double values[kernel::kDescriptorBytes], sum = 0.0;
    for (double& value : values) {
      value = std::max(0.0, original.Normal() + noise * random.Normal());
      sum += value * value;
    }
    for (const double value : values) rows.push_back(static_cast<uint8_t>(std::min(255.0, std::round(512.0 * value / std::sqrt(sum)))));
  }
  return rows;
}

// COLMAP's rules once more, on the table of all angles.
Matches FromAllAngles(const Bytes& a, const Bytes& b, const MatchRules& rules) {
  const size_t n_a = a.size() / kernel::kDescriptorBytes, n_b = b.size() / kernel::kDescriptorBytes;
  const auto angle = [&](size_t i, size_t j) {
    int dot = 0;
    for (size_t k = 0; k < kernel::kDescriptorBytes; ++k) dot += a[i * kernel::kDescriptorBytes + k] * b[j * kernel::kDescriptorBytes + k];
    return std::acos(std::min(static_cast<float>(dot) / 262144.0F, 1.0F));
  };
  const auto passes = [&](float best, float second) {
    return best <= static_cast<float>(rules.max_distance) && best < static_cast<float>(rules.max_ratio) * second;
  };
  Matches matches;
  for (size_t i = 0; i < n_a; ++i) {
    for (size_t j = 0; j < n_b; ++j) {
      // The smallest angle of i to all others than j, and of j to all others than i.
      float other_j = std::acos(0.0F), other_i = other_j;
      for (size_t other = 0; other < n_b; ++other) other_j = other == j ? other_j : std::min(other_j, angle(i, other));
      for (size_t other = 0; other < n_a; ++other) other_i = other == i ? other_i : std::min(other_i, angle(other, j));
      if (!passes(angle(i, j), other_j) || (rules.mutual && !passes(angle(i, j), other_i))) continue;
      matches.push_back({static_cast<uint32_t>(i), static_cast<uint32_t>(j)});
    }
  }
  return matches;
}

RC_GTEST_PROP(MatchDescriptors, FollowsTheRulesForAllAngles, ()) {
  base::Random random(*rc::gen::arbitrary<uint32_t>());
  const auto n_a = *rc::gen::inRange<size_t>(0, 24), n_b = *rc::gen::inRange<size_t>(0, 24);
  const Bytes a = NoisyCopies(n_a, 20, 0.4, random), b = NoisyCopies(n_b, 20, 0.4, random);
  MatchRules rules;
  rules.mutual = *rc::gen::arbitrary<bool>();
  const Matches found = Match(a, b, rules);
  RC_CLASSIFY(!found.empty());
  RC_ASSERT(found == FromAllAngles(a, b, rules));
  if (!rules.mutual) return;
  Matches swapped = Match(b, a, rules);
  for (FeatureMatch& match : swapped) std::swap(match.a, match.b);
  std::sort(swapped.begin(), swapped.end(), [](const FeatureMatch& x, const FeatureMatch& y) { return x.a < y.a; });
  RC_ASSERT(found == swapped);
}

// The features of a photo in another order and with noise all find themselves again.
TEST(MatchDescriptors, FindsEveryFeatureOfAShuffledPhoto) {
  base::Random random(11);
  constexpr size_t kFeatures = 900;
  Bytes a, b(kFeatures * kernel::kDescriptorBytes);
  for (size_t i = 0; i < kFeatures; ++i) {
    const Bytes row = NoisyCopies(1, 0xFFFFFFFF, 0.0, random);
    a.insert(a.end(), row.begin(), row.end());
  }
  std::vector<uint32_t> order(kFeatures);
  for (size_t i = 0; i < kFeatures; ++i) order[i] = static_cast<uint32_t>(i * 7 % kFeatures);
  for (size_t i = 0; i < kFeatures; ++i) {
    for (size_t k = 0; k < kernel::kDescriptorBytes; ++k) {
      b[order[i] * kernel::kDescriptorBytes + k] = static_cast<uint8_t>(std::min(255U, a[i * kernel::kDescriptorBytes + k] + random.Below(9)));
    }
  }
  const Matches found = Match(a, b);
  ASSERT_EQ(found.size(), kFeatures);
  for (size_t i = 0; i < kFeatures; ++i) EXPECT_EQ(found[i], (FeatureMatch{static_cast<uint32_t>(i), order[i]}));
}

}  // namespace
}  // namespace skyquilt::prepare::poses
