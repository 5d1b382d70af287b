// Where surfaces are along the rays of photos that look level, known from sparse points before any field is trained. Photos that look down start from
// a height map (point_surface.h); walls, rooms and streets have no single height over a place. Here every tile of a photo gets the distances of the
// points that this photo observed in the tile and around it, with slack on both sides: what is nearer is free space, what is farther is hidden.
// Frame: survey ENU, metres along the ray.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/survey/survey.h"
#include "worker/rays/ray_source.h"

namespace skyquilt::worker {

class PointRanges {
 public:
  struct Range {
    // 0.8 of the distance of the nearest point around the tile, or of the photo's nearest points where none is around it; at most 0.8 of the way to
    // the floor and to the ceiling
    float near = 0.0F;
    float nearest = 0.0F;  // of the points around the tile; infinite: none
    float farthest = 0.0F;
    float far = 0.0F;                                      // 1.25 times that of the farthest; infinite: none
    float plane = std::numeric_limits<float>::infinity();  // distance of the floor or the ceiling; infinite: not known
    // Tiles from here to the nearest that shows anything but sky; 0: this one does. There are no points in tiles of sky, they are above the horizon,
    // and their colours are bright, not reddish and much alike up to the upper edge of the photo.
    int open_sky = 0;
    bool Sky() const { return open_sky > 0; }
    bool Known() const;  // whether points are around it
  };

  PointRanges() = default;  // Empty()
  // Of the training photos among `photos`. Empty unless these look level (survey::LooksLevel), and for surveys without tracks. Observations in
  // held-out photos do not count.
  PointRanges(const survey::Survey& survey, const RaySource& source, const std::vector<int>& photos, base::ThreadPool& threads);

  bool Empty() const { return ranges_.empty(); }
  // Of a training photo's tile.
  const Range& Of(const Tile& tile) const;
  // Whether every pixel of the tile shows sky, as those around it do, too. False where these ranges are empty.
  bool OpenSky(const Tile& tile) const { return !Empty() && Of(tile).open_sky > 1; }
  // Tells the source, for training photos, which colour the sky has beside tiles that are near it (RaySource::FindSkyPixels).
  void GiveSky(RaySource& source, base::ThreadPool& threads) const;
  // Whether the photo's surfaces may be at a ball around a place that its image shows: neither nearer nor farther than the range there, nor
  // before the sky. True for photos that were not given.
  bool MayShow(int photo, const Eigen::Vector3d& x_in_enu, double radius_m) const;

  // Whether a place is nearer to the camera of a training photo than 0.8 of the distance of the nearest points, in whatever direction, or as near to
  // the way from such a camera to the next one of the same flight, where the two reach one another: there the camera was carried or flown. All of a
  // ball around the place must be nearer to it than 0.8 of the height of the floor below and, where no photo shows the sky, of the ceiling above:
  // plain ones have no points, and are taken to be as low and as high as the points around the camera on the map.
  bool InFreeSpace(const Eigen::Vector3d& x_in_enu, double radius_m) const;

 private:
  // Whether a tile has points in it, or around it.
  enum class Points : uint8_t { kNone, kClose, kInside };
  std::vector<Points> FindRanges(const survey::Survey& survey, const RaySource& source, int photo, const std::vector<uint32_t>& observed);
  void FindSky(const RaySource& source, int photo, const std::vector<Points>& points);
  // Whether what looks like sky are walls and ceilings, because in many of its directions there are points above it.
  bool IsIndoors(const survey::Survey& survey, const RaySource& source, const std::vector<int>& photos, base::ThreadPool& threads) const;
  void FindOpenSky(int photo);
  void FindFreeBalls(const survey::Survey& survey, const std::vector<int>& photos, base::ThreadPool& threads);
  // Leaves floors and ceilings out of what is free along the rays of a photo's tiles.
  void KeepFloorAndCeiling(const RaySource& source, int photo);

  struct FreeBall {
    Eigen::Vector3d centre_enu = Eigen::Vector3d::Zero();
    double radius_m = 0.0;
    double floor_m = 0.0, ceiling_m = 0.0;  // z; infinite where there is none
    bool reaches_next = false;              // the ball of the next photo of the same flight: what lies between them is free, too
  };
  std::vector<FreeBall> free_balls_;  // of the training photos; empty when there are too few points
  std::vector<int32_t> first_;        // per photo of the survey: of its tiles in ranges_; -1: none
  std::vector<Range> ranges_;         // [row][column] of each photo
  std::vector<const camera::Camera*> cameras_;
  std::vector<geo::Rigid3d> cam_from_enu_;
};

}  // namespace skyquilt::worker
