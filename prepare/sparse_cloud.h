// The sparse points worth keeping, and how high each camera flies above them.
#pragma once

#include <vector>

#include "core/base/thread_pool.h"
#include "core/survey/survey.h"

namespace skyquilt::prepare {

// Removes points with a large reprojection error or a short track, and points far outside the robust bounds of the rest. Conditions that would
// leave hardly anything are relaxed. Says in the log what was removed.
void FilterSparsePoints(std::vector<survey::SparsePoint>& points);

// Sets agl_m: camera height minus the median height of the points nearest to its foot, within half its height; NaN when there are too few.
void MeasureAgl(survey::Survey& survey, base::ThreadPool& threads);

constexpr double kMaxPointErrorPx = 2.0;
constexpr int kMinTrack = 3;
constexpr int kAglPoints = 20;

}  // namespace skyquilt::prepare
