#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "bench/study/common_pixels.h"
#include "bench/study/compare.h"
#include "bench/study/ground_scores.h"
#include "bench/study/joined_tables.h"
#include "bench/study/methods_parts.h"
#include "bench/study/study_tables.h"
#include "partition/block.h"

namespace skyquilt::bench {
namespace {

constexpr int kMethodViews = 2;  // photos to choose crops from; networks take minutes for one

// All methods on the survey of one study. in_bench: path of the study's folder within the bench's, with a slash; empty: the same.
std::vector<MethodPair> RunMethods(Study& study, const MethodsOptions& options, const SurveyCondition& condition, const std::string& in_bench) {
  study.UseSeeds(options.seeds);
  study.KeepViews(kMethodViews);
  std::vector<MethodPair> pairs;
  for (const StudiedPreset& method : options.methods) {
    coordinator::Settings settings = study.settings();
    for (const config::Override& entry : method.overrides) settings.Set(entry);
    MethodPair pair{.name = method.name, .network = settings.train.encoding == "frequency", .one = {}, .blocks = {}};
    const auto run = [&](const std::string& name, const std::string& label, const std::vector<config::Override>& own) {
      Variant variant{.name = method.name + "_" + name + (condition.suffix.empty() ? "" : "_" + condition.suffix),
                      .label = method.name + ", " + label,
                      .overrides = method.overrides};
      variant.overrides.push_back({"run.time_budget_s", fmt::format("{}", options.budget_s)});
      variant.overrides.insert(variant.overrides.end(), own.begin(), own.end());
      return study.Run(variant);
    };
    pair.blocks = run("blocks", "blocks", {{"partition.blocks", options.blocks}});
    const std::string joined = std::to_string(JoinedTableSize(pair.blocks, settings.partition.max_log2_table_size));
    pair.one =
        run("one", "one field", {{"partition.blocks", "1x1"}, {"partition.min_log2_table_size", joined}, {"partition.max_log2_table_size", joined}});
    pairs.push_back(std::move(pair));
  }
  std::vector<VariantResult*> all;
  for (MethodPair& pair : pairs) all.insert(all.end(), {&pair.one, &pair.blocks});
  ScoreCommonPixels(study.folder(), all);
  for (VariantResult* result : all) {
    for (std::string* path : {&result->photo, &result->render, &result->error, &result->report, &result->views}) {
      if (!path->empty()) *path = in_bench + *path;
    }
  }
  return pairs;
}

std::vector<VariantResult> Results(const std::vector<MethodPair>& pairs) {
  std::vector<VariantResult> results;
  for (const MethodPair& pair : pairs) results.insert(results.end(), {pair.one, pair.blocks});
  return results;
}

// Nothing when no method has blocks.
std::optional<BenchTable> GroundOf(const Study& study, const std::vector<MethodPair>& pairs) {
  for (const MethodPair& pair : pairs) {
    const std::filesystem::path file = study.folder() / "runs" / pair.blocks.name / "blocks.geojson";
    if (!pair.blocks.failure.empty() || !std::filesystem::exists(file)) continue;
    std::vector<geo::BlockBox> boxes;
    std::vector<std::string> names;
    for (const partition::Block& block : partition::LoadBlocks(file).blocks) {
      boxes.push_back(block);
      names.push_back(block.name);
    }
    std::vector<const VariantResult*> results;
    for (const MethodPair& one : pairs) results.insert(results.end(), {&one.one, &one.blocks});
    return GroundTable(pairs, names, ScoreGround(study.folder(), study.survey(), boxes, results), "blocks");
  }
  return std::nullopt;
}

// PSNR of every method over the conditions, one row each.
BenchTable ConditionTable(const std::vector<SurveyCondition>& conditions, const std::vector<std::vector<MethodPair>>& by_condition) {
  BenchTable table{.name = "surveys",
                   .title = "",
                   .note = "PSNR may be compared within a survey, not between surveys, whose held-out photos differ.",
                   .columns = {"survey", "method", "photos", "PSNR, one field", "PSNR, blocks", "blocks - one"},
                   .rows = {}};
  for (size_t c = 0; c < conditions.size(); ++c) {
    for (const MethodPair& pair : by_condition[c]) {
      const std::vector<double> psnr_db = ComparablePsnr({&pair.one, &pair.blocks});
      const Difference gain = PsnrDifference(pair.blocks, pair.one);
      BenchCell shown = BenchCell::Number(gain.median, 2, "dB");
      if (gain.pairs > 0) shown.shown = Shown(gain);
      table.rows.push_back({BenchCell::Text(conditions[c].label), BenchCell::Text(pair.name), BenchCell::Number(pair.blocks.training_photos, 0),
                            BenchCell::Number(psnr_db[0], 2, "dB"), BenchCell::Number(psnr_db[1], 2, "dB"), shown});
    }
  }
  return table;
}

// The best of each group, and what blocks are worth to it.
void AddBest(const std::vector<MethodPair>& pairs, BenchPage* page) {
  for (const bool network : {false, true}) {
    const MethodPair* best = nullptr;
    const auto psnr_of = [](const MethodPair& pair) { return ComparablePsnr({&pair.blocks, &pair.one}); };
    for (const MethodPair& pair : pairs) {
      if (pair.network == network && std::isfinite(psnr_of(pair)[0]) && (best == nullptr || psnr_of(pair)[0] > psnr_of(*best)[0])) best = &pair;
    }
    if (best == nullptr) continue;
    page->figures.push_back({network ? "Best network, blocks" : "Best with tables, blocks", fmt::format("{:.2f} dB", psnr_of(*best)[0]), best->name});
    page->figures.push_back(DifferenceFigure("its blocks against one field", PsnrDifference(best->blocks, best->one), best->name));
  }
}

}  // namespace

std::vector<config::Override> FirstSurvey(const std::vector<double>& overlaps, const std::vector<double>& altitudes_m) {
  return SurveyConditions(overlaps, altitudes_m).front().overrides;
}

StudyBench MethodsBench(Study& study, const MethodsOptions& options) {
  const std::vector<SurveyCondition> conditions = SurveyConditions(options.overlaps, options.altitudes_m);
  std::vector<std::vector<MethodPair>> by_condition = {RunMethods(study, options, conditions.front(), "")};
  for (size_t c = 1; c < conditions.size(); ++c) {
    const std::string& name = conditions[c].suffix;
    Study other = study.Beside(name, {.folder = {}, .place = study.place(), .model = {}}, conditions[c].overrides);
    by_condition.push_back(RunMethods(other, options, conditions[c], name + "/"));
  }
  const std::vector<MethodPair>& pairs = by_condition.front();
  const double training_pixels = TrainingPixels(study.survey(), study.settings().run.image_width);

  StudyBench bench;
  BenchPage& page = bench.page;
  page.name = "methods";
  page.title = "Methods side by side";
  page.lead = fmt::format(
      "Published methods as this program can train them (configs/methods), each as one field of the whole survey and as {} blocks, {:g} s of "
      "training "
      "for every row, the context included. Where a method has tables, the one field has as many entries as all blocks together. Networks of NeRF's "
      "size stand apart: in this time they make a small part of the steps of their papers.",
      options.blocks, options.budget_s);
  if (!conditions.front().label.empty()) page.lead += " All but the last section: " + conditions.front().label + ".";
  AddBest(pairs, &page);
  page.verdicts = MethodVerdicts(pairs);
  BenchSection quality{
      .id = "methods", .title = "One field against blocks", .lead = "", .charts = {MethodChart(pairs)}, .tables = {}, .pictures = {}};
  const auto is_network = [](const MethodPair& pair) { return pair.network; };
  if (!std::all_of(pairs.begin(), pairs.end(), is_network)) quality.tables.push_back(MethodTable(pairs, false, ""));
  if (std::any_of(pairs.begin(), pairs.end(), is_network)) {
    quality.tables.push_back(MethodTable(pairs, true, "networks"));
    quality.tables.push_back(NetworkStepsTable(pairs, training_pixels, "steps"));
  }
  page.sections.push_back(std::move(quality));
  page.sections.push_back({.id = "matrixcity",
                           .title = "Beside MatrixCity",
                           .lead = "What the benchmark that sets methods side by side, one model against several, has published.",
                           .charts = {},
                           .tables = {MatrixCityTable(pairs, "matrixcity")},
                           .pictures = {}});
  if (std::optional<BenchTable> ground = GroundOf(study, pairs)) {
    page.sections.push_back({.id = "blocks", .title = "Block by block", .lead = "", .charts = {}, .tables = {std::move(*ground)}, .pictures = {}});
  }
  for (BenchSection& section : WriteMethodPictures(pairs, study.folder())) page.sections.push_back(std::move(section));
  page.sections.push_back(
      {.id = "cost", .title = "Cost", .lead = "", .charts = {}, .tables = {QualityTable(Results(pairs), "cost")}, .pictures = {}});
  if (conditions.size() > 1) {
    page.sections.push_back({.id = "surveys",
                             .title = "Overlap and altitude",
                             .lead = "The same place flown in other ways.",
                             .charts = {},
                             .tables = {ConditionTable(conditions, by_condition)},
                             .pictures = {}});
    for (size_t c = 1; c < conditions.size(); ++c) {
      for (const std::string& verdict : OrderVerdicts(by_condition[c])) page.verdicts.push_back(conditions[c].label + ": " + verdict);
    }
  }
  for (const std::vector<MethodPair>& of_condition : by_condition) {
    for (VariantResult& result : Results(of_condition)) bench.results.push_back(std::move(result));
  }
  return bench;
}

}  // namespace skyquilt::bench
