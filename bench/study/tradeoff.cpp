#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "bench/study/common_pixels.h"
#include "bench/study/compare.h"
#include "bench/study/pareto.h"
#include "bench/study/study_benches.h"
#include "bench/study/study_tables.h"
#include "core/page/curve_chart.h"

namespace skyquilt::bench {
namespace {

constexpr double kSameTime = 0.03;  // training times of one budget differ by at most this fraction

// Rounded to 1 s, or to 0.1 s below 10 s, so that the label shows the exact budget.
double Rounded(double seconds) {
  const double digits = seconds < 10.0 ? 10.0 : 1.0;
  return std::max(0.1, std::round(seconds * digits) / digits);
}

config::Override Budget(double seconds) {
  return {"run.time_budget_s", fmt::format("{}", seconds)};
}

std::vector<Priced> Prices(const std::vector<VariantResult>& results) {
  std::vector<Priced> points;
  points.reserve(results.size());
  const std::vector<double> psnr_db = ComparablePsnr(PointersTo(results));
  for (size_t i = 0; i < results.size(); ++i) points.push_back({results[i].train_seconds, psnr_db[i]});
  return points;
}

// Presets as curves over time, with the front through all of them.
std::string ParetoChart(const std::vector<std::string>& presets, const std::vector<std::vector<VariantResult>>& by_preset) {
  std::vector<VariantResult> all;
  for (const auto& results : by_preset) all.insert(all.end(), results.begin(), results.end());
  const std::vector<Priced> points = Prices(all);
  page::Curve front{.name = "best for its time", .points = {}, .band = true};
  for (const size_t i : ParetoFront(points)) front.points.emplace_back(points[i].cost, points[i].quality);
  std::vector<page::Curve> curves = {std::move(front)};
  auto point = points.begin();
  for (size_t p = 0; p < presets.size(); ++p) {
    page::Curve curve{.name = presets[p], .points = {}, .marks = true};
    for (size_t i = 0; i < by_preset[p].size(); ++i, ++point) curve.points.emplace_back(point->cost, point->quality);
    curves.push_back(std::move(curve));
  }
  return page::CurveChart(curves, {.title = "Quality for time", .x_label = "training time (s)", .y_label = "PSNR (dB)", .log_x = true});
}

// The section of variants that differ in one setting. x: the value on the axis for each result; empty: no plot.
BenchSection OneThing(const std::string& id, const std::string& title, const std::string& lead, const std::vector<VariantResult>& results,
                      const std::string& x_label = "", const std::vector<double>& x = {}, bool log_x = false) {
  BenchSection section{.id = id, .title = title, .lead = lead, .charts = {}, .tables = {QualityTable(results, id)}, .pictures = {}};
  if (x.empty()) return section;
  page::Curve curve{.name = "PSNR", .points = {}, .marks = true};
  for (size_t i = 0; i < results.size(); ++i) curve.points.emplace_back(x.at(i), results[i].psnr_db);
  section.charts.push_back(page::CurveChart({curve}, {.title = title, .x_label = x_label, .y_label = "PSNR (dB)", .log_x = log_x}));
  return section;
}

// The training of a preset that is nearest to the Pareto front of all presets; of equals the longest training.
struct Nearest {
  const VariantResult* result = nullptr;  // none when no training of the preset succeeded
  Difference below;                       // of the best in its time, minus it
  bool OnFront() const { return !below.seen; }
};

Nearest NearestToFront(const std::vector<VariantResult>& own, const std::vector<VariantResult>& all) {
  const std::vector<Priced> points = Prices(all);
  Nearest nearest;
  for (const VariantResult& r : own) {
    for (size_t i = 0; i < all.size(); ++i) {
      if (all[i].name != r.name || !r.failure.empty()) continue;
      const Difference below = PsnrDifference(all[BestForCost(points, i, kSameTime)], all[i]);
      if (below.pairs == 0) continue;
      if (nearest.result == nullptr || below.median <= nearest.below.median) nearest = {&r, below};
    }
  }
  return nearest;
}

std::string PresetVerdict(const std::string& preset, const Nearest& nearest) {
  if (nearest.result == nullptr) return "Preset '" + preset + "' could not be trained.";
  const VariantResult& r = *nearest.result;
  std::string text = fmt::format("Preset '{}' {}: nearest with {}; the best in that time is higher by {:.2f} dB{}.", preset,
                                 nearest.OnFront() ? "is on the Pareto front" : "is not on the Pareto front", r.label, nearest.below.median,
                                 nearest.OnFront() && nearest.below.median > 0.0 ? ", no more than the noise" : "");
  if (!nearest.OnFront()) text += fmt::format(" Each of its {} blocks was trained with {}.", r.layout, OfItsOwn(r));
  return text;
}

}  // namespace

config::Override ScoringWidth(const Study& study) {
  int width = study.settings().run.image_width;
  if (width == coordinator::kAutoWidth) width = coordinator::kLeastAutoWidth;
  if (width == 0) {
    for (const camera::Camera& camera : study.survey().cameras) width = std::max(width, camera.width);
  }
  return {"evaluate.image_width", std::to_string(width)};
}

StudyBench Tradeoff(Study& study, const TradeoffOptions& options) {
  StudyBench bench;
  BenchPage& page = bench.page;
  const config::Override scoring_width = ScoringWidth(study);
  std::vector<std::string> names;
  std::vector<std::vector<VariantResult>> by_preset;
  std::vector<VariantResult> presets;
  for (const StudiedPreset& preset : options.presets) {
    names.push_back(preset.name);
    by_preset.emplace_back();
    for (const double times : preset.budgets) {
      const double budget_s = Rounded(times * options.middle_budget_s);
      std::vector<config::Override> overrides = preset.overrides;
      overrides.push_back(Budget(budget_s));
      overrides.push_back(scoring_width);
      by_preset.back().push_back(study.Run({.name = fmt::format("{}_{}s", preset.name, NumberInName(budget_s)),
                                            .label = fmt::format("{}, {:g} s", preset.name, budget_s),
                                            .overrides = std::move(overrides)}));
    }
  }
  std::vector<VariantResult*> trained;
  for (std::vector<VariantResult>& results : by_preset) {
    for (VariantResult& result : results) trained.push_back(&result);
  }
  ScoreCommonPixels(study.folder(), trained);
  for (const std::vector<VariantResult>& results : by_preset) presets.insert(presets.end(), results.begin(), results.end());
  bench.results = presets;

  const config::Override middle = Budget(options.middle_budget_s);
  // The same training, written with fewer bits.
  std::vector<VariantResult> storage = study.RunMerged({.name = "storage_fp32", .label = "fp32", .overrides = {middle}},
                                                       {{.name = "storage_bf16", .label = "bf16", .overrides = {middle, {"merge.storage", "bf16"}}},
                                                        {.name = "storage_fp16", .label = "fp16", .overrides = {middle, {"merge.storage", "fp16"}}}});
  // The blocks are fixed, because automatic partition would make other blocks for other tables.
  const config::Override layout = {"partition.blocks", storage.front().layout.empty() ? study.settings().partition.blocks : storage.front().layout};
  std::vector<VariantResult> tables, samples, placing, photos;
  std::vector<double> table_x, sample_x, photo_x;
  for (const int log2 : options.log2_table_sizes) {
    const std::string size = std::to_string(log2);
    tables.push_back(study.Run({.name = "tables_" + size,
                                .label = "2^" + size,
                                .overrides = {middle, layout, {"partition.min_log2_table_size", size}, {"partition.max_log2_table_size", size}}}));
    table_x.push_back(tables.back().parameters);
  }
  for (const double step : options.step_voxels) {
    const std::string text = fmt::format("{:g}", step);
    samples.push_back(study.Run({.name = "step_" + NumberInName(step),
                                 .label = "a step of " + text + " voxels",
                                 .overrides = {middle, layout, {"train.step_voxels", text}, {"context.step_voxels", text}}}));
    sample_x.push_back(step);
  }
  for (const char* stratified : {"true", "false"}) {
    const bool on = std::string(stratified) == "true";
    placing.push_back(
        study.Run({.name = on ? "stratified" : "uniform",
                   .label = on ? "stratified: first sample at a random position in its step" : "uniform: first sample in the middle of its step",
                   .overrides = {middle, layout, {"train.stratified", stratified}, {"context.stratified", stratified}}}));
  }
  for (const int every : options.every_nth_photo) {
    photos.push_back(study.Run({.name = "photos_" + std::to_string(every),
                                .label = every == 1 ? "all photos" : fmt::format("one photo in {}", every),
                                .overrides = {middle, layout},
                                .every_nth_photo = every}));
    photo_x.push_back(photos.back().training_photos);
  }
  // Each section is a comparison of its own, like the presets.
  for (auto* group : {&storage, &tables, &samples, &placing, &photos}) {
    ScoreCommonPixels(study.folder(), PointersTo(*group));
    bench.results.insert(bench.results.end(), group->begin(), group->end());
  }

  page.name = "tradeoff";
  page.title = "Speed against accuracy";
  page.lead = fmt::format(
      "How more time, larger tables, more samples or more photos change the quality. First presets at several time budgets, then one setting at a "
      "time, "
      "{:.0f} s each.",
      options.middle_budget_s);
  for (size_t p = 0; p < names.size(); ++p) {
    const Nearest nearest = NearestToFront(by_preset[p], presets);
    page.verdicts.push_back(PresetVerdict(names[p], nearest));
    if (nearest.result == nullptr) continue;
    page.figures.push_back({"preset " + names[p], fmt::format("{:.2f} dB", nearest.result->psnr_db),
                            fmt::format("in {:.0f} s{}", nearest.result->train_seconds, nearest.OnFront() ? "" : ", not the best for its time")});
  }
  if (storage[0].failure.empty()) {
    for (const size_t k : {size_t{1}, size_t{2}}) {
      // Of the same training, so there is no noise, and so small that the rounded errors of common pixels would not show it.
      const std::string change = Signed(storage[k].psnr_db - storage[0].psnr_db, 3) + " dB";
      const double bytes = 100.0 * storage[k].scene_bytes / storage[0].scene_bytes;
      page.verdicts.push_back(fmt::format("{} storage: {} against fp32 at {:.0f} % of its bytes.", storage[k].label, change, bytes));
      if (k == 1) page.figures.push_back({"bf16 storage", change, fmt::format("{:.0f} % of the bytes", bytes)});
    }
  }
  page.sections.push_back({.id = "presets",
                           .title = "Presets and time",
                           .lead = "All are scored on held-out photos scaled down to a width of " + scoring_width.value + " pixels.",
                           .charts = {ParetoChart(names, by_preset), TrainingChart(presets)},
                           .tables = {QualityTable(presets, "presets")},
                           .pictures = {}});
  page.sections.push_back(OneThing("storage", "Storage of the parameters", "One training; its scene is stored with three precisions.", storage));
  page.sections.push_back(OneThing("tables", "Table sizes", "Entries per level of every block.", tables, "parameters", table_x, true));
  page.sections.push_back(OneThing(
      "samples", "Samples per ray",
      "The step along the ray as a multiple of the finest voxel. Half the step gives twice the samples per ray, and half the rays in the same time.",
      samples, "step along the ray (voxels)", sample_x));
  page.sections.push_back(OneThing("placing", "Stratified and uniform sampling", "", placing));
  page.sections.push_back(OneThing("photos", "Number of photos", "Training photos are left out evenly; the held-out photos are always the same.",
                                   photos, "training photos", photo_x));
  page.sections.push_back(PictureSection(presets));
  return bench;
}

}  // namespace skyquilt::bench
