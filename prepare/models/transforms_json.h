// transforms.json of nerfstudio, instant-ngp, the synthetic scenes of NeRF (Blender) and MatrixCity.
// Conventions (docs.nerf.studio/quickstart/data_conventions.html; Mildenhall et al. 2020, github.com/bmild/nerf, load_blender.py; Li et al. 2023,
// github.com/city-super/MatrixCity, README.md and scripts/load_aerial.py):
//   pose     frames[].transform_matrix, 4 x 4 rows, world_from_cam; camera x right, y up, looks along -z (OpenGL). MatrixCity's blocks have rot_mat
//            in its place, whose rotation is a hundredth of one
//   lens     fl_x fl_y cx cy w h, for all frames or per frame; k1 k2 k3 p1 p2 are OpenCV's, k1..k4 of OPENCV_FISHEYE too
//            camera_angle_x: the horizontal angle of view in radians, fl = w / 2 / tan(angle / 2), principal point in the middle
//   pixels   the documentation says only that pixel (0, 0) is looked at through its centre. nerfstudio's converter passes COLMAP's cx on
//            unchanged, so cx counts from the image's corner, as ours.
//   names    frames[].file_path relative to the file; synthetic scenes leave out ".png". Beside rot_mat: the number frame_index, of the picture
//   0012.png
//            beside the file or in rgb/
//   frame    any; applied_transform tells how it was made and is not needed. ply_file_path: points in the same frame, without tracks. Blender's and
//            MatrixCity's z is up. Positions of MatrixCity: metres in its blocks, hundreds of metres in its splits (pose/). Members of our own, as
//            scripts/convert_mega_nerf.py writes them: up, three numbers, and metres_per_unit
// k4 of a perspective lens (nerfstudio: radius^8) has no counterpart in our models.
#pragma once

#include <filesystem>
#include <vector>

#include "prepare/models/input_model.h"

namespace skyquilt::prepare::models {

enum class TransformsPart { kWhole, kTrain, kVal, kTest };

struct TransformsFile {
  std::filesystem::path file;
  TransformsPart part = TransformsPart::kWhole;
};

// Reads the frames of all files as one model. Held out are those of kVal and kTest, and val_filenames and test_filenames of nerfstudio. Of Blender's
// scenes kVal is left out where there is kTest: published results neither train on it nor score it. Throws base::InputError; for Blender's scenes and
// MatrixCity also when a frame's picture is not there.
InputModel ReadTransforms(const std::vector<TransformsFile>& files, const ModelPhotos& photos);

}  // namespace skyquilt::prepare::models
