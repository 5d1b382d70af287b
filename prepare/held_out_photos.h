// Held-out photos while a survey is prepared: which they are, and what prepare.holdout_poses makes of them.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/survey/colmap_model.h"
#include "prepare/georeference/georeference.h"
#include "prepare/holdout_poses.h"
#include "prepare/input/match_photos.h"
#include "prepare/input/prepared_photo.h"
#include "prepare/models/input_model.h"
#include "prepare/prepare_options.h"

namespace skyquilt::prepare {

// Names of the held-out photos, those of photos with a pose. Chosen while all of these still have it, so that the same ones are held out whatever
// prepare.holdout_poses does. `names`: of all photos.
std::set<std::string> ChooseHeldOut(const PrepareOptions& options, const models::InputModel& model, const std::filesystem::path& model_path,
                                    const std::vector<input::PreparedPhoto>& photos, const std::vector<std::string>& names);

// Takes the held-out photos out of the model. Nothing when their poses stay as the model has them; the log says why.
std::optional<WithheldPhotos> Withhold(const std::set<std::string>& held_out, const std::vector<input::PreparedPhoto>& photos,
                                       const std::filesystem::path& model_folder, bool has_observations, survey::ColmapModel& model,
                                       base::ThreadPool& threads);

// Puts withheld photos back into the model and the geo-reference. Returns all photos of the model in name order. Throws base::UsageError when none
// of them can be placed.
std::vector<input::PreparedPhoto> PutBack(const WithheldPhotos& withheld, const std::set<std::string>& held_out,
                                          const input::FileOfImage& file_of_image, const std::vector<input::PhotoFile>& files,
                                          survey::ColmapModel& model, georeference::Georeference& georeference);

}  // namespace skyquilt::prepare
