#include "core/survey/tagged_heights.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace skyquilt::survey {

TaggedHeights TaggedHeightsOf(const PhotoTags& tags) {
  if (!tags.gps || !std::isfinite(tags.gps->height_m)) return TaggedHeights::kUnknown;
  if (tags.rtk) return TaggedHeights::kEllipsoid;
  // Positions from a file leave the XMP height as it was.
  return tags.absolute_altitude_m && *tags.absolute_altitude_m == tags.gps->height_m ? TaggedHeights::kEgm96 : TaggedHeights::kUnknown;
}

TaggedHeights JudgeTaggedHeights(const std::vector<PhotoTags>& photos) {
  std::array<size_t, 3> votes{};
  size_t n = 0;
  for (const PhotoTags& tags : photos) {
    if (!tags.gps || !std::isfinite(tags.gps->height_m)) continue;
    ++votes[static_cast<size_t>(TaggedHeightsOf(tags))];
    ++n;
  }
  for (const TaggedHeights heights : {TaggedHeights::kEllipsoid, TaggedHeights::kEgm96}) {
    if (2 * votes[static_cast<size_t>(heights)] > n) return heights;
  }
  return TaggedHeights::kUnknown;
}

const char* NameOf(TaggedHeights heights) {
  switch (heights) {
    case TaggedHeights::kEllipsoid:
      return "ellipsoid";
    case TaggedHeights::kEgm96:
      return "egm96";
    case TaggedHeights::kUnknown:
      break;
  }
  return "unknown";
}

geo::HeightReference HeightReferenceOf(const Survey& survey, const std::vector<PhotoTags>& tags) {
  if (!survey.georeferenced) return geo::HeightReference::kUnknown;
  if (survey.control.placed || survey.truth) return geo::HeightReference::kEllipsoid;
  // A fit that knows its horizontal accuracy but not its vertical one had no usable heights.
  const geo::PlaceAccuracy& accuracy = survey.fit.accuracy;
  if (std::isfinite(accuracy.horizontal_m) && !std::isfinite(accuracy.vertical_m)) return geo::HeightReference::kUnknown;
  switch (JudgeTaggedHeights(tags)) {
    case TaggedHeights::kEllipsoid:
      return geo::HeightReference::kEllipsoid;
    case TaggedHeights::kEgm96:
      return geo::HeightReference::kEgm96;
    case TaggedHeights::kUnknown:
      break;
  }
  return geo::HeightReference::kUnknown;
}

}  // namespace skyquilt::survey
