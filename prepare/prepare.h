// Photos (and, if at hand, their COLMAP model) to a prepared survey in one local ENU frame, written to `out_folder`:
//   survey.json, points.ply     the survey (core/survey/survey.h)
//   geo_residuals.csv           per photo: camera position, tag, residual, AGL
//   cameras.geojson             camera positions, when geo-referenced (opens in QGIS)
//   colmap/                     database, models and log, when COLMAP was run; a second call continues where the first one stopped
// A folder with simulate.json is a simulated survey: its model is taken as given and its truth is kept with the survey.
#pragma once

#include <filesystem>

#include "core/base/thread_pool.h"
#include "core/survey/survey.h"
#include "prepare/prepare_options.h"

namespace skyquilt::prepare {

struct PrepareInput {
  std::filesystem::path photos;      // folder, searched recursively; may be a simulate folder or one that keeps its photos in images/
  std::filesystem::path model;       // folder with cameras/images/points3D; empty: COLMAP is run (simulate folder: its own model)
  std::filesystem::path out_folder;  // created if needed
};

// Throws base::UsageError for options that cannot be, base::InputError when fewer than 3 usable photos remain or something cannot be read or
// written, base::Interrupted when asked to stop. Photos that cannot be used are dropped with a warning that names them.
survey::Survey Prepare(const PrepareInput& input, const PrepareOptions& options, base::ThreadPool& threads);

}  // namespace skyquilt::prepare
