// The photos that a variant of a study trains with.
#pragma once

#include "bench/study/study.h"

namespace skyquilt::bench {

// Angle between the optical axis of a photo and straight down, degrees.
double TiltDeg(const survey::Photo& photo);
// The survey with the variant's training photos, in name order, and all held-out photos. Tracks forget the photos that are gone; points stay.
survey::Survey ThinSurvey(survey::Survey survey, const Variant& variant);

}  // namespace skyquilt::bench
