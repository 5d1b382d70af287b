// Colours of the points of a model that has none.
#pragma once

#include <filesystem>

#include "core/base/thread_pool.h"
#include "core/survey/colmap_model.h"

namespace skyquilt::prepare::poses {

// Gives every point the mean colour (sRGB) at its observations; photos are read at about a quarter of their size. Photos that cannot be read count
// not. Throws base::Interrupted.
void ColorPoints(survey::ColmapModel& model, const survey::ColmapObservations& observations, const std::filesystem::path& photo_root,
                 base::ThreadPool& threads);

}  // namespace skyquilt::prepare::poses
