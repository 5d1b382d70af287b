// Places a levelled reconstruction by its tags: the start of the adjustment.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "core/geo/transform.h"
#include "prepare/georeference/gravity.h"
#include "prepare/georeference/height_bias.h"
#include "prepare/georeference/horizontal_fit.h"
#include "prepare/georeference/place_options.h"
#include "prepare/georeference/tags/tags.h"
#include "prepare/georeference/tags/track.h"

namespace skyquilt::prepare::georeference {

// What a fit of tags needs to know of the flight.
struct TaggedFlight {
  const std::vector<input::PreparedPhoto>& photos;
  const Track& track;
  const std::vector<int>& flight;  // of each photo
  const PlaceOptions& options;
};

// Lags of the tags to try, seconds; only 0 where photos have no times or prepare.tag_lag is off.
std::vector<double> LagsToTry(const TaggedFlight& flight);
// Scale, direction, horizontal place and lag, with a threshold that suits the noise of the tags.
HorizontalFit FitLevelled(const TaggedFlight& flight, const std::vector<Tag>& tags, const Eigen::Matrix3d& level_from_model);
// The similarity of a horizontal fit; its height comes from the median of the tags.
geo::Similarity3d SimilarityOfFit(const TaggedFlight& flight, const std::vector<Tag>& tags, const Eigen::Quaterniond& level_from_model,
                                  const HorizontalFit& fit);
// Heights of the tags against a reconstruction placed by `start`, for ChooseBias. `middle` is in the model's frame.
HeightObservations ObserveHeights(const TaggedFlight& flight, const std::vector<Tag>& tags, const geo::Similarity3d& start, const HorizontalFit& fit,
                                  const Gravity& gravity, const Eigen::Vector3d& middle);
// `start` rotated about a point (ENU) and raised, by the first three numbers of a solution for the heights.
geo::Similarity3d Turned(const geo::Similarity3d& start, const Eigen::Vector3d& point, const Eigen::VectorXd& solution);
// All photos on about one straight line: ratio of the smaller to the larger horizontal spread of the positions below 5 %.
bool OnOneLine(const std::vector<input::PreparedPhoto>& photos, const Eigen::Matrix3d& level_from_model);

}  // namespace skyquilt::prepare::georeference
