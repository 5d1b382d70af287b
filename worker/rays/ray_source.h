// Draws training rays. Photos are cut into tiles, and a field is given the tiles it should learn from, so that a block trains only on pixels that
// show it. Drawing depends only on the random generator given to it, so there is no state to save. Thread-safe except for UpdateExposures,
// SetPose, SetRejected, SetLeftOut and SetTiles.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/base/random.h"
#include "core/brightness/response.h"
#include "core/camera/camera.h"
#include "core/camera/corner_radius.h"
#include "core/camera/distortion.h"
#include "core/camera/pixel_pitch.h"
#include "core/image/pixel_cache.h"
#include "core/survey/survey.h"
#include "core/trust/left_out_tiles.h"
#include "worker/rays/photo_pyramid.h"
#include "worker/rays/photo_segments.h"

namespace skyquilt::worker {

struct PixelRay {
  Eigen::Vector3d origin_enu;
  Eigen::Vector3d direction_enu;                 // length 1
  float pixel_pitch = 0.0F;                      // width of its pixel at distance 1, radians (camera::PixelPitch times the pixel's size)
  int level = 0;                                 // its pixel is 1 << level photo pixels wide
  float target_srgb[3] = {0, 0, 0};              // recorded display value, 0..1
  std::array<brightness::Exposure, 3> exposure;  // recorded light divided by light at reference exposure, per colour
  int photo = 0;
  brightness::PicturePlace place = {0.0F, 0.0F};        // of its pixel in the photo
  bool empty = false;                                   // the surface is behind the field, or it is the sky: the field must be transparent there
  float point_distance_m = 0.0F, point_sigma_m = 0.0F;  // of a sparse point at its pixel, along the ray; sigma 0: none
};

struct DepthPoint;     // worker/rays/depth_points.h
class RejectedPixels;  // worker/robust/rejected_pixels.h

// Rays that are drawn together in one segment of a photo, and how far apart they are at most along each axis, pixels of the cached photo.
constexpr int kSegmentRays = 6;
constexpr int kSegmentReach = 16;

// Which pixels of the tiles at the sky's rim show the sky.
struct SkyPixels {
  std::vector<int32_t> first;  // per tile, of its pixels in `sky`, row by row; -1: not at the rim. Empty: no tile is
  std::vector<bool> sky;
};

// Tiles per photo.
constexpr int kTileColumns = 48;
constexpr int kTileRows = 36;

struct Tile {
  int photo = 0;
  int16_t column = 0, row = 0;
};

class RaySource {
 public:
  // response: of the survey's photos; must outlive the source. The cache's image sizes decide the pixel grid.
  RaySource(const survey::Survey& survey, const image::PixelCache& pixels, const brightness::Response& response);

  // Call it after the response has changed.
  void UpdateExposures();

  // No ray is drawn of these pixels, nor of squares that show one; null: of all. They must outlive the source.
  void SetRejected(const RejectedPixels* rejected) { rejected_ = rejected; }
  // Nor of these tiles, nor of squares that touch one.
  void SetLeftOut(const trust::LeftOutTiles& tiles) { left_out_ = tiles; }

  // Sets the tiles to draw from: `empty_share` of the rays come from `empty` tiles (PixelRay::empty is then true), the others from `inside` tiles.
  // All tiles of a list are equally likely.
  void SetTiles(std::vector<Tile> inside, std::vector<Tile> empty, double empty_share);
  // Colours of the sky beside the tiles of a photo, display values at reference exposure, [row][column], NaN where a tile is not at the sky's rim;
  // `open`: the tiles that show nothing but sky. Pixels of the rim that have this colour and join the open sky are sky, too: their rays are empty, so
  // that no matter gathers along the outlines of what stands before the sky. Windows that mirror it do not join it.
  // Several photos may be searched at once.
  void FindSkyPixels(int photo, const std::vector<Eigen::Vector3f>& srgb, const std::vector<char>& open);
  // Mean colour of the training rays, taken in linear light, as display values at reference exposure.
  std::array<float, 3> MeanColor(uint64_t seed) const;
  bool HasRays() const { return !inside_.empty(); }
  // Draws a ray; false when masked pixels were drawn several times in a row.
  bool Draw(base::Random& random, const PhotoPyramid& pyramid, PixelRay* ray) const;
  // Draws up to n neighbouring pixels of one row from left to right, without masked ones; photo pixels are from one tile. Returns their number.
  int DrawPatch(base::Random& random, const PhotoPyramid& pyramid, int n, PixelRay* rays) const;
  // Draws kSegmentRays pixels of a photo at full size. Returns true when all of them are in one segment; otherwise they are unrelated, and *drawn
  // says how many were found.
  bool DrawSegment(base::Random& random, const PhotoSegments& segments, PixelRay* rays, int* drawn) const;
  // The ray of the pixel that shows a sparse point; false when it is masked.
  bool PointRay(const DepthPoint& point, PixelRay* ray) const;

  // Of the survey, held-out ones too.
  size_t photos() const { return cameras_.size(); }
  // The camera at the cached image size.
  const camera::Camera& CameraOf(int photo) const { return cameras_[static_cast<size_t>(photo)]; }
  // Where the photo's rays come from: as prepared, until SetPose changes it.
  const geo::Rigid3d& PoseOf(int photo) const { return enu_from_cam_[static_cast<size_t>(photo)]; }
  void SetPose(int photo, const geo::Rigid3d& enu_from_cam) { enu_from_cam_[static_cast<size_t>(photo)] = enu_from_cam; }
  // The ray through a position in the cached image, pixels.
  void RayThrough(int photo, const Eigen::Vector2d& pixel, Eigen::Vector3d* origin_enu, Eigen::Vector3d* direction_enu) const;
  // Mean display values of a photo's tiles at reference exposure, [row][column], each from a few of its pixels; NaN where all of them are masked.
  std::vector<Eigen::Vector3f> TileColors(int photo) const;
  // As camera::CornerRadius::Squared, in the cached image.
  float Radius2(int photo, const Eigen::Vector2d& pixel) const { return corner_radii_[static_cast<size_t>(photo)].Squared(pixel); }
  // Place of a position in the cached image, for shading.
  brightness::PicturePlace PlaceOf(int photo, const Eigen::Vector2d& pixel) const;
  // With which a photo recorded a position of its cached image.
  std::array<brightness::Exposure, 3> ExposureAt(int photo, const Eigen::Vector2d& pixel) const;
  // Pixel position of a tile's centre.
  Eigen::Vector2d TileCentre(const Tile& tile) const;

 private:
  // The ray of a square of photo pixels whose first is (x, y); false when it is masked.
  bool RayOf(int photo, int x, int y, int level, bool empty, PixelRay* ray) const;
  bool ShowsSky(int photo, int x, int y) const;
  bool ShowsRejected(int photo, int x, int y, int size) const;

  const image::PixelCache& pixels_;
  const brightness::Response& response_;
  const RejectedPixels* rejected_ = nullptr;
  trust::LeftOutTiles left_out_;
  std::vector<camera::Camera> cameras_;                         // per photo, at cached size
  std::vector<camera::PixelPitch> pitches_;                     // of the different ones of them
  std::vector<camera::Lens> lenses_;                            // of the same
  std::vector<size_t> pitch_of_;                                // per photo, index of the two above
  std::vector<geo::Rigid3d> enu_from_cam_;                      // per photo
  std::vector<std::array<brightness::Exposure, 3>> exposures_;  // per photo, on the axis
  std::vector<camera::CornerRadius> corner_radii_;              // per photo
  std::vector<SkyPixels> sky_pixels_;                           // per photo
  std::vector<Tile> inside_, empty_;
  double empty_share_ = 0.0;
};

// All tiles of those of the given photos that are not held out.
std::vector<Tile> TrainingTiles(const survey::Survey& survey, const std::vector<int>& photos);

}  // namespace skyquilt::worker
