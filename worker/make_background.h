// Makes the survey's background (core/scene/background.h) from its training photos.
#pragma once

#include "core/scene/background.h"
#include "core/survey/survey.h"
#include "worker/rays/ray_source.h"
#include "worker/start/point_ranges.h"

namespace skyquilt::worker {

// Projects the mean colours of the training photos' tiles onto `points`, the height map of the sparse points, blurs them over about three tiles (the
// heights are not more accurate), and interpolates where no photo sees the ground. When the height map is empty, only the mean colour is set.
// More photos than photos_in_memory are read twice, a part at a time, so that memory does not grow with the survey; the result is the same.
// Where photos look level, the mean colours of the tiles that show sky become a sky by direction, interpolated where no photo shows it.
scene::Background MakeBackground(const RaySource& source, const survey::Survey& survey, const scene::HeightMap& points, const PointRanges& ranges,
                                 uint64_t seed, base::ThreadPool& threads, size_t photos_in_memory = 2048);

}  // namespace skyquilt::worker
