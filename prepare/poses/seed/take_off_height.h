// Compares heights above the ground with RelativeAltitude tags. A barometer measures these, so they depend neither on the lens nor on GPS.
#pragma once

#include <limits>
#include <vector>

namespace skyquilt::prepare::poses {

// Height of the cameras above the ground beside RelativeAltitude, which is above the place of take-off.
struct HeightAboveTakeOff {
  int n = 0;  // photos with both
  // Medians; the ratio is that of each photo, found over tagged. NaN: unknown.
  double found_m = std::numeric_limits<double>::quiet_NaN();
  double tagged_m = std::numeric_limits<double>::quiet_NaN();
  double ratio = std::numeric_limits<double>::quiet_NaN();

  bool Known() const { return n > 0; }
  // More than 10 %, more than 25 %, and by more than ground explains; and by more than a few metres. False when unknown.
  bool Notable() const;
  bool Differs() const;
  bool Contradicts() const;
};

// Per photo, metres; NaN where unknown. Tags below kLeastAltitude_m count as none: 0 is written for "no value", and barometers drift. Unknown with
// fewer than three photos, or a fifth of those with a height.
HeightAboveTakeOff CompareHeights(const std::vector<double>& found_m, const std::vector<double>& tagged_m);
constexpr double kLeastAltitude_m = 5.0;

}  // namespace skyquilt::prepare::poses
