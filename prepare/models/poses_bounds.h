// poses_bounds.npy of LLFF, for scenes that were taken by hand facing forward, and of the data sets that kept its form.
// Conventions (Mildenhall et al. 2019, github.com/Fyusion/LLFF, "Using your own poses without running COLMAP"):
//   rows     one per picture, pictures in name order; 17 numbers: a 3 x 5 matrix row after row, then the nearest and the farthest depth
//   pose     the first four columns of the matrix, world_from_cam; the camera's axes are down, right, backwards
//   lens     the fifth column: height, width and focal length in pixels of the full-size pictures; principal point in the middle, no distortion
//   pixels   LLFF computes its poses with COLMAP, so the middle of the picture is width / 2 from its corner, as ours
//   frame    that of COLMAP's model, any
//   points   none; those of sparse/0 beside the file where that is the model it was made from
// The depths are not used.
#pragma once

#include <filesystem>

#include "prepare/models/input_model.h"

namespace skyquilt::prepare::models {

// Every eighth picture is held out, from the first on, as published results do. Throws base::InputError: as ReadNpyArray does, another number of
// columns, another number of pictures than rows, and no rotation, size or focal length where one should be.
InputModel ReadPosesBounds(const std::filesystem::path& file, const ModelPhotos& photos);

// Position of the pictures that published results of LLFF and Mip-NeRF 360 hold out: every eighth in name order, from the first on.
constexpr size_t kHoldOutEvery = 8;

}  // namespace skyquilt::prepare::models
