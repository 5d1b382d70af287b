// Tagged positions in the survey's frame.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geo/geodetic.h"
#include "prepare/georeference/tags/tag_checks.h"
#include "prepare/input/prepared_photo.h"

namespace skyquilt::prepare::georeference {

// A tagged position in ENU metres.
struct Tag {
  size_t photo = 0;
  Eigen::Vector3d x_in_enu = Eigen::Vector3d::Zero();  // z is NaN where the tag has no usable height
  double horizontal_sigma_m = 3.0;                     // relative to other tags; their common scale is estimated
  double vertical_sigma_m = 4.5;
};

// Median of the tagged positions; its height is 0 where no tag has one. At least one photo must have a tag.
geo::Geodetic MedianPosition(const std::vector<input::PreparedPhoto>& photos);
// The tags in ENU about `origin`, in the order of `order`, which are numbers of photos. Heights that say nothing are NaN.
std::vector<Tag> CollectTags(const std::vector<input::PreparedPhoto>& photos, const std::vector<size_t>& order, const geo::Geodetic& origin,
                             HeightTags heights);
// Median of one of the two accuracies; at least one tag.
double MedianSigma(const std::vector<Tag>& tags, double Tag::*sigma);

}  // namespace skyquilt::prepare::georeference
