// What prepare does with a camera model of another program: its place on Earth where photos have no GPS, its split into training and test photos, and
// the pictures beside it that are none of its photos.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "prepare/georeference/scale_bars.h"
#include "prepare/input/list_files.h"
#include "prepare/input/prepared_photo.h"
#include "prepare/models/input_model.h"

namespace skyquilt::prepare {

// Whether a model of another program than COLMAP has no sparse points, which give the heights above ground and the start of the scene.
bool LacksPoints(const models::InputModel& model);
// Throws base::InputError where there is no such COLMAP to triangulate points for the model, naming the model and what else would give it points.
void RequireColmap(const models::InputModel& model, const std::filesystem::path& path, const std::string& colmap);
// Leaves out the files that a model which names all photos (InputModel::names_all_photos) does not name, with a line in the log. Other models change
// nothing.
void LeaveOutUnnamed(const models::InputModel& model, std::vector<input::InputFile>& files);
// Up in the model's frame as the model states it; nothing when it does not, or where kMinAgreeing photos have tags of their own.
std::optional<Eigen::Vector3d> UpByModel(const models::InputModel& model, const std::vector<input::PreparedPhoto>& photos);
// The unit that the model states as a scale bar of that length; none when it states none.
std::vector<georeference::ScaleBar> BarsByModel(const models::InputModel& model);
// Gives all photos the positions that the model states, when too few have a tag of their own for a fit (kMinAgreeing). The accuracy of these
// positions is unknown; they count as those of a receiver without stated accuracy.
void PlaceByModel(const models::ModelPlace& place, std::vector<input::PreparedPhoto>& photos);
// Marks the photos that the model holds out as test photos, instead of every N-th; nothing when the model has no split; a warning when no
// photo of its split has a pose. Throws base::InputError when
// none is left to train on.
void HoldOutByModel(const models::InputModel& model, const std::filesystem::path& path, survey::Survey& survey);

}  // namespace skyquilt::prepare
