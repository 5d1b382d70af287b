// A folder of one of the data sets that published methods are compared on (docs/input_models.md, "Published data sets"): which of its files are the
// camera model, which folder has the pictures, and which settings its published figures stand for.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/config/override.h"

namespace skyquilt::bench {

struct DataSet {
  std::string name;                         // "Blender", "MatrixCity", "LLFF" or "Mip-NeRF 360"
  std::filesystem::path model, pictures;    // as for prepare
  std::vector<config::Override> overrides;  // how the set's pictures are read
};

// folder: with transforms_train.json (Blender, MatrixCity, whose pictures may be ../../train/BLOCK/0000.png), with poses_bounds.npy (LLFF) or with
// sparse/0 (Mip-NeRF 360). pictures: a folder in it, such as images_4; empty: that of Blender's and MatrixCity's files; of the others images_4,
// images_8, images_2 or images, the first that is there. LLFF with sparse/0 has the lens of COLMAP; its own file stands for the split alone.
// Throws base::InputError when it is none of these, or has no such pictures.
DataSet FindDataSet(const std::filesystem::path& folder, const std::string& pictures);

}  // namespace skyquilt::bench
