#include "prepare/poses/feature_matcher.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace skyquilt::prepare::poses {
namespace {

float AngleOf(int32_t dot) {
  constexpr float kOneOverLength2 = 1.0F / (512.0F * 512.0F);
  return std::acos(std::min(kOneOverLength2 * static_cast<float>(dot), 1.0F));
}

// The partner of feature i by the rules for one direction; -1 when there is none.
int32_t PartnerOf(const kernel::BestDots& best, size_t i, float max_ratio, float max_distance) {
  if (best.index[i] < 0) return -1;
  const float angle = AngleOf(best.dot[i]);
  if (angle > max_distance || angle >= max_ratio * AngleOf(best.second[i])) return -1;
  return best.index[i];
}

}  // namespace

std::vector<FeatureMatch> MatchDescriptors(const kernel::PackedDescriptors& a, const kernel::PackedDescriptors& b, const MatchRules& rules) {
  const auto max_ratio = static_cast<float>(rules.max_ratio), max_distance = static_cast<float>(rules.max_distance);
  const kernel::BestDotsBothWays best = kernel::FindBestDots(a, b);
  std::vector<FeatureMatch> matches;
  for (size_t i = 0; i < a.size(); ++i) {
    const int32_t j = PartnerOf(best.of_a, i, max_ratio, max_distance);
    if (j < 0) continue;
    if (rules.mutual && PartnerOf(best.of_b, static_cast<size_t>(j), max_ratio, max_distance) != static_cast<int32_t>(i)) continue;
    matches.push_back({static_cast<uint32_t>(i), static_cast<uint32_t>(j)});
  }
  return matches;
}

}  // namespace skyquilt::prepare::poses
