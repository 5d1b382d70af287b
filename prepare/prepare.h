// Turns photos into a prepared survey: camera poses and sparse points in one local ENU frame, the input of all later stages. A camera model of the
// photos is used if given (models/read_model.h), otherwise COLMAP is run. GPS tags place it on Earth, or control points (options.gcp). Written to
// `out_folder`:
//   survey.json, points.ply, kept_points.ply, tracks.bin     the survey (core/survey/survey.h)
//   geo_residuals.csv           per photo: camera position, GPS tag, residual, height above ground
//   cameras.geojson             camera positions, when geo-referenced (opens in QGIS)
//   geo_control.csv, control.geojson   errors of control and check points, when there are any (control/fit/control_report.h)
//   input.csv                   every file of the photo folder: taken or why not, its shot and mask (input/list_files.h)
//   masks/                      the photos' masks, where they are not in that form already (input/masks/masks.h)
//   photos_8bit/                pictures that all later stages read instead of the photos, when some have more than 8 bits or several bands
//                               (input/plain_photos.h)
//   frames/, frames.csv         photos that are frames of videos, and why each was chosen (video/video_frames.h)
//   views/, views.csv           views of panoramas, and what became of each (rigs/cut_panoramas.h); view_masks/ their masks
//   scaled_model/               a COLMAP model that was made from photos of another size, scaled (input/match_sizes.h)
//   colmap/                     database, models and log, when COLMAP was run, also for points of a model without; a second call resumes where the
//                               first stopped
// A folder with simulate.json is a simulated survey: its own model is used, and the survey keeps the paths of its truth.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/survey/survey.h"
#include "prepare/prepare_options.h"

namespace skyquilt::prepare {

namespace poses {
class RemoteTasks;  // poses/pose_task.h
}

struct PrepareInput {
  std::filesystem::path photos;      // folder, searched recursively; see FindInputs in input/input_folder.h
  std::filesystem::path model;       // folder or file of a model (models/read_model.h); empty: COLMAP is run (simulated survey: its own model)
  std::filesystem::path out_folder;  // created if needed
  std::vector<std::filesystem::path> videos = {};  // if not empty: frames of these are the photos, instead of `photos`
};

// Called once photos, poses, place, held-out photos and sparse points of the survey are known, while its checks and directions are not: a first look
// at the survey need not wait for these. poses_known: when poses and points were there, from COLMAP or a given model.
using OnPlaced = std::function<void(const survey::Survey& survey, std::chrono::steady_clock::time_point poses_known)>;

// Photos that cannot be used are left out with a warning that names them. Throws base::UsageError for invalid options, base::InputError when fewer
// than 3 usable photos remain or a file cannot be read or written, base::Interrupted when asked to stop. `ranks`: processes that share the
// search for poses; null: this one does it alone, with the same result.
survey::Survey Prepare(const PrepareInput& input, const PrepareOptions& options, base::ThreadPool& threads, poses::RemoteTasks* ranks = nullptr,
                       const OnPlaced& on_placed = {});

}  // namespace skyquilt::prepare
