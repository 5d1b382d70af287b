// Readers of COLMAP's two file formats, binary and text. They check the format only; ReadColmapModel and
// ReadColmapObservations check the content.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>

#include "core/survey/colmap_model.h"

namespace skyquilt::survey {

// Throw base::InputError: missing file, truncation, counts too large for the file, unsupported camera model, invalid lines.
ColmapModel ReadColmapBinary(const std::filesystem::path& folder);
ColmapModel ReadColmapTextFiles(const std::filesystem::path& folder);
ColmapObservations ReadObservationsBinary(const std::filesystem::path& folder);
ColmapObservations ReadObservationsText(const std::filesystem::path& folder);

// What COLMAP writes for a feature that belongs to no point (-1 in text).
constexpr uint64_t kNoPoint = std::numeric_limits<uint64_t>::max();

// Pose from the seven numbers of both formats: quaternion w x y z, then translation. The quaternion is not normalized.
inline geo::Rigid3d PoseOf(const std::array<double, 7>& numbers) {
  return {Eigen::Quaterniond(numbers[0], numbers[1], numbers[2], numbers[3]), Eigen::Vector3d(numbers[4], numbers[5], numbers[6])};
}

}  // namespace skyquilt::survey
