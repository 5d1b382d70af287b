// transforms.json of nerfstudio, instant-ngp and the synthetic scenes of NeRF (Blender).
// Conventions (docs.nerf.studio/quickstart/data_conventions.html; Mildenhall et al. 2020, blender_paper.ipynb):
//   pose     frames[].transform_matrix, 4 x 4 rows, world_from_cam; camera x right, y up, looks along -z (OpenGL)
//   lens     fl_x fl_y cx cy w h, for all frames or per frame; k1 k2 k3 p1 p2 are OpenCV's, k1..k4 of OPENCV_FISHEYE too
//            camera_angle_x: the horizontal angle of view in radians, fl = w / 2 / tan(angle / 2), principal point in the middle
//   pixels   the documentation says only that pixel (0, 0) is looked at through its centre. nerfstudio's converter passes COLMAP's cx on
//            unchanged, so cx counts from the image's corner, as ours.
//   names    frames[].file_path relative to the file; synthetic scenes leave out ".png"
//   frame    any; applied_transform tells how it was made and is not needed. ply_file_path: points in the same frame, without tracks
// k4 of a perspective lens (nerfstudio: radius^8) has no counterpart in our models.
#pragma once

#include <filesystem>
#include <vector>

#include "prepare/models/input_model.h"

namespace skyquilt::prepare::models {

struct TransformsFile {
  std::filesystem::path file;
  bool is_test = false;  // its photos are held out: transforms_val.json, transforms_test.json
};

// Reads the frames of all files as one model. val_filenames and test_filenames of nerfstudio are held out too. Throws base::InputError.
InputModel ReadTransforms(const std::vector<TransformsFile>& files, const ModelPhotos& photos);

}  // namespace skyquilt::prepare::models
