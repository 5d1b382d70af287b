// Sparse points as structure from motion would have found them: surface points seen unoccluded by at least three photos, with small errors.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/camera/camera.h"
#include "core/survey/colmap_model.h"
#include "simulate/flight.h"
#include "simulate/world.h"

namespace skyquilt::simulate {

struct SurfaceSeed {
  int photo = 0;  // index of the photo it was found in
  int x = 0;      // pixel there
  int y = 0;
  std::array<uint8_t, 3> rgb{};
};

// Pixels of one photo at which to look for points, spread over it; colours are the caller's to fill in.
std::vector<SurfaceSeed> ChooseSeeds(const camera::Camera& camera, int photo, int count, uint32_t seed);

// Traces the seeds to the fixed scenery (water, leaves at grazing angles and moving cars are left out), finds the photos that see them and keeps
// those with three or more. Image ids are index + 1. Points are off by about error_px pixels' worth of ground.
std::vector<survey::ColmapPoint> MakeSparsePoints(const World& world, const camera::Camera& camera, const std::vector<PhotoPlan>& photos,
                                                  const std::vector<SurfaceSeed>& seeds, uint32_t seed, base::ThreadPool& threads);

}  // namespace skyquilt::simulate
