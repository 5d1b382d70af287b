#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "bench/study/study.h"
#include "core/base/json_text.h"
#include "evaluate/buildings/buildings_json.h"
#include "evaluate/metrics/class_json.h"
#include "evaluate/metrics/metrics.h"

namespace skyquilt::bench {
namespace {

using Json = nlohmann::ordered_json;

// Calls `each` for every member of a LightScore that is a measured number, with its JSON key.
template <typename Score, typename Each>
void EachLightNumber(Score& score, const Each& each) {
  each("psnr_db", score.psnr_db);
  each("ssim", score.ssim);
  each("stops", score.stops);
  each("moved_share", score.moved_share);
  each("moved_psnr_db", score.moved_psnr_db);
  each("followed", score.followed);
}

// Calls `each` for every member that is a single number, with its JSON key.
template <typename Result, typename Each>
void EachNumber(Result& r, const Each& each) {
  each("psnr_db", r.psnr_db);
  each("psnr_common_db", r.psnr_common_db);
  each("ssim", r.ssim);
  each("flip", r.flip);
  each("lpips", r.lpips);
  each("psnr_full_db", r.psnr_full_db);
  each("ssim_full", r.ssim_full);
  each("coverage", r.coverage);
  each("seam_gap_db", r.seam_gap_db);
  each("depth_rmse_m", r.depth_rmse_m);
  each("depth_median_abs_m", r.depth_median_abs_m);
  each("floater_opacity", r.floater_opacity);
  each("flat_roof_rms_m", r.flat_roof_rms_m);
  each("flat_roof_nmad_m", r.flat_roof_nmad_m);
  each("kept_median_gsd", r.kept_median_gsd);
  each("kept_nmad_gsd", r.kept_nmad_gsd);
  each("train_seconds", r.train_seconds);
  each("samples_per_second", r.samples_per_second);
  each("samples", r.samples);
  each("peak_rss_bytes", r.peak_rss_bytes);
  each("parameters", r.parameters);
  each("scene_parameters", r.scene_parameters);
  each("scene_bytes", r.scene_bytes);
  each("evaluate_seconds", r.evaluate_seconds);
  each("wall_seconds", r.wall_seconds);
  each("ortho_psnr_db", r.ortho_psnr_db);
  each("ortho_ssim", r.ortho_ssim);
  each("f_score", r.f_score);
}

}  // namespace

std::string ResultJson(const VariantResult& result, const std::string& identity) {
  Json json;
  json["name"] = result.name;
  json["label"] = result.label;
  json["identity"] = identity;
  if (!result.failure.empty()) json["failure"] = result.failure;
  EachNumber(result, [&](const char* key, double value) { json[key] = base::NumberOrNull(value); });
  json["blocks"] = result.blocks;
  json["layout"] = result.layout;
  json["training_photos"] = result.training_photos;
  json["fields"] = Json::array();
  for (const VariantField& field : result.fields) {
    json["fields"].push_back({{"name", field.name},
                              {"parameters", field.parameters},
                              {"scene_parameters", field.scene_parameters},
                              {"log2_table_size", field.log2_table_size},
                              {"samples", field.samples},
                              {"steps", field.steps},
                              {"rays", field.rays},
                              {"seconds", field.seconds},
                              {"psnr_db", base::NumberOrNull(field.psnr_db)},
                              {"falls", field.falls},
                              {"worst_fall_db", base::NumberOrNull(field.worst_fall_db)},
                              {"end_below_best_db", base::NumberOrNull(field.end_below_best_db)},
                              {"shows_context", field.shows_context}});
  }
  json["scales"] = Json::array();
  for (const ScaleScore& score : result.scales) {
    json["scales"].push_back({{"group", score.group},
                              {"divisor", score.divisor},
                              {"averaged", score.averaged},
                              {"photos", score.photos},
                              {"width", score.width},
                              {"psnr_db", base::NumberOrNull(score.psnr_db)},
                              {"render_seconds", score.render_seconds},
                              {"frame_seconds", base::NumberOrNull(score.frame_seconds)}});
  }
  json["scale_pictures"] = result.scale_pictures;
  for (const LightScore& score : result.lights) {
    Json entry = {{"light", score.light}, {"look", score.look}, {"photos", score.photos}};
    EachLightNumber(score, [&](const char* key, double value) { entry[key] = base::NumberOrNull(value); });
    json["lights"].push_back(std::move(entry));
  }
  if (!result.light_pictures.empty()) json["light_pictures"] = result.light_pictures;
  json["classes"] = ToJson(std::span<const evaluate::metrics::ClassScore>(result.classes));
  json["views"] = result.views;
  if (result.buildings) json["buildings"] = ToJson(*result.buildings);
  if (!result.stage_seconds.empty()) json["stage_seconds"] = result.stage_seconds;
  if (!result.given_up.empty()) json["given_up"] = result.given_up;
  json["curve"] = result.curve;
  json["floater_profile"] = result.floater_profile;
  for (const auto& [key, value] :
       {std::pair{"photo", &result.photo}, {"render", &result.render}, {"error", &result.error}, {"report", &result.report}}) {
    json[key] = *value;
  }
  return base::JsonText(json, 1) + "\n";
}

VariantResult ParseResult(const std::string& text, std::string* identity) {
  const Json json = Json::parse(text);
  VariantResult result;
  json.at("name").get_to(result.name);
  json.at("label").get_to(result.label);
  json.at("identity").get_to(*identity);
  result.failure = json.value("failure", "");
  // Older programs had fewer scores.
  EachNumber(result, [&](const char* key, double& value) { value = base::NanIfNull(json.value(key, Json(nullptr))); });
  json.at("blocks").get_to(result.blocks);
  json.at("layout").get_to(result.layout);
  json.at("training_photos").get_to(result.training_photos);
  for (const Json& field : json.at("fields")) {
    result.fields.push_back({.name = field.at("name").get<std::string>(),
                             .parameters = field.at("parameters").get<int64_t>(),
                             .samples = field.at("samples").get<int64_t>(),
                             .scene_parameters = field.at("scene_parameters").get<int64_t>(),
                             .log2_table_size = field.at("log2_table_size").get<int>(),
                             .steps = field.value("steps", int64_t{0}),  // absent in results of older programs, as are rays and scales
                             .rays = field.value("rays", int64_t{0}),
                             .seconds = field.at("seconds").get<double>(),
                             .psnr_db = base::NanIfNull(field.at("psnr_db")),
                             .falls = field.value("falls", 0),
                             .worst_fall_db = base::NanIfNull(field.value("worst_fall_db", Json(nullptr))),
                             .end_below_best_db = base::NanIfNull(field.value("end_below_best_db", Json(nullptr))),
                             .shows_context = field.value("shows_context", false)});
  }
  for (const Json& score : json.value("scales", Json::array())) {
    result.scales.push_back({.group = score.at("group").get<std::string>(),
                             .divisor = score.at("divisor").get<int>(),
                             .averaged = score.at("averaged").get<bool>(),
                             .photos = score.at("photos").get<int>(),
                             .width = score.at("width").get<int>(),
                             .psnr_db = base::NanIfNull(score.at("psnr_db")),
                             .render_seconds = score.at("render_seconds").get<double>(),
                             .frame_seconds = base::NanIfNull(score.at("frame_seconds"))});
  }
  result.scale_pictures = json.value("scale_pictures", "");
  for (const Json& entry : json.value("lights", Json::array())) {
    LightScore score{
        .light = entry.at("light").get<std::string>(), .look = entry.at("look").get<std::string>(), .photos = entry.at("photos").get<int>()};
    EachLightNumber(score, [&](const char* key, double& value) { value = base::NanIfNull(entry.at(key)); });
    result.lights.push_back(std::move(score));
  }
  result.light_pictures = json.value("light_pictures", "");
  result.classes = evaluate::metrics::ClassScoresFromJson(json.value("classes", Json()));
  result.views = json.value("views", "");
  if (json.contains("buildings")) result.buildings = evaluate::buildings::BuildingScoresFromJson(json.at("buildings"));
  if (json.contains("stage_seconds")) json.at("stage_seconds").get_to(result.stage_seconds);
  if (json.contains("given_up")) json.at("given_up").get_to(result.given_up);
  json.at("curve").get_to(result.curve);
  json.at("floater_profile").get_to(result.floater_profile);
  for (const auto& [key, value] :
       {std::pair{"photo", &result.photo}, {"render", &result.render}, {"error", &result.error}, {"report", &result.report}}) {
    json.at(key).get_to(*value);
  }
  return result;
}

VariantResult MedianResult(const std::string& name, const std::string& label, std::vector<VariantResult> trainings) {
  if (trainings.size() == 1) return std::move(trainings.front());
  const auto succeeded = [](const VariantResult& r) { return r.failure.empty(); };
  const auto first = std::find_if(trainings.begin(), trainings.end(), succeeded);
  VariantResult median = first == trainings.end() ? trainings.front() : *first;
  median.name = name;
  median.label = label;
  const auto failed = std::count_if(trainings.begin(), trainings.end(), std::not_fn(succeeded));
  if (failed > 0) median.label += fmt::format(" ({} of {} trainings failed)", failed, trainings.size());
  std::map<std::string, std::vector<double>> values;
  for (const VariantResult& training : trainings) {
    EachNumber(training, [&](const char* key, double value) { values[key].push_back(value); });
  }
  EachNumber(median, [&](const char* key, double& value) { value = evaluate::MedianOfMeasured(std::move(values[key])); });
  median.seeds = std::move(trainings);
  return median;
}

}  // namespace skyquilt::bench
