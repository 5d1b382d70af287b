// The photos' GPS tags in the survey's frame, to draw and compare them with the fitted camera positions.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <vector>

#include "core/survey/survey.h"

namespace skyquilt::evaluate::control {

// ENU metres. The third value is NaN where the tag has no height.
struct TagPosition {
  Eigen::Vector3d recorded = Eigen::Vector3d::Zero();
  Eigen::Vector3d corrected = Eigen::Vector3d::Zero();  // by Photo::gps_correction_m
  Eigen::Vector3d residual = Eigen::Vector3d::Zero();   // fitted camera position minus corrected tag
};

// One per photo; empty for photos without a tag on Earth. All are empty without a geo-reference, because the frame is nowhere then.
std::vector<std::optional<TagPosition>> TagPositions(const survey::Survey& survey);

// The photos of each flight (indices into Survey::photos) in the order of their times; photos without a time first, in name order.
std::map<int, std::vector<size_t>> PhotosByFlight(const survey::Survey& survey);

}  // namespace skyquilt::evaluate::control
