// Colours of the cells of a map from the photos that see them, blended where one photo follows another.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/image/image.h"
#include "core/survey/survey.h"
#include "products/overlap_gains.h"
#include "products/photo_choice.h"

namespace skyquilt::products {

// A photo reduced to about the resolution of the map. Empty when it is not used or cannot be read.
struct MosaicPhoto {
  image::Image8 rgb;
  image::Image8 mask;  // 0 = ignored pixel; empty: none
  camera::Camera camera;
  geo::Rigid3d cam_from_enu;
  Eigen::Vector3d eye_enu = Eigen::Vector3d::Zero();
  std::array<float, 3> gain = {1.0F, 1.0F, 1.0F};  // factor on linear light
};

// Reads the chosen photos (1), with a progress bar. cell_m: of the map. failures: names and reasons of those that cannot be read.
std::vector<MosaicPhoto> ReadMosaicPhotos(const survey::Survey& survey, std::span<const char> chosen, double ground_z, double cell_m,
                                          base::ThreadPool& threads, std::vector<std::string>* failures);

// Sets the gains of the photos, from what they show at the places.
void EqualiseBrightness(std::span<const Eigen::Vector3d> places_enu, std::span<const BestViews> views, std::vector<MosaicPhoto>* photos);

// Display values and alpha (255, or 0 where no photo sees the place) of one place. candidates: photos that may see it, in any order, without repeats.
// The photos' weights fall with their ViewCost above the least, and towards the rim of their frames, so that no border of a photo is a step.
class MosaicPainter {
 public:
  MosaicPainter(const std::vector<MosaicPhoto>& photos, double typical_height_m);
  std::array<uint8_t, 4> ColorAt(const Eigen::Vector3d& place_enu, std::span<const int32_t> candidates) const;

 private:
  const std::vector<MosaicPhoto>& photos_;
  double typical_height_m_;
};

}  // namespace skyquilt::products
