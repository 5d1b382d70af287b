// Turns a survey's photos into the input of PredictGains (predict_gains.h).
#pragma once

#include <vector>

#include "core/brightness/predict_gains.h"
#include "core/survey/survey.h"

namespace skyquilt::brightness {

// Whether every photo has a capture time.
bool AllTimed(const survey::Survey& survey);
// One entry per photo of the survey. order: capture time in seconds, or the photo's index when not every photo has a time. group: one number per
// flight and camera. learned: not held out. tagged: has a usable exposure time.
std::vector<CapturedPhoto> CapturedPhotos(const survey::Survey& survey);

}  // namespace skyquilt::brightness
