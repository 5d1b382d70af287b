// Finds camera poses and sparse points by structure from motion: runs the COLMAP program for features and mapping, and for matching where our own is
// not wanted. Steps already finished for the same photos and options are skipped.
#pragma once

#include <filesystem>
#include <vector>

#include "core/base/thread_pool.h"
#include "prepare/input/photo_files.h"
#include "prepare/poses/colmap_step.h"
#include "prepare/poses/pose_options.h"
#include "prepare/poses/pose_task.h"

namespace skyquilt::prepare::poses {

// The fast way: features by FastColmapFlags, pairs by ChoosePairs, matches by MatchPairs, verified by COLMAP, poses by SeedModel or else by COLMAP's
// mapper, without the photos that RemoveLoosePhotos takes out and with all parts that tags place beside the largest (join_parts.h). When that has
// poses of fewer than kEnoughRegistered of the photos, or focal lengths far from those of the tags (FindFarFocal), all is done once more with
// COLMAP's own settings and kMorePairs in the folder "more_pairs" of the job, with the focal lengths of the tags where adjusted ones are far from
// them, and the model with more photos is taken, or one with the right focal lengths and more than half as many. Otherwise COLMAP does everything. A
// warning says when the model has wrong focal lengths all the same. Returns the folder of the model. Throws base::InputError that names the log when
// a step fails, base::Interrupted when asked to stop (a later call continues). `ranks`: processes that find features and matches; null: this one
// does, with the same result.
std::filesystem::path RunColmap(const ColmapJob& job, const std::vector<input::PhotoFile>& photos, const PoseOptions& options,
                                base::ThreadPool& threads, RemoteTasks* ranks = nullptr);

}  // namespace skyquilt::prepare::poses
