// The focal length of photos whose tags have none, by RelativeAltitude. Over roughly level ground a picture moves from photo to photo by the distance
// flown times the focal length over the height: GPS tags say the distance, RelativeAltitude the height (ground_check.h).
#pragma once

#include <optional>

#include "core/survey/colmap_model.h"
#include "prepare/poses/seed/seed_input.h"
#include "prepare/poses/seed/take_off_height.h"

namespace skyquilt::prepare::poses {

// By how much the focal lengths of the input's cameras are too short. Nothing when the photos have no RelativeAltitude, or when positions and matches
// agree with none of several focal lengths. Throws std::logic_error for unknown ids and features.
std::optional<double> FocalFactorByHeight(const SeedInput& input);

// The same lens with so many times the focal length, which is held near that from then on.
SeedLens ScaledFocal(const SeedLens& lens, double factor);

// Heights of the cameras above the points that they see, beside the tags. The model is of photos of the input, in ENU; its scale is taken from the
// tagged positions.
HeightAboveTakeOff HeightsInModel(const SeedInput& input, const survey::ColmapModel& model);

}  // namespace skyquilt::prepare::poses
