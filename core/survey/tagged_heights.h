// What the heights in photos' tags are measured from. This is the one place that decides it:
//   ellipsoid  RTK fixed (PhotoTags::rtk): DJI's manuals promise ellipsoidal heights then
//   EGM96      XMP AbsoluteAltitude without RTK: a barometer that starts at a GPS height above EGM96, so metres off, but nearer to it than to the
//              ellipsoid
//   unknown    EXIF alone (its GPSAltitudeRef says "sea level" whatever was written), or a table of positions: taken as given
#pragma once

#include <vector>

#include "core/survey/exif.h"

namespace skyquilt::survey {

enum class TaggedHeights { kEllipsoid, kEgm96, kUnknown };

// Of one photo; unknown without a height.
TaggedHeights TaggedHeightsOf(const PhotoTags& tags);
// Of a survey: what more than half of the photos with a height have, otherwise unknown.
TaggedHeights JudgeTaggedHeights(const std::vector<PhotoTags>& photos);
// "ellipsoid", "egm96", "unknown".
const char* NameOf(TaggedHeights heights);

}  // namespace skyquilt::survey
