// Filters of FLIP for 67 pixels per degree. All are separable: a column filter after a row filter. Taps run from -radius to +radius.
#pragma once

#include <vector>

namespace skyquilt::metrics {

using Taps = std::vector<float>;

struct FlipFilters {
  int color_radius = 0;    // of the four below
  Taps achromatic;         // sum 1
  Taps red_green;          // sum 1
  Taps blue_yellow_broad;  // the blue-yellow filter is the weighted sum of two Gaussians, each of sum 1
  Taps blue_yellow_narrow;
  float broad_weight = 0.5F;   // the weights sum to 1
  float narrow_weight = 0.5F;  //

  int feature_radius = 0;  // of the three below
  Taps smooth;             // Gaussian, sum 1
  Taps edge;               // its first derivative; the positive taps sum to 1, the negative ones to -1
  Taps point;              // its second derivative; the same sums
};

// The filters of the paper: contrast sensitivity of the eye (table 1), and detectors of features 0.082 degrees wide.
const FlipFilters& FiltersOfFlip();

}  // namespace skyquilt::metrics
