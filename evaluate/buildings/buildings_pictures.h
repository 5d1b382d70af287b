// Pictures of buildings for the report: each model drawn over the photo that shows it best.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "buildings/building.h"
#include "buildings/pictures/building_pictures.h"
#include "core/camera/camera.h"
#include "core/image/pixel_cache.h"
#include "core/survey/survey.h"

namespace skyquilt::evaluate::buildings {

using skyquilt::buildings::Building;
using skyquilt::buildings::BuildingSet;

struct BuildingPicture {
  std::string file;   // relative to the page; empty: no photo shows the building
  std::string photo;  // name
  int width = 0, height = 0;
};

// The camera of a part of the picture that is `scale` times enlarged; same lens.
camera::Camera CameraOfPart(const camera::Camera& camera, const skyquilt::buildings::PhotoPart& part, int scale);

// Writes images/building_<id>.jpg under report_folder for the chosen buildings (indices), one entry per building of the set. Photos are read from
// their files, which show more than the cache; from the cache where a file is gone. Throws base::InputError when a picture cannot be written.
std::vector<BuildingPicture> WriteBuildingPictures(const BuildingSet& set, std::span<const size_t> chosen, const survey::Survey& survey,
                                                   const image::PixelCache& pixels, const std::filesystem::path& report_folder);

}  // namespace skyquilt::evaluate::buildings
