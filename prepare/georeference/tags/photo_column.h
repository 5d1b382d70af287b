// Photos above one another, as along one column of a facade. Their positions tell the scale and what is up, but leave the direction of north open,
// however good the tags are.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "prepare/input/prepared_photo.h"

namespace skyquilt::prepare::georeference {

// Whether the tagged photos are above one another by their poses: along a line whose length is at least four times its width, and that goes up by
// gravity (`up`, a unit vector in the model's frame) or by the tagged heights. Either may be missing or wrong: a wall that is taken for the ground
// turns gravity. At least one tag.
bool CamerasAboveOneAnother(const std::vector<input::PreparedPhoto>& photos, const Eigen::Vector3d& up);
// The same of the tags: those with a height that says something differ four times as much in it as horizontally, or more. False for none.
bool TagsFormColumn(const std::vector<input::PreparedPhoto>& photos);

}  // namespace skyquilt::prepare::georeference
