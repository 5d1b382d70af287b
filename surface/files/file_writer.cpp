#include "surface/files/file_writer.h"

namespace skyquilt::surface {

std::string CountText(int64_t count, const std::string& unit) {
  std::string digits = std::to_string(count);
  for (size_t at = digits.size(); at > 3;) digits.insert(at -= 3, ",");
  return digits + " " + unit + (count == 1 ? "" : "s");
}

std::string OffsetCrsName(const MapFrame& frame) {
  return frame.georeferenced() ? frame.CrsName() + " minus offset" : frame.CrsName();
}

}  // namespace skyquilt::surface
