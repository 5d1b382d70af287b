// Faults of GPS tags that no fit can repair, recognised by their pattern. Those of gimbal angles take gravity to judge: georeference/gimbal_check.h.
#pragma once

#include <optional>
#include <vector>

#include "core/survey/geo_fit.h"
#include "prepare/input/prepared_photo.h"

namespace skyquilt::prepare::georeference {

enum class HeightTags { kTagged, kRelative, kUnknown };

// What the photos' heights are worth. kUnknown: none or all equal. kRelative: the same, but RelativeAltitude is tagged.
HeightTags JudgeHeights(const std::vector<input::PreparedPhoto>& photos);

// Whether heights differ as measured ones do, even of a drone that holds its height; true for a single one, false for none.
bool HeightsVary(const std::vector<double>& heights_m);

// True when latitude and longitude of all tags are those of one place (within a metre), whatever their heights.
bool TagsAboveOneAnother(const std::vector<input::PreparedPhoto>& photos);

// True when all tags are at one place, within a metre in height too where JudgeHeights finds heights.
bool AllTagsEqual(const std::vector<input::PreparedPhoto>& photos);

// A way in which coordinates are often written wrongly, and the tags as they would be otherwise.
struct CoordinateFault {
  survey::Problem problem;
  std::vector<input::PreparedPhoto> repaired;
};
// Latitude and longitude exchanged, or either with the wrong sign. Candidates only: whether one of them fits better must be tried. Those that
// would not be positions on Earth are left out. The words name the file that the positions come from, where most do.
std::vector<CoordinateFault> PossibleCoordinateFaults(const std::vector<input::PreparedPhoto>& photos);

}  // namespace skyquilt::prepare::georeference
