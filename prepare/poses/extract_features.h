// Finds the features of all photos, in parts: a kill loses the part in work only, and parts can be made by several processes.
#pragma once

#include <string>
#include <vector>

#include "prepare/input/photo_files.h"
#include "prepare/poses/colmap_commands.h"
#include "prepare/poses/pose_options.h"
#include "prepare/poses/pose_task.h"

namespace skyquilt::prepare::poses {

// What the features depend on, as a text to make a hash of.
std::string FeatureInputs(const ColmapJob& job, const ColmapSettings& settings, const std::vector<input::PhotoFile>& photos,
                          const PoseOptions& options);

// Makes a new database with the features of all photos. Photos of the same size, maker, model and focal length have one camera together. `input`
// identifies photos and options: finished parts of an earlier call with the same are used. `ranks`: processes that make the parts; null: this one
// does. The database does not depend on who made which part. Throws base::InputError that names the log when COLMAP fails, base::Interrupted.
void ExtractFeatures(const ColmapJob& job, const ColmapSettings& settings, const std::vector<input::PhotoFile>& photos, const PoseOptions& options,
                     const std::string& input, RemoteTasks* ranks);

// Removes the parts: once the database is finished nobody needs them.
void RemoveFeatureParts(const ColmapJob& job);

// How many photos of `n_photos` a part has at most, for so many processes (0: this one alone) of so many threads: enough to keep all threads busy
// until its end, few enough that every process gets some and that a kill costs a minute or so.
size_t PhotosPerPart(size_t n_photos, int n_processes, int n_threads);

}  // namespace skyquilt::prepare::poses
