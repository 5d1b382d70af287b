#include "prepare/prepare_options.h"

#include "core/base/errors.h"
#include "core/camera/camera.h"
#include "prepare/holdout.h"

namespace skyquilt::prepare {

void PrepareOptions::Visit(config::OptionVisitor& v) {
  v.Field("holdout", holdout, "photos kept for testing, in name order: every:N, every:N:offset, list:FILE (one name per line) or none");
  v.Field("ransac_threshold_m", ransac_threshold_m, "distance between fitted and tagged camera position up to which a tag counts, metres, > 0");
  v.Field("camera_model", camera_model, "COLMAP camera model for photos without a model: SIMPLE_PINHOLE .. FULL_OPENCV, OPENCV_FISHEYE");
  v.Field("colmap", colmap, "the COLMAP program, found on the PATH or given as a path");
  v.Field("max_image_size", max_image_size, "longer side at which COLMAP looks for features, pixels, >= 100");
  v.Field("max_features", max_features, "features per photo, >= 100");
  v.Field("use_gpu", use_gpu, "let COLMAP use a GPU for features and matching (needs a COLMAP built for it)");
  v.Field("masks", masks, "folder of masks named PHOTO.jpg.png, 0 = ignore; empty: masks/ inside the photo folder if there is one");
  v.Field("flight_gap_s", flight_gap_s, "a longer pause between photos starts another flight, seconds, > 0");
  v.Field("flight_offsets", flight_offsets, "auto: flights whose tagged heights disagree get one vertical offset each; off: never");
  v.Field("seed", seed, "of the robust fit and of COLMAP, >= 0");
}

void PrepareOptions::Validate() const {
  const auto require = [](bool condition, const std::string& message) {
    if (!condition) throw base::UsageError(message);
  };
  ParseHoldout(holdout);
  require(ransac_threshold_m > 0.0 && ransac_threshold_m < 1e6,
          "prepare.ransac_threshold_m must be above 0, not " + std::to_string(ransac_threshold_m));
  require(camera::ModelFromName(camera_model).has_value(),
          "prepare.camera_model '" + camera_model +
              "' is not known: use SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV or OPENCV_FISHEYE");
  require(!colmap.empty(), "prepare.colmap must name a program");
  require(max_image_size >= 100, "prepare.max_image_size must be at least 100, not " + std::to_string(max_image_size));
  require(max_features >= 100, "prepare.max_features must be at least 100, not " + std::to_string(max_features));
  require(flight_gap_s > 0.0, "prepare.flight_gap_s must be above 0, not " + std::to_string(flight_gap_s));
  require(flight_offsets == "auto" || flight_offsets == "off", "prepare.flight_offsets must be 'auto' or 'off', not '" + flight_offsets + "'");
  require(seed >= 0, "prepare.seed must not be negative");
}

}  // namespace skyquilt::prepare
