// The edges of a building's model in a photo.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "buildings/building.h"
#include "core/camera/camera.h"
#include "core/geo/transform.h"

namespace skyquilt::buildings {

// The solid that stands for a building in pictures.
inline const Solid& ModelOf(const Building& building) {
  return building.lod22.Empty() ? building.lod12 : building.lod22;
}

// A piece of an edge that is visible as a whole or not at all. points: pixels along it, a few pixels apart, bent by the lens; at least two.
struct ViewedPiece {
  std::vector<Eigen::Vector2d> points;
  bool hidden = false;  // behind the building's own faces; other buildings do not count
  bool roof = false;    // of a roof face
};
// Edges whose faces meet at angles. Parts behind the camera or where the lens has no image are left out; pixels may be outside the image.
std::vector<ViewedPiece> ViewEdges(const Solid& solid, const camera::Camera& camera, const geo::Rigid3d& cam_from_enu);

// Places along all edges, at most about a quarter of an edge apart, ends included.
std::vector<Eigen::Vector3d> PlacesOnEdges(const Solid& solid);

}  // namespace skyquilt::buildings
