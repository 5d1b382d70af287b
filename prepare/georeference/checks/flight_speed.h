// Ground speed of a flight from the fitted camera positions and the times of its photos.
#pragma once

#include "core/survey/survey.h"

namespace skyquilt::prepare::georeference {

// Median over stretches of the flights of about kStretch_s, in metres per second: path over time, so that times rounded to seconds do not matter. A
// pause of more than 2.5 times the usual interval between photos ends a stretch. NaN when fewer than two photos of a flight have different times.
// The survey must be geo-referenced, otherwise its lengths are not metres.
double SpeedFromPositions(const survey::Survey& survey);

constexpr double kStretch_s = 10.0;

}  // namespace skyquilt::prepare::georeference
