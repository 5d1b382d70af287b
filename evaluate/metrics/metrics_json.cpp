#include <nlohmann/json.hpp>
#include <span>

#include "core/base/json_text.h"
#include "core/survey/geo_fit.h"
#include "evaluate/buildings/buildings_json.h"
#include "evaluate/control/control_json.h"
#include "evaluate/metrics/class_json.h"
#include "evaluate/metrics/metrics_keys.h"
#include "evaluate/ortho/ortho_json.h"
#include "evaluate/surface/surface_json.h"

namespace skyquilt::evaluate::metrics {

namespace {

using Json = nlohmann::ordered_json;
using base::NumberOrNull;

Json BytesOrNull(int64_t bytes) {
  return bytes > 0 ? Json(bytes) : Json(nullptr);
}

Json PhotoJson(const photos::PhotoScore& score, bool has_truth) {
  Json json;
  json["name"] = score.name;
  json["width"] = score.width;
  json["height"] = score.height;
  json["psnr"] = NumberOrNull(score.psnr_db);
  json["psnr_1000"] = NumberOrNull(score.psnr_1000_db);
  json["psnr_posed"] = NumberOrNull(score.psnr_posed_db);
  json["psnr_resected"] = NumberOrNull(score.psnr_resected_db);
  json["resected_px"] = NumberOrNull(score.resected_px);
  json["ssim"] = NumberOrNull(score.ssim);
  json["flip"] = NumberOrNull(score.flip);
  json["coverage"] = NumberOrNull(score.Coverage());
  json["psnr_full_frame"] = NumberOrNull(score.psnr_full_db);
  json["ssim_full_frame"] = NumberOrNull(score.ssim_full);
  json["flip_full_frame"] = NumberOrNull(score.flip_full);
  json["lpips"] = NumberOrNull(score.lpips);
  json["exposure_gain"] = NumberOrNull(score.exposure_gain);
  json["predicted_stops"] = score.predicted_stops;
  json["psnr_expected"] = NumberOrNull(score.expected_psnr_db);
  json["psnr_exif_gain"] = NumberOrNull(score.psnr_exif_gain_db);
  json["psnr_right_half"] = NumberOrNull(score.right_half_db);
  json["psnr_right_half_fitted"] = NumberOrNull(score.right_half_fitted_db);
  json["fitted_stops"] = score.fitted_stops;
  json["psnr_tiles"] = NumberOrNull(score.tiles_db);
  json["psnr_tiles_gains"] = NumberOrNull(score.tiles_gains_db);
  json["psnr_tiles_shading"] = NumberOrNull(score.tiles_shading_db);
  json["render_seconds"] = NumberOrNull(score.render_seconds);
  if (has_truth) {
    json["depth_rmse_m"] = NumberOrNull(score.depth_rmse_m);
    json["depth_median_abs_m"] = NumberOrNull(score.depth_median_abs_m);
  }
  return json;
}

Json GeoFitJson(const Metrics& metrics) {
  const Json fit = survey::ToJson(metrics.geo_fit);
  Json json;
  json["georeferenced"] = metrics.georeferenced;
  for (const auto& [key, fit_key] : kFitKeys) json[key] = fit.at(fit_key);
  if (!metrics.georeferenced || metrics.geo_fit.n_inliers == 0) {
    for (const char* key : {"rmse_m", "rmse_horizontal_m", "rmse_vertical_m"}) json[key] = nullptr;
  }
  if (!metrics.georeferenced && metrics.geo_fit.scale_bars.empty()) json["scale_m_per_model_unit"] = nullptr;
  json["problems"] = metrics.problem_codes;
  return json;
}

Json KeptPointsJson(const photos::KeptPointErrors& errors) {
  if (errors.rays == 0) return nullptr;
  Json json = {{"points", errors.points}, {"rays", errors.rays}};
  for (const auto& [key, member] : kKeptPoints) json[key] = NumberOrNull(errors.*member);
  return json;
}

Json TrustJson(const trust::TrustScores& trust) {
  if (trust.pixels == 0) return nullptr;
  return {{"pixels", trust.pixels},
          {"ause", NumberOrNull(trust.ause)},
          {"ause_by_photos", NumberOrNull(trust.ause_photos)},
          {"ause_by_gradient", NumberOrNull(trust.ause_gradient)},
          {"ause_by_opacity", NumberOrNull(trust.ause_opacity)},
          {"least_over_most_trusted", NumberOrNull(trust.least_over_most)},
          {"rms_expected", NumberOrNull(trust.expected_rms)},
          {"rms_found", NumberOrNull(trust.found_rms)}};
}

Json TimesJson(const RunTimes& times) {
  Json stages = Json::array();
  for (const StageTimes& stage : times.stages) {
    stages.push_back({{"stage", stage.stage},
                      {"planned_s", NumberOrNull(stage.planned_s)},
                      {"predicted_s", NumberOrNull(stage.predicted_s)},
                      {"took_s", NumberOrNull(stage.took_s)}});
  }
  return {{"within_s", times.within_s}, {"used_s", times.used_s}, {"stages", stages}, {"given_up", times.given_up}};
}

// Which of the ways that are in use a figure was computed by, so that it can be set beside published ones.
constexpr const char* kPsnrVariant =
    "per photo 10 log10(1 / mean squared error) over all its pixels that no mask excludes and all three channels, of stored (sRGB) values divided by "
    "255, renderings clamped to [0, 1] and not rounded; mean over the photos";
constexpr const char* kSsimVariant =
    "Gaussian window 11 x 11, sigma 1.5, K1 = 0.01, K2 = 0.03, data range 1, weighted (population) variances, mean over channels, over the pixels "
    "whose "
    "window lies inside the picture, and over the photos";

// Whole frames alone: coverage is an own idea of this program.
Json AsPublishedJson(const Metrics& metrics) {
  int64_t used = 0, all = 0;
  for (const photos::PhotoScore& photo : metrics.photos) {
    used += photo.used_pixels;
    all += int64_t{photo.width} * photo.height;
  }
  const photos::PhotoScore first = metrics.photos.empty() ? photos::PhotoScore() : metrics.photos.front();
  return {{"psnr", NumberOrNull(metrics.psnr_full_frame)},
          {"psnr_variant", kPsnrVariant},
          {"ssim", NumberOrNull(metrics.ssim_full_frame)},
          {"ssim_variant", kSsimVariant},
          {"lpips", NumberOrNull(metrics.lpips)},
          {"lpips_variant", metrics.lpips_note},
          {"photos", metrics.photos.size()},
          {"width", first.width},
          {"height", first.height},
          {"unmasked_share", NumberOrNull(all > 0 ? static_cast<double>(used) / static_cast<double>(all) : kNotMeasured)}};
}

void PutNumbers(std::span<const KeyedNumber> numbers, const Metrics& metrics, Json* json) {
  for (const auto& [key, member] : numbers) (*json)[key] = NumberOrNull(metrics.*member);
}

// Nothing without true classes.
void PutClasses(const Metrics& metrics, Json* json) {
  if (metrics.classes.empty()) return;
  (*json)["classes"] = ToJson(std::span<const ClassScore>(metrics.classes));
  (*json)["flat_roofs"] = metrics.flat_roofs;
  (*json)["flat_roof_rms_m"] = NumberOrNull(metrics.flat_roof_rms_m);
  (*json)["flat_roof_nmad_m"] = NumberOrNull(metrics.flat_roof_nmad_m);
}

}  // namespace

std::string MetricsJson(const Metrics& metrics) {
  Json json;
  PutNumbers(kScores, metrics, &json);
  json["lpips_note"] = metrics.lpips_note;
  json["as_published"] = AsPublishedJson(metrics);
  json["psnr_per_image"] = Json::object();
  for (const photos::PhotoScore& photo : metrics.photos) json["psnr_per_image"][photo.name] = NumberOrNull(photo.psnr_db);
  json["psnr_per_block"] = Json::object();
  for (const BlockScore& block : metrics.blocks) json["psnr_per_block"][block.name] = NumberOrNull(block.psnr_db);
  PutNumbers(kSeams, metrics, &json);
  if (metrics.has_truth) {
    PutNumbers(kAgainstTruth, metrics, &json);
    json["floater_profile"] = Json::array();
    for (const auto& [clearance_m, opacity] : metrics.floater_profile) {
      json["floater_profile"].push_back({{"clearance_m", clearance_m}, {"opacity", NumberOrNull(opacity)}});
    }
    PutClasses(metrics, &json);
  }
  json["kept_points"] = KeptPointsJson(metrics.kept_points);
  json["trust"] = TrustJson(metrics.trust);
  if (metrics.surface) json["surface"] = ToJson(*metrics.surface);
  if (metrics.buildings) json["buildings"] = ToJson(*metrics.buildings);
  if (metrics.ortho) json["orthophoto"] = ToJson(*metrics.ortho);
  if (metrics.times) json["times"] = TimesJson(*metrics.times);
  PutNumbers(kTraining, metrics, &json);
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
  json["holdout_poses"] = metrics.resected_holdout ? "resected" : "given";
  json["photos_scored"] = metrics.photos.size();
  json["geo"] = GeoFitJson(metrics);
  if (!metrics.control.points.empty()) json["control"] = control::ControlJson(metrics.control);
  PutNumbers(kHeights, metrics, &json);
  json["images"] = Json::array();
  for (const photos::PhotoScore& photo : metrics.photos) json["images"].push_back(PhotoJson(photo, metrics.has_truth));
  json["pixels_per_block"] = Json::object();
  for (const BlockScore& block : metrics.blocks) json["pixels_per_block"][block.name] = block.pixels;
  json["definitions"] = {
      {"coverage", kCoverageDefinition}, {"psnr", kPsnrDefinition}, {"seam", kSeamDefinition}, {"right_half", kRightHalfDefinition}};
  json["warnings"] = Json::array();
  for (const Warning& warning : metrics.warnings) json["warnings"].push_back({{"finding", warning.finding}, {"advice", warning.advice}});
  json["machine"] = metrics.machine;
  json["date"] = metrics.date;
  json["config"] = metrics.config;
  return base::JsonText(json, 2) + "\n";
}

}  // namespace skyquilt::evaluate::metrics
