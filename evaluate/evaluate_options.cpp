#include "evaluate/evaluate_options.h"

#include <cmath>

#include "core/base/errors.h"

namespace skyquilt::evaluate {

void EvaluateOptions::Visit(config::OptionVisitor& v) {
  v.Field("image_width", image_width, "width in pixels at which held-out photos are scored; 0: the training width");
  v.Field("lpips_network", lpips_network, "ONNX file of an LPIPS network; empty: LPIPS is not measured");
  v.Field("max_photos", max_photos, "score at most so many held-out photos, evenly spread; 0: all");
  v.Field("exif_gain", exif_gain, "render each held-out photo at the exposure its EXIF states");
  v.Field("predicted_gain", predicted_gain, "and with what the photos taken before and after it needed beside theirs, where gains were learned");
  v.Field("normal_photos", normal_photos,
          "folder of the same photos, normally exposed: what is shown at normal brightness is scored against them too; empty: none");
  v.Field("normal_stops", normal_stops, "stops by which normal brightness is raised for that, -10..10");
  v.Field("report_photos", report_photos, "held-out photos with pictures in the report, evenly spread; all are in its tables");
  v.Field("report_image_width", report_image_width, "largest width in pixels of the report's pictures");
}

void EvaluateOptions::Check() const {
  if (image_width < 0 || max_photos < 0 || report_photos < 0 || report_image_width < 16 || !(std::abs(normal_stops) <= 10.0)) {
    throw base::UsageError(
        "evaluate: image_width, max_photos and report_photos must not be negative, report_image_width at least 16, normal_stops from -10 to 10");
  }
}

}  // namespace skyquilt::evaluate
