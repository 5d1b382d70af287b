#include "masks/mask_options.h"

#include "core/base/errors.h"

namespace skyquilt::masks {

std::vector<config::Field<MaskOptions>> MaskOptions::Fields() {
  using config::Range;
  using O = MaskOptions;
  return {
      {"segment", &O::segment, Range(),
       "ONNX file of a network that finds what moves (people, cars) in each photo; what it finds is ignored, as by masks that are given; empty: "
       "none"},
      {"segment_config", &O::segment_config, Range(),
       "TOML or JSON file that says what the network takes and gives, and which classes are ignored; needed with segment"},
      {"ignore_ground", &O::ignore_ground, Range(),
       "GeoJSON or GeoPackage file with polygons around ground to ignore, such as a lake or a motorway; empty: none"},
  };
}

void MaskOptions::Check() const {
  if (segment.empty() == segment_config.empty()) return;
  throw base::UsageError(segment.empty() ? "masks.segment_config is given without a network: give its ONNX file as masks.segment (--segment)"
                                         : "masks.segment is given without its configuration: give the file that says what the network takes and "
                                           "gives as masks.segment_config (--segment-config)");
}

}  // namespace skyquilt::masks
