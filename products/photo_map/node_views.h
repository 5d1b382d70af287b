// The photos that see a node of the map, and what they and the field show of it.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "products/photo_map/map_nodes.h"

namespace skyquilt::products {

using Colors = std::array<float, 3>;

struct NodeView {
  double cost = 0.0;
  int32_t photo = -1;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // of the full photo
};

// Finds the photos that see a place.
class ViewFinder {
 public:
  // input must outlive it.
  explicit ViewFinder(const PhotoMapInput& input);

  // Photos that may see places within radius_m of the centre.
  std::vector<int32_t> Around(const Eigen::Vector3d& centre_enu, double radius_m) const;
  // Photos that see the place, best first, `most` at most. Where none does, those with it in their frame: cells around it may be seen. place_map: the
  // same place on the map. Returns the number of photos with it in their frame, kMostSeen at most.
  int Find(const Eigen::Vector3d& place_enu, const Eigen::Vector3d& place_map, std::span<const int32_t> photos, size_t most,
           std::vector<NodeView>* views) const;

 private:
  double SlackAt(const Eigen::Vector3d& place_map) const;

  const PhotoMapInput& input_;
  std::vector<Eigen::Vector3d> eyes_enu_, eyes_map_;
};

// Colour of a photo at a pixel of the full photo, as its small picture shows it; nothing where it is masked or cannot be read.
// *held keeps its small picture.
std::optional<Colors> SmallColor(const PhotoMapInput& input, survey::PhotoPictures& small, const NodeView& view,
                                 std::shared_ptr<const survey::PhotoPicture>* held);
// Radius2 of the view's pixel.
float Radius2Of(const PhotoMapInput& input, const NodeView& view);
// Mean display values of the field around a place; nothing where the field has no surface.
std::optional<Colors> FieldColor(const PhotoMapInput& input, const Eigen::Vector2d& easting_northing);

}  // namespace skyquilt::products
