// Decides what the heights of a survey are measured from. Nothing else does.
//   placed by control points       the ellipsoid: the readers of control points convert all heights to it
//   simulated                      the ellipsoid: simulations tag ellipsoidal heights
//   placed by the heights of tags  what the tags' heights are, see core/survey/tagged_heights.h
//   else                           unknown: a local frame, or heights above the take-off point, or relative to the cameras
#pragma once

#include <vector>

#include "core/geo/height_reference.h"
#include "core/survey/exif.h"
#include "core/survey/survey.h"

namespace skyquilt::survey {

// `survey` needs its place: georeferenced, fit, control and truth. tags: of its photos, as they were used; empty when the place does not come from
// tags.
geo::HeightReference HeightReferenceOf(const Survey& survey, const std::vector<PhotoTags>& tags);

}  // namespace skyquilt::survey
