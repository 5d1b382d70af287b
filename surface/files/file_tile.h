// Tiles and points as the writers of files take them.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "surface/map_frame.h"
#include "surface/mesh.h"

namespace skyquilt::surface {

// Keeps triangles with three different corners and finite coordinates, and the vertices that they use. All normals have length 1 (up where there was
// none) and all texture coordinates are finite. A tile without triangles left is empty. Throws std::logic_error when the vectors do not fit together.
TexturedTile CleanTile(const TexturedTile& tile);

// The vertices of a tile in coordinates of the maps.
struct MapVertices {
  std::vector<Eigen::Vector3d> position;  // easting, northing, height minus MapFrame::offset()
  std::vector<Eigen::Vector3f> normal;    // length 1
};
MapVertices VerticesInMap(const TexturedTile& tile, const MapFrame& frame);
// Position and normal of all finite points in coordinates of the maps, the offset not subtracted.
std::vector<CloudPoint> PointsInMap(std::span<const CloudPoint> points, const MapFrame& frame);

// Side of a texel on the surface, metres; 0 without a texture.
double TexelSize(const TexturedTile& tile);

}  // namespace skyquilt::surface
