#include "prepare/input/tag_accuracy.h"

#include <algorithm>

namespace skyquilt::prepare::input {
namespace {

// Receivers without a stated accuracy (OpenDroneMap's default), and their heights, which are about half as accurate again.
constexpr double kDefaultSigma_m = 3.0;
constexpr double kVerticalFactor = 1.5;
constexpr double kSigmaPerDop_m = 1.5;
constexpr double kRtkSigma_m = 0.03;
// The reconstruction itself is not more accurate than this, whatever a tag states.
constexpr double kLeastSigma_m = 0.02;

}  // namespace

TagAccuracy AccuracyOf(const survey::PhotoTags& tags) {
  double horizontal_m = tags.rtk ? kRtkSigma_m : tags.dop && *tags.dop > 0.0 ? kSigmaPerDop_m * *tags.dop : kDefaultSigma_m;
  if (tags.horizontal_accuracy_m && *tags.horizontal_accuracy_m > 0.0) horizontal_m = *tags.horizontal_accuracy_m;
  double vertical_m = kVerticalFactor * horizontal_m;
  if (tags.vertical_accuracy_m && *tags.vertical_accuracy_m > 0.0) vertical_m = *tags.vertical_accuracy_m;
  return {std::max(horizontal_m, kLeastSigma_m), std::max(vertical_m, kLeastSigma_m)};
}

}  // namespace skyquilt::prepare::input
