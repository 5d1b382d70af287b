// How well the place of a survey on Earth is known.
#pragma once

#include <cmath>
#include <limits>

namespace skyquilt::geo {

// One standard deviation each; NaN: unknown. A frame that is known exactly has zeros.
struct PlaceAccuracy {
  double scale_percent = std::numeric_limits<double>::quiet_NaN();  // of every length
  double tilt_deg = std::numeric_limits<double>::quiet_NaN();       // angle between the frame's up and the true up (both axes together)
  double yaw_deg = std::numeric_limits<double>::quiet_NaN();        // rotation about up
  double horizontal_m = std::numeric_limits<double>::quiet_NaN();   // distance of the survey's middle (both axes together)
  double vertical_m = std::numeric_limits<double>::quiet_NaN();     // height of the survey's middle, in the height system of the tags

  // Lengths are metres; in a local frame only where scale bars have given them.
  bool HasScale() const { return std::isfinite(scale_percent); }
};

}  // namespace skyquilt::geo
