// `skyquilt simulate`: a drone survey of an invented place, with everything about it known.
//   images/IMG_0001.jpg ...            photos with EXIF and XMP tags as a drone writes them
//   sparse/0/{cameras,images,points3D}.txt   COLMAP model of the true poses; its frame is the ENU frame of the origin, metres
//   truth/depth/<stem>.tiff            of the test views (every test_every-th in name order): metres along the camera's z, NaN = sky
//   truth/masks/<name>.jpg.png         0 where a moving car or its shadow is seen; only photos that see one
//   truth/exposure.json, truth/buildings.json
//   simulate.json                      place, origin, options, suggested blocks; written last
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "simulate/simulate_options.h"

namespace skyquilt::simulate {

struct SimulateSummary {
  int n_photos = 0;
  int n_test = 0;
  int n_points = 0;
  int n_buildings = 0;
  int n_masks = 0;
  double seconds = 0.0;
};

// hamlet, town, smallcity, tidalflat.
std::vector<std::string> PlaceNames();

// Same options and seed: the same bytes, for any number of threads. A folder that holds an earlier simulation is written anew.
// Throws base::UsageError for impossible options (names the option), base::InputError if the folder cannot be written or holds photos of
// other origin, base::Interrupted.
SimulateSummary Simulate(const SimulateOptions& options, const std::filesystem::path& folder, base::ThreadPool& threads);

}  // namespace skyquilt::simulate
