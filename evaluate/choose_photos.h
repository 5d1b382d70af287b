// Which photos an evaluation looks at.
#pragma once

#include <cstddef>
#include <vector>

#include "core/survey/survey.h"

namespace skyquilt::evaluate {

// Indices into Survey::photos of those that were never trained on.
std::vector<int> HeldOutPhotos(const survey::Survey& survey);
// Places of `count` of `n` entries, evenly spread; of all when count is 0 or enough.
std::vector<size_t> SpreadPlaces(size_t n, int count);
// `count` of the photos, chosen so.
std::vector<int> EvenlySpread(const std::vector<int>& photos, int count);

}  // namespace skyquilt::evaluate
