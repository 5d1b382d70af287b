#include "evaluate/metrics/class_json.h"

#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/json_text.h"

namespace skyquilt::evaluate::metrics {
namespace {

constexpr std::array<std::pair<const char*, double ClassScore::*>, 8> kClassErrors = {
    {{"depth_bias_m", &ClassScore::depth_bias_m},
     {"depth_median_abs_m", &ClassScore::depth_median_abs_m},
     {"depth_nmad_m", &ClassScore::depth_nmad_m},
     {"depth_rmse_m", &ClassScore::depth_rmse_m},
     {"normal_median_deg", &ClassScore::normal_median_deg},
     {"normal_mean_deg", &ClassScore::normal_mean_deg},
     {"density_normal_median_deg", &ClassScore::density_normal_median_deg},
     {"head_normal_median_deg", &ClassScore::head_normal_median_deg}}};

}  // namespace

nlohmann::ordered_json ToJson(std::span<const ClassScore> scores) {
  nlohmann::ordered_json classes = nlohmann::ordered_json::object();
  for (const ClassScore& score : scores) {
    nlohmann::ordered_json& one = classes[score.name] = {{"pixels", score.pixels}, {"missing_pixels", score.missing_pixels}};
    for (const auto& [key, member] : kClassErrors) one[key] = base::NumberOrNull(score.*member);
  }
  return classes;
}

std::vector<ClassScore> ClassScoresFromJson(const nlohmann::ordered_json& classes) {
  std::vector<ClassScore> scores;
  for (const auto& [name, one] : classes.items()) {
    ClassScore score;
    score.name = name;
    score.pixels = one.value("pixels", int64_t{0});
    score.missing_pixels = one.value("missing_pixels", int64_t{0});
    for (const auto& [key, member] : kClassErrors) {
      const auto found = one.find(key);
      if (found != one.end() && !found->is_null()) score.*member = found->template get<double>();
    }
    scores.push_back(std::move(score));
  }
  return scores;
}

}  // namespace skyquilt::evaluate::metrics
