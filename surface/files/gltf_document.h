// A binary glTF 2.0 file (GLB): textured primitives without lighting, in one mesh of one node.
// The binary part may be larger than memory: it is given back piece by piece, and the head that stands before it is made last.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "surface/mesh.h"

namespace skyquilt::surface {

// A vector in glTF's axes, y up, from one with z up.
inline Eigen::Vector3f YUp(const Eigen::Vector3f& z_up) {
  return {z_up.x(), z_up.z(), -z_up.y()};
}

struct GltfPrimitive {
  std::string name;
  std::vector<Eigen::Vector3f> position;  // y up
  std::vector<Eigen::Vector3f> normal;    // y up, length 1
  std::span<const Eigen::Vector2f> uv;    // (0, 0) the upper left corner of the picture
  std::span<const Triangle> triangle;
  std::span<const uint8_t> jpeg;  // of the texture; empty: none
};

// What a person needs to know about the coordinates, and where the node stands.
struct GltfPlace {
  std::string crs;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  std::string vertical;
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // of the node, y up
};

class GltfDocument {
 public:
  // Returns the bytes to append to the binary part.
  std::vector<uint8_t> Add(const GltfPrimitive& primitive);
  uint64_t binary_bytes() const { return binary_bytes_; }
  int64_t triangles() const;
  int64_t textures() const;
  // Everything before the binary part. The lengths in it have 32 bits: throws base::InputError, which names the file, when the whole file is larger
  // than max_bytes.
  std::vector<uint8_t> Head(const GltfPlace& place, const std::filesystem::path& file, uint64_t max_bytes = UINT32_MAX) const;

 private:
  struct Part {
    std::string name;
    uint64_t vertices = 0, triangles = 0;
    std::array<uint64_t, 5> offset = {}, bytes = {};  // positions, normals, texture coordinates, indices, picture
    bool short_indices = false;
    Eigen::Vector3f min, max;
  };
  std::vector<Part> parts_;
  uint64_t binary_bytes_ = 0;
};

}  // namespace skyquilt::surface
