// The poses of a film of a tour: it stays at each stop, then goes on along the way to the next.
#pragma once

#include <vector>

#include "tour/format/tour.h"
#include "tour/ways/heights.h"

namespace skyquilt::tour {

struct FilmFrame {
  Pose pose;
  size_t stop = 0;  // index of the stop whose exposure it has: that of the nearer end of the way
};

// Begins at the tour's start and follows `next`; ends after the stop that nothing follows, or when it comes back to one that it showed. Stays at each
// as long as it says, at least two and at most ten seconds. fps: frames per second, positive.
std::vector<FilmFrame> FilmOf(const Tour& tour, const Heights* heights, int fps);

}  // namespace skyquilt::tour
