#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/survey/geo_fit.h"
#include "evaluate/buildings/buildings_json.h"
#include "evaluate/metrics/class_json.h"
#include "evaluate/metrics/metrics_keys.h"
#include "evaluate/ortho/ortho_json.h"
#include "evaluate/surface/surface_json.h"

namespace skyquilt::evaluate::metrics {

namespace {

using Json = nlohmann::ordered_json;

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
  if (json.contains("orthophoto") && json.at("orthophoto").is_object()) metrics.ortho = ortho::OrthoScoresFromJson(json.at("orthophoto"));
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
