#include "core/base/errors.h"
#include "core/gis/boundary.h"
#include "masks/make_masks.h"

namespace skyquilt::masks {

void CheckFiles(const MaskOptions& options) {
  if (!options.segment.empty()) Segmenter(options.segment, options.segment_config);
  // Where they are is found with the survey.
  if (!options.ignore_ground.empty()) gis::Boundary::Read(options.ignore_ground, false, {});
}

}  // namespace skyquilt::masks
