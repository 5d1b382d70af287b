#include "prepare/poses/seed/take_off_height.h"

#include <cmath>

#include "core/base/order_statistics.h"

namespace skyquilt::prepare::poses {
namespace {

constexpr double kNotableLow = 0.9, kNotableHigh = 1.1, kNotable_m = 3.0;
constexpr double kDiffersLow = 0.8, kDiffersHigh = 1.25;
constexpr double kContradictsLow = 0.67, kContradictsHigh = 1.5, kContradicts_m = 5.0;
constexpr size_t kLeastHeights = 3;

}  // namespace

bool HeightAboveTakeOff::Notable() const {
  return Known() && !(ratio >= kNotableLow && ratio <= kNotableHigh) && std::abs(found_m - tagged_m) > kNotable_m;
}

bool HeightAboveTakeOff::Differs() const {
  return Notable() && !(ratio >= kDiffersLow && ratio <= kDiffersHigh);
}

bool HeightAboveTakeOff::Contradicts() const {
  return Notable() && !(ratio >= kContradictsLow && ratio <= kContradictsHigh) && std::abs(found_m - tagged_m) > kContradicts_m;
}

HeightAboveTakeOff CompareHeights(const std::vector<double>& found_m, const std::vector<double>& tagged_m) {
  std::vector<double> found, tagged, ratio;
  size_t n_found = 0;
  for (size_t i = 0; i < found_m.size(); ++i) {
    if (!(std::isfinite(found_m[i]) && found_m[i] > 0.0)) continue;
    ++n_found;
    if (!(std::isfinite(tagged_m[i]) && tagged_m[i] >= kLeastAltitude_m)) continue;
    found.push_back(found_m[i]);
    tagged.push_back(tagged_m[i]);
    ratio.push_back(found_m[i] / tagged_m[i]);
  }
  constexpr size_t kLeastTagged = 5;  // one of so many
  if (ratio.size() < kLeastHeights || kLeastTagged * ratio.size() < n_found) return {};
  const auto n = static_cast<int>(ratio.size());
  return {.n = n, .found_m = base::Median(std::move(found)), .tagged_m = base::Median(std::move(tagged)), .ratio = base::Median(std::move(ratio))};
}

}  // namespace skyquilt::prepare::poses
