// Measures the peak speed of this machine, so that `skyquilt bench kernel` can compare the kernels with it. Each function works on the calling thread
// for about `seconds`; call it on several threads at the same time for their common limit.
#pragma once

#include <cstdint>

namespace skyquilt::kernel {

// Floating-point operations per second with independent fused multiply-adds (two operations each) on the active instruction set.
double MeasureFlops(double seconds);

struct AccessTimes {
  double gather_s = 0.0;   // one read of a random entry
  double scatter_s = 0.0;  // one addition to a random entry
};
// For a table of `entries` rows of `features` floats, accessed at random rows.
AccessTimes MeasureAccess(uint32_t entries, int features, double seconds);

}  // namespace skyquilt::kernel
