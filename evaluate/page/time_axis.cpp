#include "evaluate/page/time_axis.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

namespace skyquilt::evaluate::page {

namespace {

constexpr double kLongPause_min = 10.0;
constexpr double kShownPause_min = 1.0;  // what is left of one

}  // namespace

TimeAxis AxisOfTimes(const std::vector<double>& times_s) {
  std::vector<size_t> order(times_s.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return times_s[a] < times_s[b]; });
  TimeAxis axis{.x = std::vector<double>(times_s.size()), .label = "flight time (min)"};
  double x = 0.0, last_min = 0.0;
  bool shortened = false;
  for (const size_t i : order) {
    const double gap_min = times_s[i] / 60.0 - last_min;
    x += gap_min > kLongPause_min ? kShownPause_min : gap_min;
    last_min += gap_min;
    shortened = shortened || gap_min > kLongPause_min;
    axis.x[i] = x;
  }
  if (shortened) axis.label += fmt::format(", pauses of more than {:.0f} min shown as {:.0f} min", kLongPause_min, kShownPause_min);
  return axis;
}

TimeAxis AxisOfNames(size_t n_photos) {
  TimeAxis axis{.x = std::vector<double>(n_photos), .label = "photo, in order of names"};
  std::iota(axis.x.begin(), axis.x.end(), 1.0);
  return axis;
}

}  // namespace skyquilt::evaluate::page
