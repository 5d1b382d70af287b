#include "evaluate/evaluate_options.h"

#include "core/base/errors.h"

namespace skyquilt::evaluate {

std::vector<config::Field<EvaluateOptions>> EvaluateOptions::Fields() {
  using config::Range;
  using O = EvaluateOptions;
  return {
      {"image_width", &O::image_width, Range{16, 65536}.Or(0), "width in pixels at which held-out photos are scored; 0: the training width"},
      {"lpips_network", &O::lpips_network, Range(), "ONNX file of an LPIPS network; empty: LPIPS is not measured"},
      {"max_photos", &O::max_photos, Range::AtLeast(0), "most held-out photos to score, evenly spread; 0: all"},
      {"exif_gain", &O::exif_gain, Range(), "render each held-out photo at the exposure of its EXIF tags"},
      {"predicted_gain", &O::predicted_gain, Range(),
       "also apply the residual gain predicted from the photos taken before and after, if training learned gains"},
      {"normal_photos", &O::normal_photos, Range(),
       "folder of the same photos at normal exposure, to score renderings at normal brightness too; empty: none"},
      {"normal_stops", &O::normal_stops, Range{-10, 10}, "stops to brighten the renderings by for normal_photos"},
      {"resect", &O::resect, Range(),
       "also fit the pose of every held-out photo to the scene on half of its tiles, and score it on the other half with the pose as given and as "
       "fitted; takes several times as long"},
      {"field_normals", &O::field_normals, Range(),
       "simulated surveys: also score the normals of the density and of the normal head by class; takes longer"},
      {"report_photos", &O::report_photos, Range::AtLeast(0), "held-out photos shown as images in the report, evenly spread; its tables have all"},
      {"report_image_width", &O::report_image_width, Range{16, 65536}, "largest width of the report's images in pixels"},
      {"save_every_s", &O::save_every_s, Range{1e-3, 1e8},
       "seconds between savings of the scores so far, after which an interrupted evaluation continues"},
  };
}

void EvaluateOptions::RequireFiles() const {
  if (!lpips_network.empty() && !std::filesystem::is_regular_file(lpips_network)) {
    throw base::InputError(lpips_network, "no such file",
                           "Give an ONNX file as evaluate.lpips_network, or leave it empty: LPIPS is not measured then");
  }
  if (!normal_photos.empty() && !std::filesystem::is_directory(normal_photos)) {
    throw base::InputError(normal_photos, "no such folder",
                           "Give the folder of the normally exposed photos as evaluate.normal_photos, or leave it empty");
  }
}

void EvaluateOptions::Check() const {
  config::CheckRanges("evaluate", *this);
}

}  // namespace skyquilt::evaluate
