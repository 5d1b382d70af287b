// Photos with known attitudes in an arbitrary model frame, for tests of single parts of the geo-reference.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/random.h"
#include "core/geo/transform.h"
#include "prepare/input/prepared_photo.h"

namespace skyquilt::test {

// Degrees. Yaw is clockwise from north, pitch -90 looks straight down, positive roll lowers the right side.
struct Attitude {
  double yaw_deg = 0.0;
  double pitch_deg = -90.0;
  double roll_deg = 0.0;
};

// The camera's rotation, from three rotations about the axes of an aircraft in north, east, down.
Eigen::Quaterniond CamFromEnu(const Attitude& attitude);

geo::Similarity3d RandomFrame(base::Random& random);

prepare::input::PreparedPhoto PreparedAt(const Eigen::Vector3d& centre_in_enu, const Attitude& attitude, const geo::Similarity3d& model_from_enu);

// A rotation of normal noise about all three axes.
Eigen::Quaterniond SmallRotation(double sigma_deg, base::Random& random);

// Lines of `kLine` photos to the north and back, 15 m apart, at 5 m/s, around the origin; ENU metres.
constexpr int kLine = 10;
constexpr double kPhotoInterval_s = 3.0;
Eigen::Vector3d OnLawnmower(int photo, int n_photos);
// Along the lawnmower: looking straight down in the direction of flight, with capture times, without GPS.
std::vector<prepare::input::PreparedPhoto> LawnmowerPhotos(int n_photos, const geo::Similarity3d& model_from_enu);

double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace skyquilt::test
