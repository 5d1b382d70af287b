// Chooses the photos that an evaluation scores and shows.
#pragma once

#include <cstddef>
#include <vector>

#include "core/survey/survey.h"

namespace skyquilt::evaluate::photos {

// Indices into Survey::photos of the held-out photos, which were not trained on.
std::vector<int> HeldOutPhotos(const survey::Survey& survey);
// `count` indices below n, evenly spread; all n when count is 0 or at least n.
std::vector<size_t> EvenlySpacedIndices(size_t n, int count);
// `count` of the photos, chosen by EvenlySpacedIndices.
std::vector<int> SelectEvenly(const std::vector<int>& photos, int count);
// All of them, in an order in which the first few, however many, are spread over all: for scoring that may have to stop early.
std::vector<int> SpreadOrder(const std::vector<int>& photos);

}  // namespace skyquilt::evaluate::photos
