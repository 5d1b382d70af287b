// How the time of a run within a total was meant to be used, and how it was: for the report.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "evaluate/measured.h"

namespace skyquilt::evaluate::metrics {

// Seconds; kNotMeasured where it is not known.
struct StageTimes {
  std::string stage;
  double planned_s = kNotMeasured;    // by the first plan
  double predicted_s = kNotMeasured;  // just before it began
  double took_s = kNotMeasured;
};

struct RunTimes {
  double within_s = 0.0;              // the total that was asked for
  double scored_until_s = 0.0;        // of it: when photos are scored no more, the rest is for the report
  double used_s = 0.0;                // so far
  std::vector<StageTimes> stages;     // in their order; those that were not made are left out
  std::vector<std::string> given_up;  // a text each
  std::string scores_given_up;        // the last of them, where photos were not scored for lack of time; else empty
};

constexpr size_t kFewestScored = 2;

// Whether one more photo can be scored before `times.scored_until_s`: after `scored` photos, `scored_here` of them in the `spent_s` seconds since
// times.used_s.
inline bool HasTimeToScore(const RunTimes& times, size_t scored, size_t scored_here, double spent_s) {
  const double one_s = scored_here > 0 ? spent_s / static_cast<double>(scored_here) : 0.0;
  return scored < kFewestScored || times.used_s + spent_s + one_s <= times.scored_until_s;
}

}  // namespace skyquilt::evaluate::metrics
