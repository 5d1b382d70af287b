// Places photos along the time axis of a chart.
#pragma once

#include <string>
#include <vector>

namespace skyquilt::evaluate::page {

struct TimeAxis {
  std::vector<double> x;  // one per photo
  std::string label;      // with unit
};

// Minutes since time 0. Long pauses between photos are shortened: two flights on two mornings would otherwise be two dots. times_s: seconds, in any
// order, all finite.
TimeAxis AxisOfTimes(const std::vector<double>& times_s);
// 1, 2, 3 ... for photos whose times are not known.
TimeAxis AxisOfNames(size_t n_photos);

}  // namespace skyquilt::evaluate::page
