// Small true surfaces and meshes for tests of their scores.
#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "core/survey/surface_class.h"
#include "evaluate/surface/joined_mesh.h"
#include "evaluate/surface/true_surface.h"

namespace skyquilt::evaluate::surface {

// Level rectangle seen from above, ENU metres.
struct Plate {
  double west = 0.0, south = 0.0, east = 0.0, north = 0.0, z = 0.0;
};

// Facing up.
inline void AddPlate(const Plate& plate, survey::SurfaceClass class_of, TrueSurface* truth) {
  const auto first = static_cast<uint32_t>(truth->position.size());
  for (const auto& [x, y] : {std::pair{plate.west, plate.south}, {plate.east, plate.south}, {plate.east, plate.north}, {plate.west, plate.north}}) {
    truth->position.push_back((Eigen::Vector3d(x, y, plate.z) - truth->middle).cast<float>());
  }
  truth->triangle.push_back({first, first + 1, first + 2});
  truth->triangle.push_back({first, first + 2, first + 3});
  truth->class_id.resize(truth->triangle.size(), static_cast<uint8_t>(class_of));
}

// A tile of one plate, facing up; its texture covers it, north up.
inline skyquilt::surface::TexturedTile PlateTile(const Plate& plate) {
  skyquilt::surface::TexturedTile tile;
  tile.position = {
      {plate.west, plate.south, plate.z}, {plate.east, plate.south, plate.z}, {plate.east, plate.north, plate.z}, {plate.west, plate.north, plate.z}};
  tile.uv = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  tile.triangle = {{0, 1, 2}, {0, 2, 3}};
  return tile;
}

inline SurfaceMesh MeshOf(const std::vector<Plate>& plates) {
  std::vector<skyquilt::surface::TexturedTile> tiles;
  for (const Plate& plate : plates) tiles.push_back(PlateTile(plate));
  return SurfaceMesh(std::move(tiles));
}

}  // namespace skyquilt::evaluate::surface
