// What prepare does with a camera model of another program: its place on Earth where photos have no GPS, its split into training and test photos.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "prepare/input/prepared_photo.h"
#include "prepare/models/input_model.h"

namespace skyquilt::prepare {

// Whether a model of another program than COLMAP has no sparse points, which give the heights above ground and the start of the scene.
bool LacksPoints(const models::InputModel& model);
// Throws base::InputError where there is no such COLMAP to triangulate points for the model, naming the model and what else would give it points.
void RequireColmap(const models::InputModel& model, const std::filesystem::path& path, const std::string& colmap);
// Gives all photos the positions that the model states, when too few have a tag of their own for a fit (kMinAgreeing). The accuracy of these
// positions is unknown; they count as those of a receiver without stated accuracy.
void PlaceByModel(const models::ModelPlace& place, std::vector<input::PreparedPhoto>& photos);
// Marks the photos that the model holds out as test photos, instead of every N-th; nothing when the model has no split; a warning when no
// photo of its split has a pose. Throws base::InputError when
// none is left to train on.
void HoldOutByModel(const models::InputModel& model, const std::filesystem::path& path, survey::Survey& survey);

}  // namespace skyquilt::prepare
