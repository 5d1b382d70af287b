// What the seeding of poses gets from a flight, made from the simulator's cameras and points instead of pictures: features at the projections of the
// points, with noise, and matches of the pairs that `prepare` would match, of which some are wrong.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bench/poses/photo_sets.h"
#include "core/camera/camera.h"
#include "core/geo/enu_frame.h"
#include "core/survey/colmap_model.h"
#include "prepare/poses/seed/seed_input.h"
#include "simulate/flight.h"

namespace skyquilt::bench {

struct TrackErrors {
  double noise_px = 0.4;      // standard deviation per axis
  double seen_share = 0.5;    // of the photos that show a point, so many have a feature there
  double wrong_share = 0.02;  // of the matches: to any feature of the other photo
  double focal_share = 0.02;  // the focal length to begin with is too long by this
  uint64_t seed = 1;
};

struct SimulatedTracks {
  prepare::poses::SeedInput input;
  TrueSet truth;
  size_t n_features = 0, n_matches = 0, n_wrong = 0;
};

// Photos have image ids from 1 in the order of `photos`, and their tags. `points`: in ENU metres of `frame`, with the ids of the photos that show
// them. The same input gives the same numbers. Throws base::Interrupted.
SimulatedTracks MakeTracks(const camera::Camera& camera, const std::vector<simulate::PhotoPlan>& photos,
                           const std::vector<survey::ColmapPoint>& points, const geo::EnuFrame& frame, const TrackErrors& errors);

}  // namespace skyquilt::bench
