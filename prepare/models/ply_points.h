// Reads the points of a PLY file of any program: element "vertex" with x, y, z and, if there, red, green, blue (Turk 1994). ASCII and binary of
// both byte orders; other properties are skipped, other elements must come after the vertices.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace skyquilt::prepare::models {

struct PlyPoint {
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  std::array<uint8_t, 3> rgb{};
};

// Throws base::InputError: not such a file, fewer points than the header says, a coordinate that is not finite. Names the line in ASCII and header.
std::vector<PlyPoint> ReadPlyPoints(const std::filesystem::path& file);

}  // namespace skyquilt::prepare::models
