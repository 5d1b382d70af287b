// Whether marks were made in photos as they are stored or as a viewer turns them upright, where the file of the marks does not tell: photos turned by
// 180 degrees have the same sides. The poses tell: marks of a point must meet in front of the cameras. (Turned by 180 degrees, those of photos taken
// straight down meet too, but above the cameras.)
#pragma once

#include <cstddef>

#include "prepare/control/fit/fit_control.h"
#include "prepare/control/reading/control_points.h"

namespace skyquilt::prepare::control {

enum class MarkReading { kStored, kUpright, kUndecided };

struct ReadingVotes {
  size_t n_open = 0;                   // marks with ControlMark::if_upright
  size_t n_stored = 0, n_upright = 0;  // of these: agree with other marks of their points, as written and turned
  // The one with more than twice as many, and two at least.
  MarkReading Reading() const;
};

// Triangulates the points of job.control in both readings. The job's observations are not needed.
ReadingVotes CountReadings(const ControlJob& job);

// Leaves no mark open: moves those that are to where the reading has them, when it is kUpright.
void Settle(MarkReading reading, ControlPoints& control);

}  // namespace skyquilt::prepare::control
