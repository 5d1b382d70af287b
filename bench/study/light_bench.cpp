#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "bench/study/light_parts.h"
#include "bench/study/study_benches.h"
#include "bench/study/study_tables.h"

namespace skyquilt::bench {
namespace {

constexpr const char* kIntensity = "intensity";  // the folder of the second set, and its simulate.lights

std::vector<std::string> LightsOf(const survey::Survey& survey) {
  std::set<std::string> folders;
  for (const survey::Photo& photo : survey.photos) folders.insert(std::filesystem::path(photo.name).parent_path().generic_string());
  return {folders.begin(), folders.end()};
}

// in_bench: path of the study's folder within the bench's, with a slash; empty: the same.
LightSet RunLights(Study& study, const LightBenchOptions& options, bool correction, const std::string& in_bench) {
  LightSet set;
  set.lights = LightsOf(study.survey());
  study.MeasureLights({set.lights});
  std::vector<std::string> every_second;
  for (size_t i = 0; i < set.lights.size(); i += 2) every_second.push_back(set.lights[i] + "/");
  const auto run = [&](const std::string& name, const std::string& label, bool codes, const std::string& brightness,
                       const std::vector<std::string>& prefixes) {
    Variant variant{.name = name, .label = label, .photo_prefixes = prefixes};
    if (options.budget_s > 0.0) variant.overrides.push_back({"run.time_budget_s", fmt::format("{}", options.budget_s)});
    if (!codes) variant.overrides.push_back({"train.appearance_codes", "0"});
    variant.overrides.push_back({"brightness.correction", brightness});
    VariantResult result = study.Run(variant);
    for (std::string* path : {&result.photo, &result.render, &result.error, &result.report, &result.light_pictures}) {
      if (!path->empty()) *path = in_bench + *path;
    }
    return result;
  };
  set.every_second = run("every_second", "codes, every second light trained", true, "none", every_second);
  set.all = run("all_lights", "codes, all lights trained", true, "none", {});
  set.plain = run("no_codes", "no codes, all lights trained", false, "none", {});
  if (correction) set.corrected = run("corrected", "no codes, corrected brightness, all lights trained", false, "exif,gain", {});
  return set;
}

std::vector<VariantResult> Results(const LightSet& set) {
  std::vector<VariantResult> results = {set.every_second, set.all, set.plain};
  if (!set.corrected.lights.empty()) results.push_back(set.corrected);
  return results;
}

}  // namespace

std::vector<config::Override> SunLights() {
  return {{"simulate.lights", "sun"}};
}

StudyBench LightBench(Study& study, const LightBenchOptions& options) {
  const LightSet sun = RunLights(study, options, false, "");
  // Darker, so that three times the light is not clipped.
  Study beside = study.Beside(kIntensity, {.folder = {}, .place = study.place(), .model = {}},
                              {{"simulate.lights", kIntensity}, {"simulate.exposure_offset_stops", "-1.6"}});
  const LightSet intensity = RunLights(beside, options, true, std::string(kIntensity) + "/");

  StudyBench bench;
  BenchPage& page = bench.page;
  page.name = "light";
  page.title = "Light interpolated";
  page.lead = fmt::format(
      "One place photographed under {} elevations of the sun and under {} intensities of light, every photo again in each. The photos of a light "
      "share a "
      "code. Every second light is trained, and the light between is shown by the mean of its neighbours' codes.",
      sun.lights.size(), intensity.lights.size());
  page.verdicts = SunVerdicts(sun);
  for (std::string& verdict : IntensityVerdicts(intensity)) page.verdicts.push_back(std::move(verdict));
  if (const double way = MovementOfShadows(sun); std::isfinite(way)) {
    page.figures.push_back(
        {"Movement of shadows", fmt::format("{:.0f} %", 100.0 * way), "mixed codes; 0 %: a cross-fade, 100 %: the light's own code"});
  }
  page.sections.push_back({.id = "sun",
                           .title = "Elevation of the sun",
                           .lead = "",
                           .charts = {LightChart(sun, "Held-out photos by elevation of the sun", "sun (degrees)")},
                           .tables = {LightTable(sun, "sun", "sun (degrees)"), MovedTable(sun, "shadows")},
                           .pictures = {}});
  page.sections.push_back({.id = "intensity",
                           .title = "Intensity",
                           .lead = "",
                           .charts = {LightChart(intensity, "Held-out photos by intensity of the light", "intensity")},
                           .tables = {LightTable(intensity, kIntensity, "intensity")},
                           .pictures = {}});
  page.sections.push_back(WriteLightPictures(sun, study.folder()));
  std::vector<VariantResult> results = Results(sun);
  page.sections.push_back({.id = "cost", .title = "Cost", .lead = "", .charts = {}, .tables = {QualityTable(results, "cost")}, .pictures = {}});
  bench.results = std::move(results);
  for (VariantResult& result : Results(intensity)) {
    result.name = std::string(kIntensity) + "_" + result.name;
    bench.results.push_back(std::move(result));
  }
  return bench;
}

}  // namespace skyquilt::bench
