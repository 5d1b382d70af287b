#include "tour/export/tour_options.h"

#include <string>

#include "core/base/errors.h"

namespace skyquilt::tour {

std::vector<config::Field<TourOptions>> TourOptions::Fields() {
  using config::Range;
  using O = TourOptions;
  return {
      {"auto", &O::auto_stops, Range{0, 50},
       "stops of the tour that 'skyquilt run' proposes and exports to tour/index.html when the project has none; one that was edited stays. "
       "0: 'skyquilt run' makes no tour"},
      {"size_mb", &O::size_mb, Range{1, 1e6},
       "largest size of an exported tour, millions of bytes: pictures take at most half of it, or what the surface leaves, and finer pieces of the "
       "surface are left out"},
      {"still_width", &O::still_width, Range{16, 8192}, "width of the picture that a stop shows, pixels"},
      {"still_height", &O::still_height, Range{16, 8192}, "its height"},
      {"panorama_width", &O::panorama_width, Range{64, 16384}, "width of the picture of all directions at a stop, pixels; even. It is half as high"},
  };
}

void TourOptions::Check() const {
  config::CheckRanges("tour", *this);
  if (panorama_width % 2 != 0) {
    throw base::UsageError("tour.panorama_width = " + std::to_string(panorama_width) + " is not allowed: it must be even");
  }
}

}  // namespace skyquilt::tour
