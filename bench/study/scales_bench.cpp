#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>

#include "bench/study/scales_parts.h"
#include "bench/study/scales_pictures.h"
#include "core/base/errors.h"

namespace skyquilt::bench {
namespace {

std::vector<ScaleMethod> MethodsOf(const ScalesOptions& options) {
  std::vector<ScaleMethod> methods;
  methods.reserve(2 * options.positions.size());
  for (const int positions : options.positions) {
    for (const bool pyramid : {false, true}) methods.push_back({.positions = positions, .pyramid = pyramid});
  }
  return methods;
}

// Gives every field as many steps as the result's had. All blocks get the mean of theirs.
std::vector<config::Override> SameSteps(const VariantResult& result) {
  int64_t context = 0, blocks = 0, n = 0;
  for (const VariantField& field : result.fields) {
    if (field.name == "context") {
      context = field.steps;
    } else {
      blocks += field.steps;
      ++n;
    }
  }
  if (context <= 0 || blocks < n || n == 0)
    throw base::InputError(result.report, "its training has no steps to repeat", "Give a longer --time-budget");
  return {{"run.time_budget_s", "0"}, {"context.steps", std::to_string(context)}, {"train.steps", std::to_string(blocks / n)}};
}

void AddPart(const std::vector<MethodResults>& methods, const std::string& part, const std::string& title, const std::string& lead,
             StudyBench* bench) {
  bench->page.sections.push_back(
      {.id = part,
       .title = title,
       .lead = lead,
       .charts = {ScaleChart(methods, title)},
       .tables = {ScaleTable(methods, part), FrameTimeTable(methods, part + "_seconds"), TrainingTable(methods, part + "_trainings")},
       .pictures = {}});
  for (const std::string& verdict : ScaleVerdicts(methods, title)) bench->page.verdicts.push_back(verdict);
  for (const MethodResults& m : methods) bench->results.insert(bench->results.end(), m.seeds.begin(), m.seeds.end());
}

void AddFigures(const std::vector<MethodResults>& methods, BenchPage* page) {
  const MethodResults* points = Find(methods, {});
  const MethodResults* cones = BestCones(methods);
  if (points == nullptr || cones == nullptr) return;
  for (const int divisor : DivisorsOf(methods)) {
    page->figures.push_back(
        DifferenceFigure(WidthName(divisor), PsnrDifferenceAt(*cones, *points, "", divisor), cones->label + " against " + points->label));
  }
}

}  // namespace

std::string ScaleMethod::Name() const {
  return (positions == 0 ? "points" : fmt::format("cones{}", positions)) + (pyramid ? "_pyramid" : "_photos");
}

std::string ScaleMethod::Label() const {
  return (positions == 0 ? "points" : fmt::format("cones of {}", positions)) + (pyramid ? ", pyramid" : ", photos");
}

std::vector<config::Override> ScaleMethod::Overrides() const {
  std::vector<config::Override> overrides;
  for (const char* section : {"context", "train"}) {
    overrides.push_back({fmt::format("{}.multisample", section), std::to_string(positions)});
    if (pyramid) continue;
    overrides.push_back({fmt::format("{}.pyramid", section), "1"});
    overrides.push_back({fmt::format("{}.pyramid_start", section), ""});
  }
  return overrides;
}

std::vector<MethodResults> RunMethods(Study& study, const std::string& part, const std::vector<ScaleMethod>& methods, const ScalesOptions& options,
                                      const Variant& like, const SeedOverrides& own) {
  const std::vector<int> seeds = options.seeds.empty() ? std::vector<int>{study.settings().run.seed} : options.seeds;
  std::vector<MethodResults> results;
  results.reserve(methods.size());
  for (const ScaleMethod& method : methods) {
    results.push_back({.method = method, .label = method.Label() + like.label, .seeds = {}});
    for (size_t seed = 0; seed < seeds.size(); ++seed) {
      Variant variant = like;
      variant.name = fmt::format("{}_{}", part, method.Name());
      variant.label = results.back().label;
      variant.overrides = own(seed);
      const std::vector<config::Override> of_method = method.Overrides();
      variant.overrides.insert(variant.overrides.end(), of_method.begin(), of_method.end());
      results.back().seeds.push_back(study.Run(study.WithSeed(std::move(variant), seeds[seed])));
    }
  }
  return results;
}

StudyBench ScalesBench(Study& study, const ScalesOptions& options) {
  StudyBench bench;
  BenchPage& page = bench.page;
  page.name = "scales";
  page.title = "Sharp at every distance";
  page.lead = fmt::format(
      "Held-out photos rendered at 1, 1/2, 1/4 and 1/8 of their width with one ray per pixel, against the photo averaged to the same size in linear "
      "light. Methods: samples as points or as cones with 1 or more positions each, taught from the photos alone or from a pyramid of them "
      "(final shares of the rays at 1, 1/2, 1/4, 1/8: {:g}).",
      fmt::join(study.settings().train.pyramid, ", "));
  study.MeasureScales({});
  const std::vector<ScaleMethod> methods = MethodsOf(options);
  for (const ScaleMethod& method : methods) {
    // Before hours of training.
    coordinator::Settings settings = study.settings();
    for (const config::Override& entry : method.Overrides()) settings.Set(entry);
  }
  const auto timed = [&options](size_t) { return std::vector<config::Override>{{"run.time_budget_s", fmt::format("{}", options.budget_s)}}; };
  std::vector<MethodResults> shown;
  if (options.equal_time) {
    shown = RunMethods(study, "time", methods, options, {}, timed);
    const std::string lead = fmt::format("{:g} s of training each, {} training(s) per method.", options.budget_s, shown.front().seeds.size());
    AddPart(shown, "time", "Equal time", lead, &bench);
  }
  if (options.equal_steps) {
    // The first method of part "time", which may not be among the methods.
    const std::vector<MethodResults> reference = RunMethods(study, "time", {ScaleMethod{}}, options, {}, timed);
    const auto& seeds = reference.front().seeds;
    const auto failed = std::find_if(seeds.begin(), seeds.end(), [](const VariantResult& r) { return !r.failure.empty(); });
    if (failed != seeds.end()) throw base::BlockError("equal steps need the training of '" + failed->label + "': " + failed->failure);
    const std::vector<MethodResults> stepped = RunMethods(study, "steps", methods, options, {}, [&seeds](size_t seed) {
      const VariantResult& like = seeds[seed];
      std::vector<config::Override> overrides = SameSteps(like);
      overrides.push_back({"partition.blocks", like.layout});
      return overrides;
    });
    AddPart(stepped, "steps", "Equal steps",
            fmt::format("As many steps as '{}' made in {:g} s, however long they take.", reference.front().label, options.budget_s), &bench);
    if (shown.empty()) shown = stepped;
  }
  AddFigures(shown, &page);
  for (const int divisor : {4, 8}) {
    if (shown.empty()) break;
    page.sections.push_back(CropSection(shown, {.folder = study.folder(),
                                                .runs = "",
                                                .id = fmt::format("crops_{}", divisor),
                                                .title = "Images at " + WidthName(divisor),
                                                .group = "",
                                                .divisor = divisor}));
  }
  WriteScaleSheet(shown, {4, 8}, study.folder());
  if (options.heights) AddHeights(study, options, &bench);
  return bench;
}

}  // namespace skyquilt::bench
