// A survey's photos as the prediction of gains wants them.
#pragma once

#include <vector>

#include "core/brightness/predict_gains.h"
#include "core/survey/survey.h"

namespace skyquilt::brightness {

// Whether every photo says when it was taken.
bool AllTimed(const survey::Survey& survey);
// One per photo: seconds of capture, or the place in the survey where not all are timed; a group per flight and camera; learned unless held
// out; tagged with an exposure time.
std::vector<CapturedPhoto> CapturedPhotos(const survey::Survey& survey);

}  // namespace skyquilt::brightness
