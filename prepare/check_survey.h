// What a prepared survey is checked against, and how its user learns what was found: problems of the survey, and lines in the log.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <vector>

#include "core/survey/colmap_model.h"
#include "core/survey/survey.h"
#include "prepare/bundle/intrinsics_sigma.h"
#include "prepare/georeference/gimbal_check.h"
#include "prepare/input/prepared_photo.h"

namespace skyquilt::prepare {

// Throws base::InputError for the first problem about the place. `folder`: of the survey.
void RequirePlace(const survey::Survey& survey, const std::filesystem::path& folder);

// Of the camera with most photos, by the photos alone. Unknown when the model's observations cannot be read: they serve the checks alone.
bundle::LensAccuracy MeasureLens(const survey::ColmapModel& model, const std::filesystem::path& model_folder,
                                 const std::vector<input::PreparedPhoto>& photos, const survey::Survey& survey);

// Focal lengths that the tags say, by the camera ids of the model, in pixels.
std::map<uint32_t, double> TaggedFocals(const std::vector<input::PreparedPhoto>& photos, const survey::ColmapModel& model);

// These need the survey's photos, place and heights above ground.
void CheckFlightOf(const std::vector<input::PreparedPhoto>& photos, const bundle::LensAccuracy& lens, survey::Survey& survey);
// `focal_sigma`: as in georeference::CheckedResult.
void CheckAgainstTags(const std::vector<input::PreparedPhoto>& photos, const georeference::GimbalVerdict& gimbal, bool own_poses,
                      const std::function<double()>& focal_sigma, survey::Survey& survey);

void LogDirections(const survey::DominantDirections& directions);

// A problem for a survey whose parts have no features in common, and stand beside each other as their tags say. `model`: with its points.
void NoteParts(const survey::ColmapModel& model, survey::Survey& survey);

}  // namespace skyquilt::prepare
