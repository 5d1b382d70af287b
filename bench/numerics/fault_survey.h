// Surveys for the geo-reference alone: the poses and tags of simulated flights with faults, without any pixel, in a random model frame.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/geo/geodetic.h"
#include "core/geo/place_accuracy.h"
#include "core/geo/transform.h"
#include "prepare/georeference/georeference.h"
#include "prepare/input/prepared_photo.h"
#include "simulate/simulate_options.h"

namespace skyquilt::bench {

struct FaultSurvey {
  geo::Geodetic origin;  // of the true ENU frame
  geo::Similarity3d enu_from_model;
  std::vector<prepare::input::PreparedPhoto> photos;
  std::vector<Eigen::Vector3d> points;  // on ground, roofs and trees, in the model's frame
};

// `camera_tilt_deg`: standard deviation per axis of a rotation that all cameras have against their mounting; drawn once, seeded by options.seed.
FaultSurvey MakeFaultSurvey(const simulate::SimulateOptions& options, double camera_tilt_deg);

// A flight with random place, size, noise and faults; everything follows from the seed.
simulate::SimulateOptions RandomFaults(uint64_t seed);

// Errors of a place that was found, and its stated accuracy.
struct PlaceErrors {
  bool georeferenced = false;
  double scale_percent = 0.0, tilt_deg = 0.0, yaw_deg = 0.0, horizontal_m = 0.0, vertical_m = 0.0;  // absolute
  geo::PlaceAccuracy sigma;
  double lag_s = 0.0;
  std::vector<std::string> problems = {};  // codes
};
PlaceErrors FindPlace(const FaultSurvey& survey, const prepare::georeference::PlaceOptions& options = {});

}  // namespace skyquilt::bench
