// Places a structure-from-motion model on Earth. Its frame has arbitrary position, rotation and scale. Gravity comes first (gravity.h), then scale,
// yaw and horizontal position from the GPS tags with their lag (horizontal_fit.h), then heights (height_bias.h), and finally one adjustment of all of
// them with its covariance (place_adjustment.h). A place that would be uncertain is not claimed: then the model gets a levelled local frame of
// unknown scale.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "core/geo/geodetic.h"
#include "core/geo/transform.h"
#include "core/survey/survey.h"
#include "prepare/georeference/gimbal_check.h"
#include "prepare/georeference/gravity.h"
#include "prepare/georeference/place_options.h"
#include "prepare/input/prepared_photo.h"

namespace skyquilt::prepare::georeference {

// How a photo's tag fits; zero and NaN without GPS or geo-reference.
struct TagFit {
  int flight = 0;                                          // of the photo, from 0
  Eigen::Vector3d correction_m = Eigen::Vector3d::Zero();  // what the fit adds to the tag, ENU
  // Fitted camera less corrected tag, ENU; z is NaN where heights are not used.
  Eigen::Vector3d residual_m = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  bool inlier = false;  // the tag agrees within the threshold
};

struct Georeference {
  bool ok = false;  // false: levelled local frame, unknown scale; the first problem says why
  geo::Geodetic origin;
  geo::Similarity3d enu_from_model;
  survey::GeoFit fit;
  std::vector<survey::Problem> problems;
  GimbalVerdict gimbal;        // dropped angles have no part in the result
  std::vector<TagFit> photos;  // in their order
};

// `points` are the sparse points in the model's frame, may be empty. Gimbal angles that stand alone against the photos and the tagged positions are
// not used (gimbal_check.h).
Georeference PlaceOnEarth(const std::vector<input::PreparedPhoto>& photos, const std::vector<Eigen::Vector3d>& points, const PlaceOptions& options);
// For a model that is already in ENU about `origin`: keeps its frame and only computes the residuals of the tags.
Georeference KeepExactFrame(const std::vector<input::PreparedPhoto>& photos, const geo::Geodetic& origin, const PlaceOptions& options);
// Frame for a model without GPS: z along `up`; origin: median of the points; the median depth of points in the cameras becomes kLocalDepth. `up` and
// `points` are in the model's frame; `points` may be empty.
geo::Similarity3d LocalFrame(const std::vector<input::PreparedPhoto>& photos, const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& up);

// Less accurate than this, no place is claimed.
constexpr double kMaxTiltSigma_deg = 5.0;
constexpr double kMaxScaleSigma_percent = 10.0;
constexpr int kMinAgreeing = 4;

constexpr double kLocalDepth = 40.0;  // local units, in place of metres

}  // namespace skyquilt::prepare::georeference
