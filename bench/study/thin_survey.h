// The photos that a variant of a study trains with.
#pragma once

#include <vector>

#include "bench/study/study.h"

namespace skyquilt::bench {

// Angle between the optical axis of a photo and straight down, degrees.
double TiltDeg(const survey::Photo& photo);
// Removes the photos whose `keep` is false and what only they observed: points keep the observations of the training photos that stay, and those
// with fewer than two leave. Heights above ground are measured anew. Poses, lenses, coordinates of points and directions stay those of all photos.
// A survey without tracks keeps all points, with a warning.
void KeepPhotos(survey::Survey& survey, const std::vector<bool>& keep);
// The survey with the variant's training photos, in name order, and all held-out photos, as KeepPhotos leaves it.
survey::Survey ThinSurvey(survey::Survey survey, const Variant& variant);

}  // namespace skyquilt::bench
