// Draws training rays. Photos are cut into tiles; a field is given the tiles it should learn from, so that a block spends its rays on
// pixels that show it. Drawing is a pure function of (seed, step, index): nothing to save, any thread may draw any ray.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/base/random.h"
#include "core/camera/camera.h"
#include "core/image/pixel_cache.h"
#include "core/survey/survey.h"

namespace skyquilt::worker {

struct PixelRay {
  Eigen::Vector3d origin_enu;
  Eigen::Vector3d direction_enu;  // length 1
  float target_srgb[3] = {0, 0, 0};
  float gain = 1.0F;   // recorded light over light at reference exposure
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
  // gains: one per survey photo. The cache's image sizes decide the pixel grid.
  RaySource(const survey::Survey& survey, const image::PixelCache& pixels, const std::vector<float>& gains);

  // Rays come from `inside` tiles, a share of them from `empty` tiles as emptiness rays. Tiles count by their number of pixels.
  void SetTiles(std::vector<Tile> inside, std::vector<Tile> empty, double empty_share);
  // Mean display value of all training rays at the reference exposure.
  std::array<float, 3> MeanColor(uint64_t seed) const;
  bool HasRays() const { return !inside_.empty(); }
  // False when an ignored (masked) pixel was drawn several times in a row.
  bool Draw(base::Random& random, PixelRay* ray) const;

  // Camera reduced to the cached size, and the ray through a pixel position.
  const camera::Camera& CameraOf(int photo) const { return cameras_[static_cast<size_t>(photo)]; }
  void RayThrough(int photo, const Eigen::Vector2d& pixel, Eigen::Vector3d* origin_enu, Eigen::Vector3d* direction_enu) const;
  // Mean display values of a photo's tiles at the reference exposure, each from a few of its pixels; NaN where all of them are ignored (masked).
  // [row][column].
  std::vector<Eigen::Vector3f> TileColors(int photo) const;
  // Pixel position of a tile's centre.
  Eigen::Vector2d TileCentre(const Tile& tile) const;

 private:
  const survey::Survey& survey_;
  const image::PixelCache& pixels_;
  std::vector<float> gains_;
  std::vector<camera::Camera> cameras_;     // per photo, at cached size
  std::vector<geo::Rigid3d> enu_from_cam_;  // per photo
  std::vector<Tile> inside_, empty_;
  double empty_share_ = 0.0;
};

// Every tile of the given photos that are not held out.
std::vector<Tile> TrainingTiles(const survey::Survey& survey, const std::vector<int>& photos);

}  // namespace skyquilt::worker
