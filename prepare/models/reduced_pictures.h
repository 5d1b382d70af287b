// The form of the scenes of LLFF and Mip-NeRF 360: COLMAP's model in sparse/0, the pictures in images/, and the same pictures made smaller in
// images_2, images_4 and images_8, which published results train on. LLFF's smaller pictures have other names: both lists, each in name order, are
// the same pictures (Barron et al. 2022, github.com/google-research/multinerf, internal/datasets.py).
#pragma once

#include <filesystem>

#include "prepare/models/input_model.h"

namespace skyquilt::prepare::models {

// For a model that was read from `colmap_folder`. Does nothing unless that is sparse/0 of a scene with such pictures. Else gives images the names of
// the smaller pictures when those are the photos, and holds out every eighth (kHoldOutEvery) of the model's images in name order. Throws
// base::InputError when names differ and the lists are not of one length.
void UseReducedPictures(const std::filesystem::path& colmap_folder, const ModelPhotos& photos, InputModel& model);

}  // namespace skyquilt::prepare::models
