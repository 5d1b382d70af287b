#include "products/product_options.h"

#include <cmath>

#include "core/base/errors.h"

namespace skyquilt::products {
namespace {

void RequireRange(const std::string& key, double value, double low, double high) {
  if (std::isfinite(value) && value >= low && value <= high) return;
  throw base::UsageError("products." + key + " = " + std::to_string(value) + ": must lie in [" + std::to_string(low) + ", " + std::to_string(high) +
                         "]");
}

void RequireEven(const std::string& key, int value) {
  RequireRange(key, value, 16, 16384);
  if (value % 2 != 0) throw base::UsageError("products." + key + " = " + std::to_string(value) + ": must be even");
}

}  // namespace

void ProductOptions::Visit(config::OptionVisitor& v) {
  v.Field("ortho", ortho, "make the orthophoto");
  v.Field("dsm", dsm, "make the digital surface model");
  v.Field("resolution_m", resolution_m, "metres per cell of both; 0: the ground sampling distance, rounded");
  v.Field("max_pixels", max_pixels, "largest map in cells; maps of automatic resolution are coarsened to fit");
  v.Field("min_opacity", min_opacity, "cells whose ray stays more transparent than this have no data, 0.01..0.99");
  v.Field("preview_width", preview_width, "pixels of the PNG previews, 16..16384");
  v.Field("exposure", exposure, "normal (one brightness everywhere), stops above it, -10..10, or the name of a photo to look like");
  v.Field("video_path", video_path, "orbit or flyover");
  v.Field("video_seconds", video_seconds, "length of the video; 0: none");
  v.Field("video_fps", video_fps, "frames per second, 1..120");
  v.Field("video_width", video_width, "pixels, even");
  v.Field("video_height", video_height, "pixels, even");
}

void ProductOptions::Check() const {
  RequireRange("resolution_m", resolution_m, 0.0, 1e5);
  RequireRange("max_pixels", max_pixels, 1.0, 1e11);
  RequireRange("min_opacity", min_opacity, 0.01, 0.99);
  RequireRange("preview_width", preview_width, 16, 16384);
  RequireRange("video_seconds", video_seconds, 0.0, 3600.0);
  RequireRange("video_fps", video_fps, 1, 120);
  RequireEven("video_width", video_width);
  RequireEven("video_height", video_height);
  if (video_path != "orbit" && video_path != "flyover") {
    throw base::UsageError("products.video_path = " + video_path + ": must be orbit or flyover");
  }
}

}  // namespace skyquilt::products
