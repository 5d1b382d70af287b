// A small nadir flight over gentle hills: photos with tags, and a COLMAP model in an arbitrary frame.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/geo/geodetic.h"
#include "core/geo/transform.h"
#include "core/survey/colmap_model.h"
#include "core/survey/exif.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::test {

constexpr double kFlightHeight_m = 50.0;  // above the mean ground, which is at ENU z = 0

struct FlightPhoto {
  std::string name;
  Eigen::Vector3d centre_in_enu;
  survey::PhotoTags tags;
};

struct Flight {
  geo::Geodetic origin;  // ground level at the middle
  geo::Similarity3d model_from_enu;
  std::vector<FlightPhoto> photos;  // 5 x 4, in name order
  survey::ColmapModel model;        // in the model's frame
};

// `origin` may be anywhere on Earth.
Flight MakeFlight(const geo::Geodetic& origin);
// Sets the ENU position of every tag to `tag(photo index, true centre)`.
void SetTags(Flight& flight, const std::function<Eigen::Vector3d(size_t, const Eigen::Vector3d&)>& tag);
// Writes photos to `folder`/images and the model as text to `folder`/sparse/0.
void WriteFlight(const Flight& flight, const std::filesystem::path& folder);

}  // namespace skyquilt::test
