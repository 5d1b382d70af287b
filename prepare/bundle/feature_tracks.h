// Joins the matches of pairs to tracks, and chooses a part of them that ties all photos together.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prepare/bundle/bundle_problem.h"

namespace skyquilt::prepare::bundle {

// Matches of a pair of photos, given by index.
struct IndexedPair {
  uint32_t a = 0, b = 0;
  std::vector<std::array<uint32_t, 2>> features;
};

// Tracks of at least two photos, in the order of their first photos and features. Two groups of features with a photo in common are never joined, so
// that one wrong match does not spoil both; pairs with many matches are joined first. `n_features` is per photo.
FeatureTracks JoinMatches(const std::vector<IndexedPair>& pairs, const std::vector<size_t>& n_features);

// Tracks for the adjustment: long ones first, as long as at least half of a track's photos want more tracks in the cell of an 8 x 8 grid where they
// show it, or one photo has fewer than kLeastFilled of what it wants: those at the edge see little that others do not have enough of. A photo wants
// `per_photo` in all. Bounds the adjustment to a number of observations that grows linearly with the photos. Only tracks with
// `usable` != 0 and entries with `counts` != 0; indices ascend.
constexpr double kLeastFilled = 0.75;
std::vector<uint32_t> ChooseTracks(const BundleProblem& bundle, const std::vector<char>& usable, const std::vector<char>& counts, size_t per_photo);

}  // namespace skyquilt::prepare::bundle
