// Which observations of sparse points may lead to a scene: those of training photos. A held-out photo only measures a scene, so what it observed must
// not train or start one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/survey/survey.h"

namespace skyquilt::survey {

// Fewer photos do not tell where a point is.
constexpr size_t kFewestTrainingObservers = 2;

// How many of these photos are not held out. `photos`: indices into Survey::photos, each at most once.
size_t CountTrainingPhotos(const Survey& survey, std::span<const int32_t> photos);

// Removes points and kept points that fewer than kFewestTrainingObservers training photos observed, and the held-out photos from the tracks of
// points. Tracks of kept points keep theirs: scores compare kept points from held-out cameras, too. SparsePoint::track_length becomes the number of
// training photos. Positions, colours and reprojection errors stay as they are, from all photos. A second call changes nothing; nor does any when
// tracks are not known (Survey::HasTracks). Returns how many points and kept points were removed.
size_t KeepTrainingObservations(Survey& survey);

}  // namespace skyquilt::survey
