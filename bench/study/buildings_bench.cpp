#include <fmt/core.h>

#include <algorithm>

#include "bench/study/buildings_parts.h"
#include "bench/study/common_pixels.h"
#include "bench/study/priors_parts.h"
#include "core/base/errors.h"

namespace skyquilt::bench {
namespace {

constexpr double kNadirTilt_deg = 10.0;  // photos that look down to within this angle are nadir photos

// Only points, terrain and buildings.json are needed.
const std::vector<config::Override> kNeededFiles = {
    {"surface.cloud", "true"},         {"surface.maps", "true"},   {"surface.glb", "false"},   {"surface.obj", "false"},
    {"surface.ply", "false"},          {"surface.tiles", "false"}, {"buildings.csv", "false"}, {"buildings.cityjson", "false"},
    {"buildings.geopackage", "false"}, {"buildings.glb", "false"}, {"buildings.dxf", "false"}, {"buildings.classify_cloud", "false"},
    {"buildings.footprints", ""}};

// As in the bench about priors.
std::vector<config::Override> PriorsOf(const std::string& name) {
  return PriorVariants({name}).back().overrides;
}

const std::vector<BuildingsVariant>& AllVariants() {
  static const std::vector<BuildingsVariant> kVariants = {
      {.name = "truth", .label = "true depth", .source = SurfaceSource::kTruth, .training = {}},
      {.name = "points", .label = "sparse points", .source = SurfaceSource::kPoints, .training = {}},
      {.name = "field", .label = "field", .source = SurfaceSource::kField, .training = {}},
      {.name = "no_priors", .label = "field, no priors", .source = SurfaceSource::kField, .training = {.overrides = PriorsOf("none")}},
      {.name = "priors", .label = "field, all priors", .source = SurfaceSource::kField, .training = {.overrides = PriorsOf("all")}},
      {.name = "nadir",
       .label = "field, nadir photos only",
       .source = SurfaceSource::kField,
       .training = {.max_tilt_deg = kNadirTilt_deg},
       .obliques = false}};
  return kVariants;
}

// Runs all variants in one town. place_in_bench: of the study's folder in the bench's, empty or with a slash at its end.
void RunTown(Study& study, const std::vector<BuildingsVariant>& variants, int seed, double budget_s, const std::string& place_in_bench,
             std::vector<BuildingsResults>* results) {
  if (!study.survey().truth || !study.survey().georeferenced) {
    throw base::UsageError("'bench buildings' compares with the true buildings: --survey must be a geo-referenced simulated survey, or give --place");
  }
  study.MeasureBuildings();
  for (size_t i = 0; i < variants.size(); ++i) {
    Variant variant = variants[i].training;
    variant.name = fmt::format("{}_s{}", variants[i].name, seed);
    variant.label = fmt::format("{}, seed {}", variants[i].label, seed);
    variant.overrides.insert(variant.overrides.end(), kNeededFiles.begin(), kNeededFiles.end());
    VariantResult result;
    if (variants[i].source == SurfaceSource::kField) {
      variant.overrides.push_back({"run.time_budget_s", fmt::format("{}", budget_s)});
      variant.overrides.push_back({"run.seed", std::to_string(seed)});
      result = study.Run(variant);
    } else {
      result = study.RunUntrained(variant, variants[i].source == SurfaceSource::kTruth ? MeasureFromTruth : MeasureFromPoints);
    }
    // From paths in the study's folder to paths in the bench's.
    for (std::string* path : {&result.photo, &result.render, &result.error, &result.report}) {
      if (!path->empty()) *path = place_in_bench + *path;
    }
    (*results)[i].towns.push_back(std::move(result));
  }
  std::vector<VariantResult*> of_town;
  of_town.reserve(results->size());
  for (BuildingsResults& of_variant : *results) of_town.push_back(&of_variant.towns.back());
  ScoreCommonPixels(study.folder(), of_town);
}

// Plans of the first town.
BenchSection PlanSection(const std::vector<BuildingsResults>& results, const Study& study) {
  BenchSection section{.id = "plans",
                       .title = "Plans",
                       .lead = "The first town: found footprints filled, true outlines as lines.",
                       .charts = {},
                       .tables = {},
                       .pictures = {}};
  for (const BuildingsResults& of : results) {
    const VariantResult& town = of.towns.front();
    std::string plan = BuildingsPlan(of.label, study.folder() / "runs" / town.name, study.survey());
    if (!plan.empty()) section.charts.push_back(std::move(plan));
  }
  return section;
}

}  // namespace

std::vector<std::string> BuildingsVariantNames() {
  std::vector<std::string> names;
  for (const BuildingsVariant& variant : AllVariants()) names.push_back(variant.name);
  return names;
}

std::vector<BuildingsVariant> BuildingsVariants(const std::vector<std::string>& names) {
  const std::vector<BuildingsVariant>& all = AllVariants();
  for (const std::string& name : names) {
    if (std::none_of(all.begin(), all.end(), [&](const BuildingsVariant& variant) { return variant.name == name; })) {
      throw base::UsageError("there is no variant '" + name + "' of buildings");
    }
  }
  std::vector<BuildingsVariant> chosen;
  std::copy_if(all.begin(), all.end(), std::back_inserter(chosen),
               [&](const BuildingsVariant& variant) { return std::find(names.begin(), names.end(), variant.name) != names.end(); });
  return chosen;
}

StudyBench BuildingsBench(Study& study, const BuildingsBenchOptions& options) {
  const std::vector<BuildingsVariant> variants = BuildingsVariants(options.variants.empty() ? BuildingsVariantNames() : options.variants);
  std::vector<BuildingsResults> results;
  for (const BuildingsVariant& variant : variants) {
    results.push_back({.name = variant.name, .label = variant.label, .obliques = variant.obliques, .towns = {}});
  }
  const std::vector<int> seeds = options.seeds.empty() ? std::vector<int>{study.settings().run.seed} : options.seeds;
  for (size_t i = 0; i < seeds.size(); ++i) {
    if (i == 0 || study.place().empty()) {
      RunTown(study, variants, seeds[i], options.budget_s, "", &results);
      continue;
    }
    const std::string name = fmt::format("seed_{}", seeds[i]);
    Study another = study.Beside(name, {.folder = {}, .place = study.place(), .model = {}}, {{"simulate.seed", std::to_string(seeds[i])}});
    RunTown(another, variants, seeds[i], options.budget_s, name + "/", &results);
  }

  StudyBench bench;
  BenchPage& page = bench.page;
  page.name = "buildings";
  page.title = "Buildings, found and measured";
  page.lead = fmt::format(
      "How well buildings are found and measured in the surface of a scene after {:g} s of training, with {} seed(s){}; in the surface of true "
      "depth, "
      "which is the best that this search can do; and in the sparse points alone, which is what is known without training.",
      options.budget_s, seeds.size(), study.place().empty() ? "" : " of training and of the simulated place");
  page.figures = BuildingsFigures(results);
  page.verdicts = BuildingsVerdicts(results);
  page.sections.push_back({.id = "found",
                           .title = "Found",
                           .lead = "",
                           .charts = {},
                           .tables = {BuildingsTable(results, ""), BuildingsSizeTable(results, "sizes")},
                           .pictures = {}});
  page.sections.push_back({.id = "measured",
                           .title = "Measured",
                           .lead = "Root mean square of the errors, with their 95 % intervals. The mark is the target; shorter is better.",
                           .charts = BuildingsCharts(results),
                           .tables = {BuildingsMeasureTable(results, "measures")},
                           .pictures = {}});
  if (BenchSection plans = PlanSection(results, study); !plans.charts.empty()) page.sections.push_back(std::move(plans));
  page.sections.push_back(
      {.id = "towns", .title = "Towns", .lead = "", .charts = {}, .tables = {BuildingsTownTable(results, "towns")}, .pictures = {}});
  for (size_t seed = 0; seed < seeds.size(); ++seed) {
    for (const BuildingsResults& of : results) bench.results.push_back(of.towns[seed]);
  }
  return bench;
}

}  // namespace skyquilt::bench
