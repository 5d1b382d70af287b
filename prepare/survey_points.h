// Fills a survey's sparse points from a COLMAP model: moved to ENU, without bad ones, with the photos that observed them, and some kept from
// training.
#pragma once

#include <cstdint>
#include <unordered_map>

#include "core/geo/transform.h"
#include "core/survey/colmap_model.h"
#include "core/survey/survey.h"

namespace skyquilt::prepare {

// Whether a point is kept from training: about one in `every`, by a hash of its id in the model, so that the choice depends neither on the order of
// the points nor on which photos are used. every = 0: none.
bool IsKeptPoint(uint64_t colmap_id, int every);

// Sets points, kept_points and the tracks of both. photo_of_image: index into Survey::photos, whose is_test must be set, of COLMAP's image ids;
// observations in other images do not count. Points that fewer than two training photos observed are left out, then bad ones (FilterSparsePoints,
// which sees training observations alone); tracks are as KeepTrainingObservations leaves them. Of a model without observations every good point is
// used, because nobody knows who observed it.
void FillPoints(const survey::ColmapModel& model, const geo::Similarity3d& enu_from_model,
                const std::unordered_map<uint32_t, int32_t>& photo_of_image, int keep_every, survey::Survey& survey);

}  // namespace skyquilt::prepare
