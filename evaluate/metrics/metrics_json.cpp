#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/survey/geo_fit_json.h"
#include "evaluate/buildings/buildings_json.h"
#include "evaluate/control/control_json.h"
#include "evaluate/metrics/class_json.h"
#include "evaluate/metrics/metrics.h"
#include "evaluate/surface/surface_json.h"

namespace skyquilt::evaluate::metrics {

namespace {

using KeyedNumber = std::pair<const char*, double Metrics::*>;

// Numbers of the whole evaluation and their keys, for writing and reading.
constexpr std::array<KeyedNumber, 15> kScores = {{{"psnr", &Metrics::psnr},
                                                  {"ssim", &Metrics::ssim},
                                                  {"flip", &Metrics::flip},
                                                  {"coverage", &Metrics::coverage},
                                                  {"psnr_full_frame", &Metrics::psnr_full_frame},
                                                  {"ssim_full_frame", &Metrics::ssim_full_frame},
                                                  {"flip_full_frame", &Metrics::flip_full_frame},
                                                  {"psnr_exif_gain", &Metrics::psnr_exif_gain},
                                                  {"exposure_seam", &Metrics::exposure_seam},
                                                  {"exposure_seam_control", &Metrics::exposure_seam_control},
                                                  {"psnr_normal", &Metrics::psnr_normal},
                                                  {"ssim_normal", &Metrics::ssim_normal},
                                                  {"psnr_right_half", &Metrics::psnr_right_half},
                                                  {"psnr_right_half_fitted", &Metrics::psnr_right_half_fitted},
                                                  {"lpips", &Metrics::lpips}}};
constexpr std::array<KeyedNumber, 4> kSeams = {{{"seam_psnr_gap_db", &Metrics::seam_psnr_gap_db},
                                                {"psnr_block_interior", &Metrics::psnr_interior_db},
                                                {"psnr_block_interior_matched", &Metrics::psnr_matched_interior_db},
                                                {"psnr_seam", &Metrics::psnr_seam_db}}};
constexpr std::array<KeyedNumber, 3> kAgainstTruth = {
    {{"depth_rmse_m", &Metrics::depth_rmse_m}, {"depth_median_abs_m", &Metrics::depth_median_abs_m}, {"floater_opacity", &Metrics::floater_opacity}}};
constexpr std::array<KeyedNumber, 2> kTraining = {{{"train_seconds", &Metrics::train_seconds}, {"samples_per_second", &Metrics::samples_per_second}}};
constexpr std::array<KeyedNumber, 3> kHeights = {
    {{"median_agl_m", &Metrics::median_agl_m}, {"median_relative_altitude_m", &Metrics::median_relative_altitude_m}, {"gsd_m", &Metrics::gsd_m}}};

constexpr std::array<std::pair<const char*, double photos::KeptPointErrors::*>, 7> kKeptPoints = {
    {{"median_m", &photos::KeptPointErrors::median_m},
     {"median_abs_m", &photos::KeptPointErrors::median_abs_m},
     {"nmad_m", &photos::KeptPointErrors::nmad_m},
     {"median_gsd", &photos::KeptPointErrors::median_gsd},
     {"median_abs_gsd", &photos::KeptPointErrors::median_abs_gsd},
     {"nmad_gsd", &photos::KeptPointErrors::nmad_gsd},
     {"share_beyond_10_gsd", &photos::KeptPointErrors::share_beyond_10_gsd}}};

using Json = nlohmann::ordered_json;

using survey::NumberOrNull;

// Keys of the fit to GPS here and in survey.json.
constexpr std::array<std::pair<const char*, const char*>, 13> kFitKeys = {{{"photos_with_gps", "n_matches"},
                                                                           {"inliers", "n_inliers"},
                                                                           {"rmse_m", "rmse_m"},
                                                                           {"rmse_horizontal_m", "rmse_horizontal_m"},
                                                                           {"rmse_vertical_m", "rmse_vertical_m"},
                                                                           {"scale_m_per_model_unit", "scale"},
                                                                           {"tag_lag_s", "tag_lag_s"},
                                                                           {"tag_lag_sigma_s", "tag_lag_sigma_s"},
                                                                           {"flight_vertical_offset_m", "flight_vertical_offset_m"},
                                                                           {"flight_vertical_drift_m", "flight_vertical_drift_m"},
                                                                           {"accuracy", "accuracy"},
                                                                           {"gravity", "gravity"},
                                                                           {"tags_alone_tilt_deg", "tags_alone_tilt_deg"}}};

Json BytesOrNull(int64_t bytes) {
  return bytes > 0 ? Json(bytes) : Json(nullptr);
}

Json PhotoJson(const photos::PhotoScore& score, bool has_truth) {
  Json json;
  json["name"] = score.name;
  json["width"] = score.width;
  json["height"] = score.height;
  json["psnr"] = NumberOrNull(score.psnr_db);
  json["ssim"] = NumberOrNull(score.ssim);
  json["flip"] = NumberOrNull(score.flip);
  json["coverage"] = NumberOrNull(score.Coverage());
  json["psnr_full_frame"] = NumberOrNull(score.psnr_full_db);
  json["ssim_full_frame"] = NumberOrNull(score.ssim_full);
  json["flip_full_frame"] = NumberOrNull(score.flip_full);
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
  const Json fit = survey::ToJson(metrics.geo_fit);
  Json json;
  json["georeferenced"] = metrics.georeferenced;
  for (const auto& [key, fit_key] : kFitKeys) json[key] = fit.at(fit_key);
  if (!metrics.georeferenced || metrics.geo_fit.n_inliers == 0) {
    for (const char* key : {"rmse_m", "rmse_horizontal_m", "rmse_vertical_m"}) json[key] = nullptr;
  }
  if (!metrics.georeferenced) json["scale_m_per_model_unit"] = nullptr;
  json["problems"] = metrics.problem_codes;
  return json;
}

Json KeptPointsJson(const photos::KeptPointErrors& errors) {
  if (errors.rays == 0) return nullptr;
  Json json = {{"points", errors.points}, {"rays", errors.rays}};
  for (const auto& [key, member] : kKeptPoints) json[key] = NumberOrNull(errors.*member);
  return json;
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

double NumberAt(const Json& json, const std::string& key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number() ? found->get<double>() : kNotMeasured;
}

void TakeNumbers(std::span<const KeyedNumber> numbers, const Json& json, Metrics* metrics) {
  for (const auto& [key, member] : numbers) metrics->*member = NumberAt(json, key);
}

template <typename T>
T ValueAt(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found == json.end() || found->is_null() ? T() : found->get<T>();
}

void TakeBlocks(const Json& json, Metrics* metrics) {
  const Json pixels = ValueAt<Json>(json, "pixels_per_block"), scores = ValueAt<Json>(json, "psnr_per_block");
  for (const auto& [name, psnr] : scores.items()) {
    metrics->blocks.push_back({name, psnr.is_number() ? psnr.get<double>() : kNotMeasured, pixels.value(name, int64_t{0})});
  }
}

// Absent in files of earlier versions.
void TakeKeptPoints(const Json& json, photos::KeptPointErrors* errors) {
  const Json kept = ValueAt<Json>(json, "kept_points");
  if (!kept.is_object()) return;
  errors->points = ValueAt<int64_t>(kept, "points");
  errors->rays = ValueAt<int64_t>(kept, "rays");
  for (const auto& [key, member] : kKeptPoints) errors->*member = NumberAt(kept, key);
}

void TakeClasses(const Json& json, Metrics* metrics) {
  metrics->classes = ClassScoresFromJson(ValueAt<Json>(json, "classes"));
  metrics->flat_roofs = ValueAt<int>(json, "flat_roofs");
  metrics->flat_roof_rms_m = NumberAt(json, "flat_roof_rms_m");
  metrics->flat_roof_nmad_m = NumberAt(json, "flat_roof_nmad_m");
}

// Earlier versions wrote less.
void TakeGeoFit(const Json& json, Metrics* metrics) {
  const Json geo = ValueAt<Json>(json, "geo");
  if (!geo.is_object()) return;
  metrics->georeferenced = ValueAt<bool>(geo, "georeferenced");
  metrics->problem_codes = ValueAt<std::vector<std::string>>(geo, "problems");
  Json fit = survey::ToJson(survey::GeoFit{});
  for (const auto& [key, fit_key] : kFitKeys) {
    const auto found = geo.find(key);
    if (found != geo.end() && !found->is_null()) fit[fit_key] = *found;
  }
  metrics->geo_fit = survey::GeoFitFromJson(fit);
}

Metrics MetricsFrom(const Json& json) {
  Metrics metrics;
  for (const std::span<const KeyedNumber> numbers :
       {std::span<const KeyedNumber>(kScores), std::span<const KeyedNumber>(kSeams), std::span<const KeyedNumber>(kAgainstTruth),
        std::span<const KeyedNumber>(kTraining), std::span<const KeyedNumber>(kHeights)}) {
    TakeNumbers(numbers, json, &metrics);
  }
  metrics.has_truth = json.contains("depth_rmse_m");
  TakeKeptPoints(json, &metrics.kept_points);
  if (json.contains("surface") && json.at("surface").is_object()) metrics.surface = surface::SurfaceScoresFromJson(json.at("surface"));
  if (json.contains("buildings") && json.at("buildings").is_object()) metrics.buildings = buildings::BuildingScoresFromJson(json.at("buildings"));
  const Json profile = ValueAt<Json>(json, "floater_profile"), photos = ValueAt<Json>(json, "psnr_per_image");
  for (const Json& place : profile) {
    metrics.floater_profile.emplace_back(NumberAt(place, "clearance_m"), NumberAt(place, "opacity"));
  }
  metrics.lpips_note = ValueAt<std::string>(json, "lpips_note");
  for (const auto& [name, psnr] : photos.items()) {
    photos::PhotoScore photo;
    photo.name = name;
    if (psnr.is_number()) photo.psnr_db = psnr.get<double>();
    metrics.photos.push_back(std::move(photo));
  }
  TakeBlocks(json, &metrics);
  TakeClasses(json, &metrics);
  metrics.peak_rss_bytes = ValueAt<int64_t>(json, "peak_rss_bytes");
  metrics.parameters = ValueAt<int64_t>(json, "parameters");
  metrics.ranks = ValueAt<int>(json, "ranks");
  metrics.threads = ValueAt<int>(json, "threads");
  metrics.evaluate_seconds = NumberAt(json, "evaluate_seconds");
  metrics.evaluate_peak_rss_bytes = ValueAt<int64_t>(json, "evaluate_peak_rss_bytes");
  metrics.image_width = ValueAt<int>(json, "image_width");
  metrics.n_photos = ValueAt<int>(json, "photos_registered");
  metrics.n_unregistered = ValueAt<int>(json, "photos_unregistered");
  metrics.n_test = ValueAt<int>(json, "photos_held_out");
  metrics.resected_holdout = ValueAt<std::string>(json, "holdout_poses") == "resected";
  TakeGeoFit(json, &metrics);
  for (const Json& warning : ValueAt<Json>(json, "warnings")) {
    if (warning.is_string()) {
      metrics.warnings.push_back({warning, ""});  // as earlier versions wrote them
    } else {
      metrics.warnings.push_back({warning.at("finding"), warning.at("advice")});
    }
  }
  metrics.machine = ValueAt<std::string>(json, "machine");
  metrics.date = ValueAt<std::string>(json, "date");
  metrics.config = ValueAt<std::string>(json, "config");
  return metrics;
}

}  // namespace

std::string MetricsJson(const Metrics& metrics) {
  Json json;
  PutNumbers(kScores, metrics, &json);
  json["lpips_note"] = metrics.lpips_note;
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
  if (metrics.surface) json["surface"] = ToJson(*metrics.surface);
  if (metrics.buildings) json["buildings"] = ToJson(*metrics.buildings);
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

Metrics ReadMetrics(const std::filesystem::path& file) {
  constexpr const char* kEvaluateAgain = "Run 'skyquilt evaluate' again with --restart";
  const Json json = Json::parse(base::ReadFile(file), nullptr, false);
  if (!json.is_object()) throw base::InputError(file, "is damaged: not valid JSON", kEvaluateAgain);
  try {
    return MetricsFrom(json);
  } catch (const Json::exception& error) {
    throw base::InputError(file, std::string("is damaged: ") + error.what(), kEvaluateAgain);
  }
}

}  // namespace skyquilt::evaluate::metrics
