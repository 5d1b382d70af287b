// How accurate a tagged position is.
#pragma once

#include "core/survey/exif.h"

namespace skyquilt::prepare::input {

// Stated or typical, one standard deviation per axis in metres, at least 0.02.
struct TagAccuracy {
  double horizontal_m = 3.0;
  double vertical_m = 4.5;
};

TagAccuracy AccuracyOf(const survey::PhotoTags& tags);

}  // namespace skyquilt::prepare::input
