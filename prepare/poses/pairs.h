// Pairs of photos to match, chosen by place: neighbours all around each photo, also across flight lines, and no group of photos left apart.
#pragma once

#include <Eigen/Core>
#include <compare>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/geo/transform.h"
#include "prepare/poses/photo_places.h"
#include "prepare/poses/pose_options.h"

namespace skyquilt::prepare::poses {

// Numbers in the list of photos; a < b.
struct PhotoPair {
  uint32_t a = 0, b = 0;
  auto operator<=>(const PhotoPair&) const = default;
};

// Sorted lists of pairs, none twice.
using PhotoPairs = std::vector<PhotoPair>;

PhotoPairs AllPairs(size_t n_photos);

// For every photo with a place: of each sector of azimuth (of the target, as seen from the photo's own) the nearest photo, then the nearest ones in
// any direction, `neighbors` together; and `position_neighbors` by position of the camera where there are oblique photos. Photos at the same distance
// come in the order of their distance in the list, so that photos at one spot are paired with the next ones in name order. At most
// n * (neighbors + position_neighbors) pairs; each photo is in at least `neighbors` as far as there are so many others with a place.
PhotoPairs PairsInSpace(const std::vector<std::optional<PhotoPlace>>& places, const PairRules& rules);

// For every photo of `photos`, the ones before and after it in the list of `n_photos`.
PhotoPairs NamePairs(const std::vector<uint32_t>& photos, size_t n_photos, size_t reach);

// Adds pairs until every photo is connected with every other by a chain of pairs. costs(i): how bad a pair of photo i with each photo is (n_photos
// numbers, infinity: unknown); each group gets the `links` best pairs that lead out of it, of different photos in it. Throws base::Interrupted.
void ConnectGroups(size_t n_photos, size_t links, const std::function<std::vector<double>(uint32_t)>& costs, PhotoPairs& pairs);
// Number of groups that have no pair in common, photos without any pair included.
size_t CountGroups(size_t n_photos, const PhotoPairs& pairs);

// For ConnectGroups: squared distance between a photo's place and all others; infinity for those without a place.
std::vector<double> PlaceCosts(const std::vector<std::optional<PhotoPlace>>& places, uint32_t photo);

// Sorts and removes what is there twice.
void SortPairs(PhotoPairs& pairs);
// In either order; the numbers must differ.
PhotoPair MakePair(uint32_t a, uint32_t b);

// Chosen by poses that are known already: all pairs of a small survey. Otherwise each photo with its `neighbors` nearest by position and direction,
// and links between groups. cam_from_world: of the photos, any scale and direction of the world. Directions count as much as positions that differ by
// as much as the scene is likely to be away, judged by the distances between photos. Throws base::Interrupted.
PhotoPairs PairsByPose(const std::vector<geo::Rigid3d>& cam_from_world, const PairRules& rules);

}  // namespace skyquilt::prepare::poses
