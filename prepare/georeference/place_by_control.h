// The part of the preparation that reads control points and lets them place the survey.
#pragma once

#include <filesystem>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/survey/colmap_model.h"
#include "core/survey/control_fit.h"
#include "prepare/control/reading/control_points.h"
#include "prepare/control/reading/read_control.h"
#include "prepare/georeference/georeference.h"
#include "prepare/georeference/place_options.h"
#include "prepare/input/photo_files.h"
#include "prepare/input/prepared_photo.h"

namespace skyquilt::prepare::georeference {

std::vector<control::PhotoSize> PhotoSizesOf(const std::vector<input::PhotoFile>& files);

// The control points of these files, none without a file of points: warnings are logged, and the points are near the photos' tags and enough where
// there are no tags. Throws as ReadControl, CheckNear and CheckGeometry do.
control::ControlPoints ReadControlPoints(const control::ControlFiles& given, const std::vector<input::PhotoFile>& files);

struct ControlInput {
  const PlaceOptions& options;
  const control::ControlPoints& control;
  std::filesystem::path model_folder;  // where the model's observations are read from
  bool has_observations = false;       // they are there, and are features of photos
  bool exact = false;                  // the frame of the model is the true one
};

// Does nothing without control points. When the control points place the survey, model, photos and geo-reference are those of the new frame
// afterwards; else the problems of the geo-reference say why not. Throws base::InputError when the survey has no place without control points and too
// few of them can be used.
survey::ControlFit PlaceByControl(const ControlInput& input, survey::ColmapModel& model, std::vector<input::PreparedPhoto>& photos,
                                  Georeference& georeference, base::ThreadPool& threads);

// Warns when the errors of the points' heights form a bowl or a dome that their accuracies do not explain; nothing when there are too few points.
std::vector<survey::Problem> BentByControl(const survey::ControlFit& fit);

}  // namespace skyquilt::prepare::georeference
