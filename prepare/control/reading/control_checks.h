// Checks that control points can place a survey: that they are where the photos are, and enough of them not on one line.
#pragma once

#include <string>
#include <vector>

#include "core/geo/geodetic.h"
#include "prepare/control/reading/control_points.h"

namespace skyquilt::prepare::control {

// Throws base::InputError when a point is more than 100 km from the middle (median) of the photos' tags: the message has the line, the distance and,
// if one of them brings the point near, the likely mistake: exchanged axes, another UTM zone or hemisphere, metres for feet or the reverse, a sign.
// Does nothing without tags.
void CheckNear(const ControlPoints& points, const std::vector<geo::Geodetic>& tags);

// Looks at the control points (not the check points) with at least two marks: there must be three, not on one line (width of their band below a
// hundredth of its length), and with a known height. `have_place`: the photos' tags can place the survey without them; then the result says what is
// wrong and that the points are only compared, otherwise base::InputError is thrown. Empty: all is well.
std::string CheckGeometry(const ControlPoints& points, bool have_place);

}  // namespace skyquilt::prepare::control
