#include "core/survey/height_reference_of.h"

#include <cmath>

#include "core/survey/tagged_heights.h"

namespace skyquilt::survey {

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
