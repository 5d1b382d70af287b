// What heights are measured from, and what they shall be measured from in products.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace skyquilt::geo {

enum class HeightReference {
  kEllipsoid,  // of WGS84 (EPSG:4979)
  kEgm96,      // the geoid of EGM96 (EPSG:5773), about mean sea level
  kUnknown
};
// "ellipsoid", "egm96", "unknown".
std::string NameOf(HeightReference reference);
std::optional<HeightReference> HeightReferenceNamed(std::string_view name);

enum class Vertical {
  kAsTagged,  // heights stay as they are
  kEllipsoid,
  kEgm96
};
// Metadata item of files with heights: how often the undulation of EGM96 was added to the survey's heights, "-1" or "1"; none where they are as in
// the survey. With it, programs that show maps beside the survey get its heights back.
inline constexpr const char* kUndulationsItem = "EGM96_UNDULATIONS_ADDED";

// Of "as-tagged", "ellipsoid" and "egm96". Throws std::invalid_argument for another name.
Vertical VerticalNamed(std::string_view name);

}  // namespace skyquilt::geo
