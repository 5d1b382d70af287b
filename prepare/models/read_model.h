// Reads the camera model that the user gave with --model, in any of the formats that we know, and recognises which one it is.
#pragma once

#include <filesystem>

#include "prepare/models/input_model.h"

namespace skyquilt::prepare::models {

// A model's files, as found below a path.
struct ModelFiles {
  ModelFormat format = ModelFormat::kColmap;
  std::filesystem::path path;  // folder of a COLMAP model or, where a folder was given, of transforms_train.json; otherwise the file
};

// `path` is a file of one of the formats (transforms_train.json stands for _val and _test as well) or a folder that holds one. In a folder the first
// of these counts: COLMAP (cameras.bin or .txt), transforms.json, transforms_train.json with _val and _test, COLMAP in sparse/0, poses_bounds.npy,
// reconstruction.json (also in opensfm/), an .opf, a Metashape .xml. Throws base::InputError that lists the formats when there is none, or when
// several files could be meant.
ModelFiles FindModel(const std::filesystem::path& path);
// Throws base::InputError for a file that is damaged or not supported, with the line where the format has lines, and how to fix it.
InputModel ReadModel(const std::filesystem::path& path, const ModelPhotos& photos);

}  // namespace skyquilt::prepare::models
