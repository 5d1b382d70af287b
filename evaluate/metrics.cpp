#include "evaluate/metrics.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/order_statistics.h"

namespace skyquilt::evaluate {

namespace {

using Json = nlohmann::ordered_json;

Json NumberOrNull(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json BytesOrNull(int64_t bytes) {
  return bytes > 0 ? Json(bytes) : Json(nullptr);
}

Json PhotoJson(const PhotoScore& score, bool has_truth) {
  Json json;
  json["name"] = score.name;
  json["width"] = score.width;
  json["height"] = score.height;
  json["psnr"] = NumberOrNull(score.psnr_db);
  json["ssim"] = NumberOrNull(score.ssim);
  json["coverage"] = NumberOrNull(score.Coverage());
  json["psnr_full_frame"] = NumberOrNull(score.psnr_full_db);
  json["ssim_full_frame"] = NumberOrNull(score.ssim_full);
  json["lpips"] = NumberOrNull(score.lpips);
  json["exposure_gain"] = NumberOrNull(score.exposure_gain);
  json["predicted_stops"] = score.predicted_stops;
  json["psnr_exif_gain"] = NumberOrNull(score.psnr_exif_gain_db);
  json["psnr_right_half"] = NumberOrNull(score.right_half_db);
  json["psnr_right_half_fitted"] = NumberOrNull(score.right_half_fitted_db);
  json["fitted_stops"] = score.fitted_stops;
  json["render_seconds"] = NumberOrNull(score.render_seconds);
  if (has_truth) {
    json["depth_rmse_m"] = NumberOrNull(score.depth_rmse_m);
    json["depth_median_abs_m"] = NumberOrNull(score.depth_median_abs_m);
  }
  return json;
}

Json GeoFitJson(const Metrics& metrics) {
  Json json;
  json["georeferenced"] = metrics.georeferenced;
  json["photos_with_gps"] = metrics.geo_fit.n_matches;
  json["inliers"] = metrics.geo_fit.n_inliers;
  const bool fitted = metrics.georeferenced && metrics.geo_fit.n_inliers > 0;
  json["rmse_m"] = NumberOrNull(fitted ? metrics.geo_fit.rmse_m : kNotMeasured);
  json["rmse_horizontal_m"] = NumberOrNull(fitted ? metrics.geo_fit.rmse_horizontal_m : kNotMeasured);
  json["rmse_vertical_m"] = NumberOrNull(fitted ? metrics.geo_fit.rmse_vertical_m : kNotMeasured);
  json["scale_m_per_model_unit"] = NumberOrNull(fitted ? metrics.geo_fit.scale : kNotMeasured);
  json["flight_vertical_offset_m"] = Json::array();
  for (const double offset_m : metrics.geo_fit.flight_vertical_offset_m) json["flight_vertical_offset_m"].push_back(NumberOrNull(offset_m));
  return json;
}

}  // namespace

const char* const kCoverageDefinition =
    "A pixel's surface point is where its rendered ray becomes half opaque, moved along the ray into the height range of the scene's blocks "
    "(so that neither floaters nor holes change what counts). The pixel is covered when that point lies inside the area of the scene's blocks "
    "and inside the unmasked frame of at least two training photos; occlusion between photos is not tested. "
    "coverage = covered pixels / pixels that the photo's mask does not exclude.";
const char* const kPsnrDefinition =
    "psnr, ssim: computed per held-out photo over its covered pixels in sRGB display values, then averaged over photos. "
    "*_full_frame: the same over every pixel that is not masked. psnr_per_block: from the squared errors of all covered pixels of all held-out "
    "photos whose surface point lies in the block's core box, seen from above.";
const char* const kSeamDefinition =
    "seam_psnr_gap_db = PSNR of covered pixels whose surface point lies deeper than the margin inside a block, minus PSNR of those where the "
    "grown boxes of two or more blocks overlap. Textures differ from place to place, so the interior's squared errors are taken by class of the "
    "photo's gradient (eight classes, each twice the one before) and weighted to the seams' share of each class. Pixels near the survey's outer rim "
    "belong to neither. Null with a single block.";
const char* const kRightHalfDefinition =
    "psnr_right_half: mean over photos of the PSNR over the covered pixels of the right half, rendered as psnr is. psnr_right_half_fitted: the same "
    "pixels after three gains in linear light, one per colour, were fitted to the left half of the photo; the difference is what tags and training "
    "do not know of the photo's brightness.";

double PhotoScore::Coverage() const {
  return used_pixels > 0 ? static_cast<double>(covered_pixels) / static_cast<double>(used_pixels) : kNotMeasured;
}

const BlockScore* Metrics::FindBlock(const std::string& name) const {
  const auto match = std::find_if(blocks.begin(), blocks.end(), [&](const BlockScore& block) { return block.name == name; });
  return match == blocks.end() ? nullptr : &*match;
}

double MeanOfMeasured(const std::vector<double>& values) {
  double sum = 0.0;
  int n = 0;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    sum += value;
    ++n;
  }
  return n > 0 ? sum / n : kNotMeasured;
}

double MedianOfMeasured(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  return values.empty() ? kNotMeasured : base::Median(std::move(values));
}

std::string MetricsJson(const Metrics& metrics) {
  Json json;
  json["psnr"] = NumberOrNull(metrics.psnr);
  json["ssim"] = NumberOrNull(metrics.ssim);
  json["coverage"] = NumberOrNull(metrics.coverage);
  json["psnr_full_frame"] = NumberOrNull(metrics.psnr_full_frame);
  json["ssim_full_frame"] = NumberOrNull(metrics.ssim_full_frame);
  json["psnr_exif_gain"] = NumberOrNull(metrics.psnr_exif_gain);
  json["footprint_step"] = NumberOrNull(metrics.footprint_step);
  json["footprint_step_control"] = NumberOrNull(metrics.footprint_step_control);
  json["psnr_normal"] = NumberOrNull(metrics.psnr_normal);
  json["ssim_normal"] = NumberOrNull(metrics.ssim_normal);
  json["psnr_right_half"] = NumberOrNull(metrics.psnr_right_half);
  json["psnr_right_half_fitted"] = NumberOrNull(metrics.psnr_right_half_fitted);
  json["lpips"] = NumberOrNull(metrics.lpips);
  json["lpips_note"] = metrics.lpips_note;
  json["psnr_per_image"] = Json::object();
  for (const PhotoScore& photo : metrics.photos) json["psnr_per_image"][photo.name] = NumberOrNull(photo.psnr_db);
  json["psnr_per_block"] = Json::object();
  for (const BlockScore& block : metrics.blocks) json["psnr_per_block"][block.name] = NumberOrNull(block.psnr_db);
  json["seam_psnr_gap_db"] = NumberOrNull(metrics.seam_psnr_gap_db);
  json["psnr_block_interior"] = NumberOrNull(metrics.psnr_interior_db);
  json["psnr_block_interior_matched"] = NumberOrNull(metrics.psnr_matched_interior_db);
  json["psnr_seam"] = NumberOrNull(metrics.psnr_seam_db);
  if (metrics.has_truth) {
    json["depth_rmse_m"] = NumberOrNull(metrics.depth_rmse_m);
    json["depth_median_abs_m"] = NumberOrNull(metrics.depth_median_abs_m);
    json["air_opacity"] = NumberOrNull(metrics.air_opacity);
    json["air_profile"] = Json::array();
    for (const auto& [clearance_m, opacity] : metrics.air_profile) {
      json["air_profile"].push_back({{"clearance_m", clearance_m}, {"opacity", NumberOrNull(opacity)}});
    }
  }
  json["train_seconds"] = NumberOrNull(metrics.train_seconds);
  json["samples_per_second"] = NumberOrNull(metrics.samples_per_second);
  json["peak_rss_bytes"] = BytesOrNull(metrics.peak_rss_bytes);
  json["parameters"] = metrics.parameters;
  json["ranks"] = metrics.ranks;
  json["threads"] = metrics.threads;
  json["evaluate_seconds"] = NumberOrNull(metrics.evaluate_seconds);
  json["evaluate_peak_rss_bytes"] = BytesOrNull(metrics.evaluate_peak_rss_bytes);
  const scene::RenderStatistics& rendering = metrics.rendering;
  json["rendering"] = {{"ranks", rendering.ranks},
                       {"groups", rendering.groups},
                       {"rays", rendering.rays},
                       {"samples", rendering.samples},
                       {"field_loads", rendering.field_loads},
                       {"handovers", rendering.handovers},
                       {"bytes_sent", rendering.bytes_sent},
                       {"bytes_received", rendering.bytes_received}};
  json["image_width"] = metrics.image_width;
  json["photos_registered"] = metrics.n_photos;
  json["photos_unregistered"] = metrics.n_unregistered;
  json["photos_held_out"] = metrics.n_test;
  json["photos_scored"] = metrics.photos.size();
  json["geo"] = GeoFitJson(metrics);
  json["median_agl_m"] = NumberOrNull(metrics.median_agl_m);
  json["median_relative_altitude_m"] = NumberOrNull(metrics.median_relative_altitude_m);
  json["gsd_m"] = NumberOrNull(metrics.gsd_m);
  json["images"] = Json::array();
  for (const PhotoScore& photo : metrics.photos) json["images"].push_back(PhotoJson(photo, metrics.has_truth));
  json["pixels_per_block"] = Json::object();
  for (const BlockScore& block : metrics.blocks) json["pixels_per_block"][block.name] = block.pixels;
  json["definitions"] = {
      {"coverage", kCoverageDefinition}, {"psnr", kPsnrDefinition}, {"seam", kSeamDefinition}, {"right_half", kRightHalfDefinition}};
  json["warnings"] = metrics.warnings;
  json["machine"] = metrics.machine;
  json["date"] = metrics.date;
  json["config"] = metrics.config;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace skyquilt::evaluate
