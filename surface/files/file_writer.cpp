#include "surface/files/file_writer.h"

namespace skyquilt::surface {

std::string OffsetCrsName(const MapFrame& frame) {
  return frame.georeferenced() ? frame.CrsName() + " minus offset" : frame.CrsName();
}

}  // namespace skyquilt::surface
