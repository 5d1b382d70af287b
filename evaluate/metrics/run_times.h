// How the time of a run within a total was meant to be used, and how it was: for the report.
#pragma once

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
  double used_s = 0.0;                // so far
  std::vector<StageTimes> stages;     // in their order; those that were not made are left out
  std::vector<std::string> given_up;  // a text each
};

}  // namespace skyquilt::evaluate::metrics
