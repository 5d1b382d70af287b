// Sparse points for a model that has poses and lenses but no points, as several programs export: features, matches between photos that are near each
// other, and COLMAP's triangulation, which leaves poses and lenses as they are.
#pragma once

#include <vector>

#include "core/base/thread_pool.h"
#include "core/survey/colmap_model.h"
#include "prepare/input/photo_files.h"
#include "prepare/poses/colmap_step.h"
#include "prepare/poses/pose_options.h"
#include "prepare/poses/pose_task.h"

namespace skyquilt::prepare::poses {

// photos: those of the model's images, by name; sizes are those of the cameras. Points are in the model's frame, with tracks of its image ids.
// Finished steps of an earlier call are not repeated. Throws base::InputError when COLMAP fails and when there are fewer than 10 points,
// base::Interrupted.
std::vector<survey::ColmapPoint> TriangulatePoints(const ColmapJob& job, const std::vector<input::PhotoFile>& photos,
                                                   const survey::ColmapModel& poses, const PoseOptions& options, base::ThreadPool& threads,
                                                   RemoteTasks* ranks = nullptr);

}  // namespace skyquilt::prepare::poses
