// Simulated surveys of a wanted number of photos.
#pragma once

#include <vector>

#include "simulate/flight.h"

namespace skyquilt::bench {

// The `n` photos nearest to the middle of the flight, in the order of capture: those in the smallest rectangle of the flight's shape, so that lines
// and neighbours stay as they are. All when there are no more.
std::vector<simulate::PhotoPlan> MiddlePhotos(std::vector<simulate::PhotoPlan> photos, size_t n);

}  // namespace skyquilt::bench
