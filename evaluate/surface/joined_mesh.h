// All textured tiles of a surface as one mesh in single precision, for tracing rays and measuring distances.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "surface/mesh.h"

namespace skyquilt::evaluate::surface {

struct SurfaceMesh {
  struct Atlas {
    std::vector<uint8_t> jpeg;    // RGB; empty: the tile has no texture, or it is in the file
    std::filesystem::path file;   // of the baked tile, when its texture stays there; otherwise empty
    uint32_t first_triangle = 0;  // triangles of the tile: from here to the first one of the next
  };

  SurfaceMesh() = default;
  // Triangles with a corner that is not finite or does not exist are left out.
  // files: of the tiles, in their order; then textures are not kept, but read when they are needed. Empty: kept.
  explicit SurfaceMesh(std::vector<skyquilt::surface::TexturedTile> tiles, const std::vector<std::filesystem::path>& files = {});
  // Of the finest tiles in these files, one tile with its texture in memory at a time. Throws base::InputError.
  static SurfaceMesh FromFiles(const std::vector<std::filesystem::path>& files);

  // The texture of a tile; empty: it has none. Throws base::InputError when its file cannot be read any more. Thread-safe.
  std::vector<uint8_t> JpegOf(size_t tile) const;
  bool HasTexture(size_t tile) const { return !atlas[tile].jpeg.empty() || !atlas[tile].file.empty(); }
  // Whether the triangle closes a gap: it is shown, but no measurement.
  bool IsFilled(uint32_t triangle_index) const { return !filled.empty() && filled[triangle_index] != 0; }
  // Index into `atlas`.
  size_t AtlasOf(uint32_t triangle_index) const;

  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // survey ENU, metres; positions are relative to it
  std::vector<Eigen::Vector3f> position;
  std::vector<Eigen::Vector2f> uv;  // as in surface::TexturedTile; one per position
  std::vector<std::array<uint32_t, 3>> triangle;
  std::vector<uint8_t> filled;  // per triangle, 1: IsFilled; empty: none
  std::vector<Atlas> atlas;     // one per tile, in the order given
};

}  // namespace skyquilt::evaluate::surface
