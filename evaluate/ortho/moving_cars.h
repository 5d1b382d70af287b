// Whether cars that moved while photos were taken have left anything in the orthophoto.
#pragma once

#include <filesystem>
#include <vector>

#include "core/survey/survey.h"
#include "evaluate/ortho/compare_maps.h"
#include "surface/map_frame.h"

namespace skyquilt::evaluate::ortho {

struct MovingCars {
  int64_t cells = 0;      // under a moving car, or its shadow, of any of the photos, where both maps have data
  int64_t differing = 0;  // of them, those that differ by more than 20 of 255 in any colour
};

// photos: indices of those in use. masks_folder: <file name of the photo>.png, 0 on what moves; photos without a mask show no such thing. A cell is
// under a car when its place, at the surface's height, is seen in such a pixel. Throws base::InputError for damaged masks, base::Interrupted.
MovingCars CountMovingCars(const std::vector<OpenMaps>& maps, const Eigen::Vector2d& shift_m, const std::vector<size_t>& photos,
                           const std::filesystem::path& masks_folder, const survey::Survey& survey, const HeightMap& heights,
                           const skyquilt::surface::MapFrame& frame, base::ThreadPool& threads);

}  // namespace skyquilt::evaluate::ortho
