// The two encodings of a COLMAP model, each read without judging the content; ReadColmapModel checks it.
#pragma once

#include <array>
#include <filesystem>

#include "core/survey/colmap_model.h"

namespace skyquilt::survey {

// Throw base::InputError: missing file, truncation, counts that the file's size cannot hold, unsupported camera model, lines that cannot be read.
ColmapModel ReadColmapBinary(const std::filesystem::path& folder);
ColmapModel ReadColmapTextFiles(const std::filesystem::path& folder);

// From its numbers as both encodings order them: quaternion w x y z, translation. Not normalized.
inline geo::Rigid3d PoseOf(const std::array<double, 7>& numbers) {
  return {Eigen::Quaterniond(numbers[0], numbers[1], numbers[2], numbers[3]), Eigen::Vector3d(numbers[4], numbers[5], numbers[6])};
}

}  // namespace skyquilt::survey
