// Brings a whole model to where a part of it has been adjusted to.
#pragma once

#include <vector>

#include "core/geo/transform.h"
#include "core/survey/colmap_model.h"
#include "prepare/control/fit/control_bundle.h"

namespace skyquilt::prepare::control {

// `marked` was made from the model, moved by `enu_from_model` and then, with `photos_before` its photos at that moment, perhaps adjusted. Poses,
// lenses and the points that the bundle has a place for are taken from it, and their reprojection errors computed anew; the other points move like
// the photos that see them.
void UpdateModel(const ControlBundle& marked, const geo::Similarity3d& enu_from_model, const std::vector<bundle::BundlePhoto>& photos_before,
                 bool adjusted, survey::ColmapModel& model);

}  // namespace skyquilt::prepare::control
