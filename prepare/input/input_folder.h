// Finds photos, model and masks in the folder that the user gave: plain photos, a COLMAP project or the output of `simulate`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/geo/geodetic.h"
#include "core/survey/survey.h"
#include "prepare/input/masks/masks.h"

namespace skyquilt::prepare::input {

struct InputFolder {
  std::filesystem::path photo_root;  // absolute
  std::filesystem::path model;       // folder or file of a camera model (models/read_model.h); empty: COLMAP must be run
  MaskPlaces masks;
  std::optional<geo::Geodetic> exact_origin;  // the model already is in ENU about this origin (simulated survey)
  std::optional<survey::Truth> truth;         // of a simulated survey
};

// `photos` may be a folder of photos, a folder with the photos in images/, or a folder made by `simulate` (it has a simulate.json). `model` (a folder
// or a file) and `masks` (prepare.masks) are what the user gave; if empty, the usual places are searched: masks around the photos (masks/masks.h),
// and only for simulated surveys PHOTOS/sparse/0 as a model. Camera models that are there and not used are named in the log. Throws base::InputError
// for a missing folder, a model of an unknown format or a damaged simulate.json.
InputFolder FindInputs(const std::filesystem::path& photos, const std::filesystem::path& model, const std::string& masks);

// Camera models that lie in a folder: sparse/0 of COLMAP, transforms.json or transforms_train.json, poses_bounds.npy without
// sparse/0, reconstruction.json (also in opensfm/), .opf, a Metashape .xml; in this order.
std::vector<std::filesystem::path> ModelsIn(const std::filesystem::path& folder);

}  // namespace skyquilt::prepare::input
