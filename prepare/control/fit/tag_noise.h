// GPS tags beside control points: how far they vary about a shift that they may have in common.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geo/enu_frame.h"
#include "prepare/bundle/bundle_problem.h"
#include "prepare/input/prepared_photo.h"

namespace skyquilt::prepare::control {

// Gives the tags to the bundle's photos, which must be about where they belong, with the accuracy of their scatter about the shift. Neighbours in
// time that err alike, as drifting heights do, say little, and their accuracy becomes that much worse; so tags never outweigh control points. `shift`
// becomes what has to be added to the tags (median). False, and no photo gets a tag, when there are fewer than kLeastTags.
bool UseTagScatter(const std::vector<input::PreparedPhoto>& photos, const geo::EnuFrame& frame, bundle::BundleProblem& bundle,
                   Eigen::Vector3d* shift);
constexpr size_t kLeastTags = 10;

}  // namespace skyquilt::prepare::control
