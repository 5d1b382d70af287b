// What this machine can do at best, measured: the yardstick of `skyquilt bench kernel`. Each function works on the calling thread for about
// `seconds`; run one per thread at the same time for the limit of several threads.
#pragma once

#include <cstdint>

namespace skyquilt::kernel {

// Floating-point operations per second of independent fused multiply-adds on the active instruction set (two operations each).
double MeasureFlops(double seconds);

struct AccessTimes {
  double gather_s = 0.0;   // one read of a random entry
  double scatter_s = 0.0;  // one addition to a random entry
};
// Entries of `features` floats in a table of `entries`, at precomputed random places.
AccessTimes MeasureAccess(uint32_t entries, int features, double seconds);

}  // namespace skyquilt::kernel
