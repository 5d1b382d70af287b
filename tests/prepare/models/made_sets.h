// Scenes of their own content in the forms of the data sets that everybody knows, with the rays that each form's documentation gives. The formulas of
// the rays are written from those documents, apart from the readers'.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace skyquilt::test {

struct SetRay {
  Eigen::Vector3d origin, direction;  // of length 1
};

struct MadeSet {
  std::filesystem::path photo_root;  // what a user gives as photos, and
  std::filesystem::path model;       // with --model
  std::vector<std::string> names;    // of the pictures below photo_root that the set names, in name order
  std::vector<std::string> test;     // those of its published split
  // The ray of picture `name` through the middle of its pixel (i, j), by the form's own documentation.
  std::function<SetRay(const std::string& name, int i, int j)> ray;
};

// Pictures are PNGs of kSetWidth x kSetHeight, one colour each.
inline constexpr int kSetWidth = 40, kSetHeight = 30;

// Camera to world of picture i, in NeRF's axes (right, up, back): rows of [R | t].
Eigen::Matrix<double, 3, 4> SetPose(int i);

MadeSet MakeBlender(const std::filesystem::path& folder);          // with val, and depths beside the pictures of test
MadeSet MakeLlff(const std::filesystem::path& folder);             // 17 pictures in images_4, whose names differ from those in images
MadeSet MakeMip360(const std::filesystem::path& folder);           // 17 pictures in images_4, COLMAP's model of 4 times their size
MadeSet MakeMatrixCitySplit(const std::filesystem::path& folder);  // aerial/: train, test and pose/block_A; another block, which it does not name
MadeSet MakeMatrixCityBlock(const std::filesystem::path& folder);  // train/block_1 alone, with rot_mat; no split

// The bytes of an .npy of version 1.0 with that header dictionary; values row after row.
std::string NpyBytes(const std::string& dictionary, const std::vector<double>& values);
std::string NpyOfDoubles(size_t rows, size_t columns, const std::vector<double>& values);

}  // namespace skyquilt::test
