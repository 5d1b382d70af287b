// Makes the sparse points of a simulated survey, like those of structure from motion: surface points seen by at least three photos, with small
// errors.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/camera/camera.h"
#include "core/image/image.h"
#include "core/survey/colmap_model.h"
#include "simulate/flight.h"
#include "simulate/world.h"

namespace skyquilt::simulate {

// A pixel at whose surface a sparse point is tried.
struct SurfaceSeed {
  int photo = 0;  // index of the photo it was found in
  int x = 0;      // pixel there
  int y = 0;
  std::array<uint8_t, 3> rgb{};
};

// About `count` pixels spread evenly over a photo. The caller fills in their colours.
std::vector<SurfaceSeed> ChooseSeeds(const camera::Camera& camera, int photo, int count, uint32_t seed);

// Whether a detector could find a feature at a pixel: not on plain walls and in the sky.
bool HasTexture(const image::Image8& rgb, int x, int y);

// Traces each seed to the static scene (not on water, moving cars and at grazing angles), finds the photos that see the point, and keeps points seen
// by three or more. Image ids are index + 1. Position errors follow from error_px and the ground sampling distance. Shows progress. Throws
// base::Interrupted.
std::vector<survey::ColmapPoint> MakeSparsePoints(const World& world, const camera::Camera& camera, const std::vector<PhotoPlan>& photos,
                                                  const std::vector<SurfaceSeed>& seeds, uint32_t seed, base::ThreadPool& threads);

}  // namespace skyquilt::simulate
