#include <fmt/core.h>

#include <algorithm>

#include "bench/study/common_pixels.h"
#include "bench/study/priors_parts.h"
#include "bench/study/study_tables.h"
#include "core/base/errors.h"

namespace skyquilt::bench {
namespace {

constexpr int kViewedPhotos = 6;  // photos to choose crops from: enough to have walls among them

config::Override WeightOf(const StudiedPrior& prior, double weight) {
  return {"priors." + prior.name, fmt::format("{}", weight)};
}

// Trains all variants with one seed. The variants' names differ between seeds, as all trainings stand in one list of results.
void RunSeed(Study& study, const std::vector<PriorVariant>& variants, int seed, double budget_s, const std::string& place_in_bench,
             std::vector<PriorResults>* results) {
  study.KeepViews(kViewedPhotos);
  for (size_t i = 0; i < variants.size(); ++i) {
    Variant variant{.name = fmt::format("{}_s{}", variants[i].name, seed),
                    .label = fmt::format("{}, seed {}", variants[i].label, seed),
                    .overrides = variants[i].overrides};
    variant.overrides.push_back({"run.time_budget_s", fmt::format("{}", budget_s)});
    variant.overrides.push_back({"run.seed", std::to_string(seed)});
    VariantResult result = study.Run(variant);
    // From paths in the study's folder to paths in the bench's.
    for (std::string* path : {&result.photo, &result.render, &result.error, &result.report, &result.views}) {
      if (!path->empty()) *path = place_in_bench + *path;
    }
    (*results)[i].seeds.push_back(std::move(result));
  }
  std::vector<VariantResult*> of_seed;
  of_seed.reserve(results->size());
  for (PriorResults& of_variant : *results) of_seed.push_back(&of_variant.seeds.back());
  ScoreCommonPixels(study.folder(), of_seed);
}

// The changes that answer the question, of the variant with all priors or the last one.
void AddPriorFigures(const std::vector<PriorResults>& results, BenchPage* page) {
  const PriorResults& none = results.front();
  auto shown = std::find_if(results.begin(), results.end(), [](const PriorResults& r) { return r.name == "all"; });
  if (shown == results.end()) --shown;
  if (shown == results.begin()) return;
  for (const PriorFigure& figure : PriorFigures()) {
    const Difference change = ChangeOf(none, *shown, figure).difference;
    if (change.pairs == 0) continue;
    const std::string note = fmt::format("'{}' against '{}'", shown->label, none.label);
    if (figure.title == ComparedPsnr(results)) page->figures.push_back(DifferenceFigure(figure.title, change, note));
    const bool key = figure.title.ends_with("NMAD") || figure.title.starts_with("flat roofs");
    if (key) page->figures.push_back({figure.title, Signed(change.median, 1) + " %", note});
  }
}

std::vector<VariantResult> FirstSeeds(const std::vector<PriorResults>& results) {
  std::vector<VariantResult> first;
  first.reserve(results.size());
  for (const PriorResults& r : results) {
    first.push_back(r.seeds.front());
    first.back().label = r.label;
  }
  return first;
}

}  // namespace

const std::vector<StudiedPrior>& StudiedPriors() {
  static const std::vector<StudiedPrior> kPriors = {
      {"planar", 0.1, "rays within a segment of a photo end on a plane"},
      {"upright", 0.1, "such planes are level or vertical when they nearly are, and walls follow the direction of buildings"},
      {"planes", 0.01, "rays end on planes of sparse points"},
      {"points", 0.05, "rays towards sparse points end there"},
      {"normals", 0.01, "normals of the density, of a predicting head and of planes of sparse points agree"},
      {"orientation", 0.001, "normals of visible surfaces face the camera"},
  };
  return kPriors;
}

std::vector<std::string> PriorVariantNames() {
  std::vector<std::string> names = {"none"};
  for (const StudiedPrior& prior : StudiedPriors()) names.push_back(prior.name);
  names.insert(names.end(), {"all", "default"});
  return names;
}

std::vector<PriorVariant> PriorVariants(const std::vector<std::string>& names) {
  const std::vector<std::string> known = PriorVariantNames();
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) == known.end()) throw base::UsageError("there is no variant '" + name + "' of the priors");
  }
  std::vector<PriorVariant> variants;
  for (const std::string& name : known) {
    if (name != "none" && std::find(names.begin(), names.end(), name) == names.end()) continue;
    PriorVariant variant{.name = name, .label = name, .overrides = {}};
    for (const StudiedPrior& prior : StudiedPriors()) {
      if (name == "default") break;
      const bool on = name == "all" || name == prior.name;
      variant.overrides.push_back(WeightOf(prior, on ? prior.weight : 0.0));
      if (name == prior.name) variant.label = fmt::format("{} {}", name, prior.weight);
    }
    variants.push_back(std::move(variant));
  }
  return variants;
}

StudyBench PriorsBench(Study& study, const PriorsOptions& options) {
  const std::vector<PriorVariant> variants = PriorVariants(options.variants.empty() ? PriorVariantNames() : options.variants);
  std::vector<PriorResults> results;
  for (const PriorVariant& variant : variants) {
    // Before hours of training.
    coordinator::Settings settings = study.settings();
    for (const config::Override& entry : variant.overrides) settings.Set(entry);
    results.push_back({.name = variant.name, .label = variant.label, .seeds = {}});
  }
  const std::vector<int> seeds = options.seeds.empty() ? std::vector<int>{study.settings().run.seed} : options.seeds;
  for (size_t i = 0; i < seeds.size(); ++i) {
    if (i == 0 || study.place().empty()) {
      RunSeed(study, variants, seeds[i], options.budget_s, "", &results);
      continue;
    }
    const std::string name = fmt::format("seed_{}", seeds[i]);
    Study another = study.Beside(name, {.folder = {}, .place = study.place(), .model = {}}, {{"simulate.seed", std::to_string(seeds[i])}});
    RunSeed(another, variants, seeds[i], options.budget_s, name + "/", &results);
  }

  StudyBench bench;
  BenchPage& page = bench.page;
  page.name = "priors";
  page.title = "Plane roofs, upright walls";
  page.lead =
      fmt::format("What losses beside the photos do to the surface, each alone and all together, in {:g} s of training each, with {} seed(s){}: ",
                  options.budget_s, seeds.size(), study.place().empty() ? "" : " of training and of the simulated place");
  for (const StudiedPrior& prior : StudiedPriors()) page.lead += fmt::format("{} ({}), ", prior.name, prior.what);
  page.lead += "all of them, and the program's defaults. Changes are against training without any.";
  AddPriorFigures(results, &page);
  page.verdicts = PriorVerdicts(results);
  BenchSection quality{
      .id = "quality", .title = "Images, surface and time", .lead = "", .charts = {}, .tables = {PriorTable(results, "")}, .pictures = {}};
  if (results.size() > 1) quality.tables.push_back(PriorChangeTable(results, "changes"));
  page.sections.push_back(std::move(quality));
  if (std::vector<std::string> charts = PriorCharts(results); !charts.empty()) {
    page.sections.push_back({.id = "surface",
                             .title = "Spread of the depth",
                             .lead = "NMAD of depth in percent of that without priors. The mark is training without priors; shorter is better.",
                             .charts = std::move(charts),
                             .tables = {},
                             .pictures = {}});
  }
  for (BenchSection& section : WritePriorPictures(CropsOfPriors(results, study.folder()), study.folder())) {
    page.sections.push_back(std::move(section));
  }
  page.sections.push_back({.id = "trainings",
                           .title = "Trainings",
                           .lead = "The curves are those of the first seed.",
                           .charts = {TrainingChart(FirstSeeds(results))},
                           .tables = {PriorTrainingTable(results, "trainings")},
                           .pictures = {}});
  for (size_t seed = 0; seed < seeds.size(); ++seed) {
    for (const PriorResults& r : results) bench.results.push_back(r.seeds[seed]);
  }
  return bench;
}

}  // namespace skyquilt::bench
