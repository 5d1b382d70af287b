// Draws training rays. Photos are cut into tiles; a field is given the tiles it should learn from, so that a block spends its rays on
// pixels that show it. Drawing is a pure function of (seed, step, index): nothing to save, any thread may draw any ray.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/base/random.h"
#include "core/brightness/response.h"
#include "core/camera/camera.h"
#include "core/image/pixel_cache.h"
#include "core/survey/survey.h"

namespace skyquilt::worker {

struct PixelRay {
  Eigen::Vector3d origin_enu;
  Eigen::Vector3d direction_enu;  // length 1
  float target_srgb[3] = {0, 0, 0};
  std::array<brightness::Exposure, 3> exposure;  // recorded light over light at reference exposure, per colour
  int photo = 0;
  bool empty = false;  // the surface lies behind the field: it must be transparent here
};

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

  // Takes over what the response says by now.
  void UpdateExposures();

  // Rays come from `inside` tiles, a share of them from `empty` tiles as emptiness rays. Tiles count by their number of pixels.
  void SetTiles(std::vector<Tile> inside, std::vector<Tile> empty, double empty_share);
  // Mean display value of all training rays at the reference exposure.
  std::array<float, 3> MeanColor(uint64_t seed) const;
  bool HasRays() const { return !inside_.empty(); }
  // False when an ignored (masked) pixel was drawn several times in a row.
  bool Draw(base::Random& random, PixelRay* ray) const;
  // Up to n neighbouring pixels of one row of a tile, from left to right, without ignored ones. Returns how many.
  int DrawPatch(base::Random& random, int n, PixelRay* rays) const;

  // Camera reduced to the cached size, and the ray through a pixel position.
  const camera::Camera& CameraOf(int photo) const { return cameras_[static_cast<size_t>(photo)]; }
  void RayThrough(int photo, const Eigen::Vector2d& pixel, Eigen::Vector3d* origin_enu, Eigen::Vector3d* direction_enu) const;
  // Mean display values of a photo's tiles at the reference exposure, each from a few of its pixels; NaN where all of them are ignored (masked).
  // [row][column].
  std::vector<Eigen::Vector3f> TileColors(int photo) const;
  // Squared distance of a pixel from its photo's principal point, 1 at the farthest corner.
  float Radius2(int photo, const Eigen::Vector2d& pixel) const;
  // Pixel position of a tile's centre.
  Eigen::Vector2d TileCentre(const Tile& tile) const;

 private:
  // False for an ignored pixel.
  bool RayOf(int photo, int x, int y, bool empty, PixelRay* ray) const;

  const survey::Survey& survey_;
  const image::PixelCache& pixels_;
  const brightness::Response& response_;
  std::vector<camera::Camera> cameras_;                         // per photo, at cached size
  std::vector<geo::Rigid3d> enu_from_cam_;                      // per photo
  std::vector<std::array<brightness::Exposure, 3>> exposures_;  // per photo, on the axis
  std::vector<double> per_radius2_;                             // per photo: 1 / squared pixels from the principal point to the farthest corner
  std::vector<Tile> inside_, empty_;
  double empty_share_ = 0.0;
};

// Every tile of the given photos that are not held out.
std::vector<Tile> TrainingTiles(const survey::Survey& survey, const std::vector<int>& photos);

}  // namespace skyquilt::worker
