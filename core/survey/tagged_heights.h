// What heights are measured from. This is the one place that decides it. Of the heights in photos' tags:
//   ellipsoid  RTK fixed (PhotoTags::rtk): DJI's manuals promise ellipsoidal heights then
//   EGM96      XMP AbsoluteAltitude without RTK: a barometer that starts at a GPS height above EGM96, so metres off, but nearer to it than to the
//              ellipsoid
//   unknown    EXIF alone (its GPSAltitudeRef says "sea level" whatever was written), or a table of positions: taken as given
#pragma once

#include <vector>

#include "core/geo/height_reference.h"
#include "core/survey/exif.h"
#include "core/survey/survey.h"

namespace skyquilt::survey {

enum class TaggedHeights { kEllipsoid, kEgm96, kUnknown };

// Of one photo; unknown without a height.
TaggedHeights TaggedHeightsOf(const PhotoTags& tags);
// Of a survey: what more than half of the photos with a height have, otherwise unknown.
TaggedHeights JudgeTaggedHeights(const std::vector<PhotoTags>& photos);
// "ellipsoid", "egm96", "unknown".
const char* NameOf(TaggedHeights heights);

// What the heights of a survey are measured from:
//   placed by control points       the ellipsoid: the readers of control points convert all heights to it
//   simulated                      the ellipsoid: simulations tag ellipsoidal heights
//   placed by the heights of tags  what the tags' heights are, see above
//   else                           unknown: a local frame, or heights above the take-off point, or relative to the cameras
// `survey` needs its place: georeferenced, fit, control and truth. tags: of its photos, as they were used; empty when the place does not come from
// tags.
geo::HeightReference HeightReferenceOf(const Survey& survey, const std::vector<PhotoTags>& tags);

}  // namespace skyquilt::survey
