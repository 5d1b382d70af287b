#include "evaluate/evaluate_options.h"

#include <filesystem>

#include "core/base/errors.h"

namespace skyquilt::evaluate {

std::vector<config::Field<EvaluateOptions>> EvaluateOptions::Fields() {
  using config::Range;
  using O = EvaluateOptions;
  return {
      {"image_width", &O::image_width, Range{16, 65536}.Or(0), "width in pixels at which held-out photos are scored; 0: the training width"},
      {"lpips_network", &O::lpips_network, Range(), "ONNX file of an LPIPS network; empty: LPIPS is not measured"},
      {"max_photos", &O::max_photos, Range::AtLeast(0), "score at most so many held-out photos, evenly spread; 0: all"},
      {"exif_gain", &O::exif_gain, Range(), "render each held-out photo at the exposure its EXIF states"},
      {"predicted_gain", &O::predicted_gain, Range(),
       "render each held-out photo also with the residual gain of the photos taken before and after it, where gains were learned"},
      {"normal_photos", &O::normal_photos, Range(),
       "folder of the same photos, normally exposed: what is shown at normal brightness is scored against them too; empty: none"},
      {"normal_stops", &O::normal_stops, Range{-10, 10}, "stops by which normal brightness is raised before that comparison"},
      {"report_photos", &O::report_photos, Range::AtLeast(0), "held-out photos with pictures in the report, evenly spread; all are in its tables"},
      {"report_image_width", &O::report_image_width, Range{16, 65536}, "largest width in pixels of the report's pictures"},
  };
}

void EvaluateOptions::RequireFiles() const {
  if (!lpips_network.empty() && !std::filesystem::is_regular_file(lpips_network)) {
    throw base::InputError(lpips_network, "no such file", "Give an ONNX file as evaluate.lpips_network, or leave it empty: LPIPS is not measured then");
  }
  if (!normal_photos.empty() && !std::filesystem::is_directory(normal_photos)) {
    throw base::InputError(normal_photos, "no such folder", "Give the folder of the normally exposed photos as evaluate.normal_photos, or leave it empty");
  }
}

void EvaluateOptions::Check() const {
  config::CheckRanges("evaluate", *this);
}

}  // namespace skyquilt::evaluate
