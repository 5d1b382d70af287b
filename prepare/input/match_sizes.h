// Models made from the same photos in another size: from the originals where smaller copies are given (images_4), or from copies.
#pragma once

#include <filesystem>
#include <vector>

#include "core/survey/colmap_model.h"
#include "prepare/input/match_photos.h"
#include "prepare/input/photo_files.h"

namespace skyquilt::prepare::input {

// Whether one is the other one scaled: in the smaller of both, the sides agree to a pixel, since scaled sizes are rounded.
bool IsScaledSize(int width_a, int height_a, int width_b, int height_b);

// Scales the cameras of `model` to the photos (`file_of_image`: FindPhotos), with a line in the log; photos of another aspect keep theirs.
// Returns the model's folder for readers of observations: `model_folder` itself where nothing is scaled or `has_observations` is false; else
// `folder`, into which the scaled model is written with scaled observations (track entries without one are left out). Observations that cannot be
// read leave it as it is. Throws base::InputError when the folder cannot be written.
std::filesystem::path ScaleToPhotos(const FileOfImage& file_of_image, const std::vector<PhotoFile>& files, const std::filesystem::path& model_folder,
                                    bool has_observations, const std::filesystem::path& folder, survey::ColmapModel& model);

}  // namespace skyquilt::prepare::input
