// Removes bad sparse points of structure from motion, and measures each camera's height above the remaining ones.
#pragma once

#include <vector>

#include "core/base/thread_pool.h"
#include "core/survey/survey.h"

namespace skyquilt::prepare::georeference {

// Removes points with a reprojection error above kMaxPointErrorPx or a track shorter than kMinTrack, and points far outside the bounds of the rest.
// These limits are relaxed when hardly any point would remain. Logs how many were removed. Returns where the remaining ones were before, ascending
// indices.
std::vector<size_t> FilterSparsePoints(std::vector<survey::SparsePoint>& points);

// Sets agl_m of every photo: the camera's height above the median of the kAglPoints points nearest to the spot below it, no farther from there than
// half the height; NaN when fewer than three are left.
void MeasureAgl(survey::Survey& survey, base::ThreadPool& threads);

constexpr double kMaxPointErrorPx = 2.0;
constexpr int kMinTrack = 3;
constexpr int kAglPoints = 20;

}  // namespace skyquilt::prepare::georeference
