// Straight lines in photos, as horizontal lines on the ground: roof edges, walls seen from above, kerbs.
#pragma once

#include <vector>

#include "core/base/thread_pool.h"
#include "core/survey/survey.h"
#include "prepare/georeference/checks/yaw_modes.h"

namespace skyquilt::prepare::georeference {

// Training photos in which lines are searched, at most, evenly over the survey, reduced to kLinePhotoWidth pixels.
constexpr int kLinePhotos = 32;
constexpr int kLinePhotoWidth = 1200;

struct FoundLines {
  std::vector<HorizontalLine> lines;
  int photos = 0;
};

// Line segments (von Gioi et al. 2010) of at least kShortestLinePx pixels. A segment and the camera span a plane, whose horizontal direction is the
// line's if the line is horizontal. Segments that may be vertical edges, or are seen at more than 40 degrees from straight down, are left out.
// Lengths and places are those on the level of the ground. Held-out photos are not looked at; photos that cannot be read are left out. The same
// result for any number of threads.
FoundLines FindHorizontalLines(const survey::Survey& survey, base::ThreadPool& threads);
constexpr double kShortestLinePx = 25.0;

}  // namespace skyquilt::prepare::georeference
