#include "prepare/prepare_options.h"

#include "core/base/errors.h"
#include "prepare/holdout.h"

namespace skyquilt::prepare {

std::vector<config::Field<PrepareOptions>> PrepareOptions::Fields() {
  using config::Range;
  using O = PrepareOptions;
  return {
      {"holdout", &O::holdout, Range(), "photos kept for testing, in name order: every:N, every:N:offset, list:FILE (one name per line) or none"},
      {"ransac_threshold_m", &O::ransac_threshold_m, Range{1e-3, 1e6},
       "distance between fitted and tagged camera position up to which a tag counts, metres"},
      {"camera_model", &O::camera_model,
       Range::OneOf({"SIMPLE_PINHOLE", "PINHOLE", "SIMPLE_RADIAL", "RADIAL", "OPENCV", "FULL_OPENCV", "OPENCV_FISHEYE"}),
       "COLMAP camera model for photos without a model"},
      {"colmap", &O::colmap, Range(), "the COLMAP program, found on the PATH or given as a path"},
      {"max_image_size", &O::max_image_size, Range::AtLeast(100), "longer side at which COLMAP looks for features, pixels"},
      {"max_features", &O::max_features, Range::AtLeast(100), "features per photo"},
      {"use_gpu", &O::use_gpu, Range(), "let COLMAP use a GPU for features and matching (needs a COLMAP built for it)"},
      {"masks", &O::masks, Range(), "folder of masks named PHOTO.jpg.png, 0 = ignore; empty: masks/ inside the photo folder if there is one"},
      {"flight_gap_s", &O::flight_gap_s, Range{1e-3, 1e9}, "a longer pause between photos starts another flight, seconds"},
      {"flight_offsets", &O::flight_offsets, Range::OneOf({"auto", "off"}),
       "auto: flights whose tagged heights disagree get one vertical offset each; off: never"},
      {"seed", &O::seed, Range::AtLeast(0), "of the robust fit and of COLMAP"},
  };
}

void PrepareOptions::Check() const {
  config::CheckRanges("prepare", *this);
  ParseHoldout(holdout);
  if (colmap.empty()) throw base::UsageError("prepare.colmap is empty: it must name a program, for instance colmap");
}

}  // namespace skyquilt::prepare
