// Which features of two photos show the same thing: a feature's best partner by its SIFT descriptor, where the second best is clearly worse (ratio
// test, Lowe 2004, section 7.1) and the choice is mutual. Tries all pairs of features.
//
// The rules and their arithmetic, in float, are those of COLMAP 3.8's brute-force matching (SiftMatchingOptions; FindBestMatchesBruteForce), so the
// matches are the same. COLMAP's command on CPUs searches k-d trees instead, which miss some of the best partners: there, matches differ a little.
// Guided matching and COLMAP's limit on the number of matches (32768) do not exist here.
#pragma once

#include <cstdint>
#include <vector>

#include "core/kernel/descriptors.h"

namespace skyquilt::prepare::poses {

// Feature a of the first photo and b of the second, counted from 0 in the order of their descriptors.
struct FeatureMatch {
  uint32_t a, b;
  bool operator==(const FeatureMatch&) const = default;
};

// The distance of two descriptors is the angle between them: acos(min(1, dot product / 512^2)), 0 to pi / 2. COLMAP's SIFT descriptors have length
// 512 up to rounding.
struct MatchRules {
  double max_ratio = 0.8;     // the best partner's distance is below this share of the second best's
  double max_distance = 0.7;  // radians; the best partner is at most this far
  bool mutual = true;         // b's best partner, by the same two rules, is a
};

// Ordered by a; with `mutual` each b occurs once at most. When two partners are equally good, there is no match, as for COLMAP; a partner with dot
// product 0 is none. With a single feature in the other photo, the second best is at pi / 2. Either photo may be without features. On the calling
// thread; the same result on every processor.
std::vector<FeatureMatch> MatchDescriptors(const kernel::PackedDescriptors& a, const kernel::PackedDescriptors& b, const MatchRules& rules);

}  // namespace skyquilt::prepare::poses
