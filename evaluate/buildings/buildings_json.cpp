#include "evaluate/buildings/buildings_json.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "core/base/json_text.h"
#include "evaluate/json_members.h"

namespace skyquilt::evaluate::buildings {
namespace {

using BuildingsJson = nlohmann::ordered_json;

constexpr std::array<std::pair<const char*, int64_t BuildingScores::*>, 5> kBuildingCounts = {{{"found", &BuildingScores::found},
                                                                                               {"accepted", &BuildingScores::accepted},
                                                                                               {"solids_rejected", &BuildingScores::solids_rejected},
                                                                                               {"blocks_rejected", &BuildingScores::blocks_rejected},
                                                                                               {"blocks_instead", &BuildingScores::blocks_instead}}};
constexpr std::array<std::pair<const char*, int64_t BuildingDetection::*>, 4> kDetectionCounts = {{{"outlines", &BuildingDetection::outlines},
                                                                                                   {"matched", &BuildingDetection::matched},
                                                                                                   {"missed", &BuildingDetection::missed},
                                                                                                   {"invented", &BuildingDetection::invented}}};
constexpr std::array<std::pair<const char*, double BuildingDetection::*>, 6> kDetectionShares = {
    {{"building_completeness", &BuildingDetection::completeness},
     {"building_correctness", &BuildingDetection::correctness},
     {"building_quality", &BuildingDetection::quality},
     {"building_completeness_area", &BuildingDetection::completeness_area},
     {"building_correctness_area", &BuildingDetection::correctness_area},
     {"building_quality_area", &BuildingDetection::quality_area}}};
constexpr std::array<std::pair<const char*, double BuildingErrors::*>, 6> kErrorNumbers = {{{"bias", &BuildingErrors::bias},
                                                                                            {"rmse", &BuildingErrors::rmse},
                                                                                            {"nmad", &BuildingErrors::nmad},
                                                                                            {"median_abs", &BuildingErrors::median_abs},
                                                                                            {"p90_abs", &BuildingErrors::p90_abs},
                                                                                            {"within_sigma", &BuildingErrors::within_sigma}}};
constexpr const char* kAllBuildings = "all";
constexpr std::array<std::pair<const char*, BuildingOutcome::Fate>, 3> kFates = {
    {{"matched", BuildingOutcome::Fate::kMatched}, {"missed", BuildingOutcome::Fate::kMissed}, {"invented", BuildingOutcome::Fate::kInvented}}};

// Into an object that may have other keys already.
void PutDetection(const BuildingDetection& score, BuildingsJson* json) {
  for (const auto& [key, member] : kDetectionShares) (*json)[key] = base::NumberOrNull(score.*member);
  for (const auto& [key, member] : kDetectionCounts) (*json)[key] = score.*member;
}

BuildingDetection TakeDetection(const std::string& size, const BuildingsJson& json) {
  BuildingDetection score;
  score.size = size;
  for (const auto& [key, member] : kDetectionShares) TakeValue(json, key, &(score.*member));
  for (const auto& [key, member] : kDetectionCounts) TakeValue(json, key, &(score.*member));
  return score;
}

void PutRoof(const BuildingRoofScores& score, BuildingsJson* json) {
  (*json)["roof_kind_right"] = base::NumberOrNull(score.roof_right);
  BuildingsJson& errors = (*json)["errors"] = BuildingsJson::object();
  for (const BuildingErrors& one : score.errors) {
    BuildingsJson& figures = errors[one.measure] = {{"n", one.n}, {"with_sigma", one.with_sigma}};
    for (const auto& [key, member] : kErrorNumbers) figures[key] = base::NumberOrNull(one.*member);
  }
}

BuildingRoofScores TakeRoof(const std::string& roof, const BuildingsJson& json) {
  BuildingRoofScores score;
  score.roof = roof;
  TakeValue(json, "matched", &score.matched);
  TakeValue(json, "roof_kind_right", &score.roof_right);
  const BuildingsJson& errors = MemberAt(json, "errors");
  if (!errors.is_object()) return score;
  for (const auto& [measure, figures] : errors.items()) {
    BuildingErrors& one = score.errors.emplace_back();
    one.measure = measure;
    TakeValue(figures, "n", &one.n);
    TakeValue(figures, "with_sigma", &one.with_sigma);
    for (const auto& [key, member] : kErrorNumbers) TakeValue(figures, key, &(one.*member));
  }
  return score;
}

BuildingsJson OutcomeJson(const BuildingOutcome& outcome) {
  BuildingsJson json;
  for (const auto& [name, fate] : kFates) {
    if (fate == outcome.fate) json["fate"] = name;
  }
  if (outcome.truth_id >= 0) json["truth_id"] = outcome.truth_id;
  if (outcome.found_id >= 0) json["found_id"] = outcome.found_id;
  if (!outcome.roof.empty()) json["roof"] = outcome.roof;
  if (!outcome.roof_found.empty()) json["roof_found"] = outcome.roof_found;
  json["area_m2"] = base::NumberOrNull(outcome.area_m2);
  if (outcome.fate != BuildingOutcome::Fate::kMatched) return json;
  json["overlap"] = base::NumberOrNull(outcome.overlap);
  BuildingsJson& errors = json["errors"] = BuildingsJson::object();
  for (const BuildingOutcome::Error& one : outcome.errors) errors[one.measure] = {base::NumberOrNull(one.error), base::NumberOrNull(one.sigma)};
  return json;
}

// Nothing for an unknown fate.
std::optional<BuildingOutcome> TakeOutcome(const BuildingsJson& json) {
  BuildingOutcome outcome;
  const BuildingsJson& fate_json = MemberAt(json, "fate");
  const auto fate = std::find_if(kFates.begin(), kFates.end(), [&](const auto& known) { return fate_json == known.first; });
  if (fate == kFates.end()) return std::nullopt;
  outcome.fate = fate->second;
  TakeValue(json, "truth_id", &outcome.truth_id);
  TakeValue(json, "found_id", &outcome.found_id);
  TakeValue(json, "roof", &outcome.roof);
  TakeValue(json, "roof_found", &outcome.roof_found);
  TakeValue(json, "area_m2", &outcome.area_m2);
  TakeValue(json, "overlap", &outcome.overlap);
  const BuildingsJson& errors = MemberAt(json, "errors");
  if (!errors.is_object()) return outcome;
  for (const auto& [measure, pair] : errors.items()) {
    if (!pair.is_array() || pair.size() != 2 || !pair[0].is_number()) continue;
    BuildingOutcome::Error& one = outcome.errors.emplace_back();
    one.measure = measure;
    one.error = pair[0].get<double>();
    if (pair[1].is_number()) one.sigma = pair[1].get<double>();
  }
  return outcome;
}

// Figures of all buildings stand beside the counts, those of sizes and kinds of roof in objects of their own.
void PutTruth(const BuildingTruthScores& truth, BuildingsJson* json) {
  BuildingsJson sizes = BuildingsJson::object(), roofs = BuildingsJson::object();
  for (const BuildingDetection& score : truth.detection) PutDetection(score, score.size == kAllBuildings ? json : &sizes[score.size]);
  for (const BuildingRoofScores& score : truth.roofs) {
    BuildingsJson& place = score.roof == kAllBuildings ? *json : roofs[score.roof];
    place["matched"] = score.matched;
    PutRoof(score, &place);
  }
  (*json)["outlines_not_counted"] = truth.outlines_not_counted;
  (*json)["found_not_counted"] = truth.found_not_counted;
  (*json)["corners"] = truth.corners;
  (*json)["corners_found"] = base::NumberOrNull(truth.corners_found);
  (*json)["corner_rmse_m"] = base::NumberOrNull(truth.corner_rmse_m);
  (*json)["by_size"] = std::move(sizes);
  (*json)["by_roof"] = std::move(roofs);
  BuildingsJson& each = (*json)["each"] = BuildingsJson::array();
  for (const BuildingOutcome& outcome : truth.each) each.push_back(OutcomeJson(outcome));
}

BuildingTruthScores TakeTruth(const BuildingsJson& json) {
  BuildingTruthScores truth;
  TakeValue(json, "outlines_not_counted", &truth.outlines_not_counted);
  TakeValue(json, "found_not_counted", &truth.found_not_counted);
  TakeValue(json, "corners", &truth.corners);
  TakeValue(json, "corners_found", &truth.corners_found);
  TakeValue(json, "corner_rmse_m", &truth.corner_rmse_m);
  truth.detection.push_back(TakeDetection(kAllBuildings, json));
  truth.roofs.push_back(TakeRoof(kAllBuildings, json));
  const BuildingsJson &sizes = MemberAt(json, "by_size"), &roofs = MemberAt(json, "by_roof");
  if (sizes.is_object()) {
    for (const auto& [size, score] : sizes.items()) truth.detection.push_back(TakeDetection(size, score));
  }
  if (roofs.is_object()) {
    for (const auto& [roof, score] : roofs.items()) truth.roofs.push_back(TakeRoof(roof, score));
  }
  const BuildingsJson& each = MemberAt(json, "each");
  if (!each.is_array()) return truth;
  for (const BuildingsJson& one : each) {
    if (std::optional<BuildingOutcome> outcome = TakeOutcome(one)) truth.each.push_back(std::move(*outcome));
  }
  return truth;
}

}  // namespace

BuildingsJson ToJson(const BuildingScores& scores) {
  BuildingsJson json;
  for (const auto& [key, member] : kBuildingCounts) json[key] = scores.*member;
  json["metric"] = scores.metric;
  json["gsd_m"] = base::NumberOrNull(scores.gsd_m);
  json["footprint_m2"] = base::NumberOrNull(scores.footprint_m2);
  json["volume_m3"] = base::NumberOrNull(scores.volume_m3);
  if (scores.truth) PutTruth(*scores.truth, &json);
  return json;
}

BuildingScores BuildingScoresFromJson(const BuildingsJson& json) {
  BuildingScores scores;
  for (const auto& [key, member] : kBuildingCounts) TakeValue(json, key, &(scores.*member));
  TakeValue(json, "metric", &scores.metric);
  TakeValue(json, "gsd_m", &scores.gsd_m);
  TakeValue(json, "footprint_m2", &scores.footprint_m2);
  TakeValue(json, "volume_m3", &scores.volume_m3);
  if (!MemberAt(json, "outlines_not_counted").is_null()) scores.truth = TakeTruth(json);
  return scores;
}

}  // namespace skyquilt::evaluate::buildings
