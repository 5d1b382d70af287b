#include "evaluate/surface/surface_json.h"

#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "evaluate/json_members.h"

namespace skyquilt::evaluate::surface {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr std::array<std::pair<const char*, double SurfaceScores::*>, 6> kSurfaceNumbers = {
    {{"psnr", &SurfaceScores::psnr},
     {"psnr_field", &SurfaceScores::psnr_field},
     {"psnr_where_mesh", &SurfaceScores::psnr_where_mesh},
     {"psnr_field_where_mesh", &SurfaceScores::psnr_field_where_mesh},
     {"missing_share", &SurfaceScores::missing_share},
     {"decks_within_2_gsd", &SurfaceScores::decks_within_2_gsd}}};
constexpr std::array<std::pair<const char*, int64_t SurfaceRecord::*>, 7> kRecordCounts = {
    {{"triangles", &SurfaceRecord::triangles},
     {"edges", &SurfaceRecord::edges},
     {"boundary_edges", &SurfaceRecord::boundary_edges},
     {"non_manifold_edges", &SurfaceRecord::non_manifold_edges},
     {"points", &SurfaceRecord::points},
     {"photos", &SurfaceRecord::photos},
     {"virtual_views", &SurfaceRecord::virtual_views}}};
constexpr std::array<std::pair<const char*, double SurfaceRecord::*>, 4> kRecordNumbers = {{{"area_m2", &SurfaceRecord::area_m2},
                                                                                            {"filled_m2", &SurfaceRecord::filled_m2},
                                                                                            {"voxel_m", &SurfaceRecord::voxel_m},
                                                                                            {"seconds", &SurfaceRecord::seconds}}};
constexpr std::array<std::pair<const char*, std::string SurfaceFile::*>, 6> kFileTexts = {{{"file", &SurfaceFile::file},
                                                                                           {"content", &SurfaceFile::content},
                                                                                           {"format", &SurfaceFile::format},
                                                                                           {"crs", &SurfaceFile::crs},
                                                                                           {"vertical", &SurfaceFile::vertical},
                                                                                           {"detail", &SurfaceFile::detail}}};

void PutAgreement(const SurfaceAgreement& agreement, OrderedJson* json) {
  (*json)["mesh_samples"] = agreement.mesh_samples;
  (*json)["true_samples"] = agreement.true_samples;
  (*json)["accuracy_median_m"] = base::NumberOrNull(agreement.accuracy_median_m);
  (*json)["completeness_median_m"] = base::NumberOrNull(agreement.completeness_median_m);
  OrderedJson& list = (*json)["f_scores"] = OrderedJson::array();
  for (const SurfaceFScore& score : agreement.f_scores) {
    list.push_back({{"tau", score.tau},
                    {"tau_m", score.tau_m},
                    {"precision", base::NumberOrNull(score.precision)},
                    {"recall", base::NumberOrNull(score.recall)},
                    {"f", base::NumberOrNull(score.f)}});
  }
}

SurfaceAgreement TakeAgreement(const OrderedJson& json) {
  SurfaceAgreement agreement;
  TakeValue(json, "mesh_samples", &agreement.mesh_samples);
  TakeValue(json, "true_samples", &agreement.true_samples);
  TakeValue(json, "accuracy_median_m", &agreement.accuracy_median_m);
  TakeValue(json, "completeness_median_m", &agreement.completeness_median_m);
  const OrderedJson& list = MemberAt(json, "f_scores");
  for (size_t i = 0; list.is_array() && i < list.size(); ++i) {
    SurfaceFScore score;
    TakeValue(list[i], "tau", &score.tau);
    TakeValue(list[i], "tau_m", &score.tau_m);
    TakeValue(list[i], "precision", &score.precision);
    TakeValue(list[i], "recall", &score.recall);
    TakeValue(list[i], "f", &score.f);
    agreement.f_scores.push_back(std::move(score));
  }
  return agreement;
}

void PutRecord(const SurfaceRecord& record, OrderedJson* json) {
  for (const auto& [key, member] : kRecordCounts) (*json)[key] = record.*member < 0 ? OrderedJson(nullptr) : OrderedJson(record.*member);
  for (const auto& [key, member] : kRecordNumbers) (*json)[key] = base::NumberOrNull(record.*member);
  OrderedJson& list = (*json)["files"] = OrderedJson::array();
  for (const SurfaceFile& file : record.files) {
    OrderedJson one;
    for (const auto& [key, member] : kFileTexts) one[key] = file.*member;
    one["bytes"] = file.bytes;
    list.push_back(std::move(one));
  }
}

SurfaceRecord TakeRecord(const OrderedJson& json) {
  SurfaceRecord record;
  for (const auto& [key, member] : kRecordCounts) TakeValue(json, key, &(record.*member));
  for (const auto& [key, member] : kRecordNumbers) TakeValue(json, key, &(record.*member));
  const OrderedJson& list = MemberAt(json, "files");
  for (size_t i = 0; list.is_array() && i < list.size(); ++i) {
    SurfaceFile file;
    for (const auto& [key, member] : kFileTexts) TakeValue(list[i], key, &(file.*member));
    TakeValue(list[i], "bytes", &file.bytes);
    if (!file.file.empty()) record.files.push_back(std::move(file));
  }
  return record;
}

}  // namespace

OrderedJson ToJson(const SurfaceScores& scores) {
  OrderedJson json;
  for (const auto& [key, member] : kSurfaceNumbers) json[key] = base::NumberOrNull(scores.*member);
  json["pixels"] = scores.pixels;
  json["deck_samples"] = scores.deck_samples;
  PutAgreement(scores.agreement, &json);
  OrderedJson& classes = json["classes"] = OrderedJson::object();
  for (const SurfaceClassScore& score : scores.classes) {
    OrderedJson& one = classes[score.name] = {{"pixels", score.pixels},
                                              {"missing_pixels", score.missing_pixels},
                                              {"psnr", base::NumberOrNull(score.psnr_db)},
                                              {"psnr_field", base::NumberOrNull(score.psnr_field_db)}};
    PutAgreement(score.agreement, &one);
  }
  PutRecord(scores.record, &json);
  return json;
}

SurfaceScores SurfaceScoresFromJson(const OrderedJson& json) {
  SurfaceScores scores;
  for (const auto& [key, member] : kSurfaceNumbers) TakeValue(json, key, &(scores.*member));
  TakeValue(json, "pixels", &scores.pixels);
  TakeValue(json, "deck_samples", &scores.deck_samples);
  scores.agreement = TakeAgreement(json);
  const OrderedJson& classes = MemberAt(json, "classes");
  if (classes.is_object()) {
    for (const auto& [name, one] : classes.items()) {
      SurfaceClassScore score;
      score.name = name;
      TakeValue(one, "pixels", &score.pixels);
      TakeValue(one, "missing_pixels", &score.missing_pixels);
      TakeValue(one, "psnr", &score.psnr_db);
      TakeValue(one, "psnr_field", &score.psnr_field_db);
      score.agreement = TakeAgreement(one);
      scores.classes.push_back(std::move(score));
    }
  }
  scores.record = TakeRecord(json);
  return scores;
}

SurfaceRecord ReadSurfaceRecord(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return {};
  try {
    const OrderedJson json = OrderedJson::parse(base::ReadFile(file), nullptr, false);
    if (json.is_object()) return TakeRecord(json);
    base::LogWarning("{}: is not valid JSON, so the report does not list the files of the surface; run 'skyquilt surface' again", file.string());
  } catch (const base::InputError& error) {
    base::LogWarning("the report does not list the files of the surface: {}", error.what());
  }
  return {};
}

}  // namespace skyquilt::evaluate::surface
