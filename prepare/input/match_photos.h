// Which photo of the folder is which image of a camera model.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/survey/colmap_model.h"
#include "prepare/input/photo_files.h"
#include "prepare/input/prepared_photo.h"

namespace skyquilt::prepare::input {

// Index into the usable photos by the ids of images.
using FileOfImage = std::map<uint32_t, size_t>;

// The photo of each image, whatever its size, as PhotoNames::Find finds it by the image's name. Of several images that seem to be one photo, the one
// of the photo's path is it, or else the one whose path has more of its last parts in common with the photo's than any other; none when there are
// several such. No other image has that photo.
FileOfImage FindPhotos(const survey::ColmapModel& model, const std::vector<PhotoFile>& files);
// Those of FindPhotos that can be used. Photos without a file or of another size than their camera are left out with a warning. Throws
// base::InputError when fewer than kMinPhotos remain; `model_folder` and `photo_root` are for messages.
FileOfImage MatchPhotos(const survey::ColmapModel& model, const std::vector<PhotoFile>& files, const std::filesystem::path& model_folder,
                        const std::filesystem::path& photo_root);
// Those that the model has now, in name order, with its poses and the places that their tags say.
std::vector<PreparedPhoto> PreparePhotos(const survey::ColmapModel& model, const FileOfImage& file_of_image, const std::vector<PhotoFile>& files);

// The first of them, for messages.
std::string FewNames(const std::vector<std::string>& names);

}  // namespace skyquilt::prepare::input
