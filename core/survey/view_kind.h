// How the photos of a survey look: down on the ground, or level, as along facades, round towers and in rooms.
#pragma once

#include <span>

#include "core/survey/survey.h"

namespace skyquilt::survey {

// Photos look level when the median angle between their viewing directions and the horizon, up or down, is below this.
constexpr double kLevel_deg = 30.0;

// Of these photos, indices into Survey::photos, those that are not held out; false when there is none.
bool LooksLevel(const Survey& survey, std::span<const int> photos);
// Of all photos.
bool LooksLevel(const Survey& survey);

}  // namespace skyquilt::survey
