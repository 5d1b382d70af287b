// The part of a COLMAP model that the accuracy of a camera is computed from: photos of that camera and the points that they see.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/survey/colmap_model.h"

namespace skyquilt::prepare::bundle {

struct Sighting {
  int photo = 0;                                    // index into CameraSample::cam_from_world
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // as measured
};

struct SamplePoint {
  Eigen::Vector3d x_in_world = Eigen::Vector3d::Zero();
  std::vector<Sighting> sightings;  // in at least three photos
};

struct CameraSample {
  std::vector<geo::Rigid3d> cam_from_world;  // in name order
  std::vector<SamplePoint> points;
  double share_of_points = 1.0;  // of those that could have been taken
};

// The largest part that is connected by points. `max_photos` consecutive photos (in name order) are taken from the middle of all of the camera, and
// `max_points` evenly chosen points. Photos with fewer than kMinSightings are left out. Empty when nothing remains.
CameraSample SelectSample(const survey::ColmapModel& model, const survey::ColmapObservations& observations, uint32_t camera_id, size_t max_photos,
                          size_t max_points);

constexpr int kMinSightings = 12;

}  // namespace skyquilt::prepare::bundle
