#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "bench/study/pareto.h"
#include "bench/study/study_benches.h"
#include "bench/study/study_tables.h"
#include "core/base/amounts.h"
#include "core/page/curve_chart.h"

namespace skyquilt::bench {
namespace {

constexpr double kEarliest = 0.8, kLatest = 1.05;  // of the total: ends between these are on time
constexpr const char* kTimedStages[] = {"prepare", "partition", "train", "merge", "products", "surface", "buildings", "tour", "evaluate"};

struct TimedVariant {
  std::string preset;
  double within_s = 0.0;
  VariantResult result;
};

double SecondsOf(const VariantResult& result, const std::string& stage) {
  const auto found = std::find_if(result.stage_seconds.begin(), result.stage_seconds.end(), [&stage](const auto& one) { return one.first == stage; });
  return found == result.stage_seconds.end() ? VariantResult::kNone : found->second;
}

bool IsOnTime(const TimedVariant& run) {
  const double share = run.result.wall_seconds / run.within_s;
  return share >= kEarliest && share <= kLatest;
}

BenchTable QualityOverTime(const std::vector<TimedVariant>& runs) {
  BenchTable table{
      .name = "within",
      .columns = {"run", "allowed", "taken", "share", "PSNR", "SSIM", "F at 2 GSD", "orthophoto PSNR", "orthophoto SSIM", "training", "given up"}};
  table.note =
      "PSNR and SSIM over each run's own covered pixels of the held-out photos that it scored. F and the orthophoto only where the truth is known.";
  for (const TimedVariant& run : runs) {
    const VariantResult& r = run.result;
    table.rows.push_back({BenchCell::Text(r.label), BenchCell::Seconds(run.within_s), BenchCell::Seconds(r.wall_seconds),
                          BenchCell::Percent(r.wall_seconds / run.within_s, 0), BenchCell::Number(r.psnr_db, 2, "dB"), BenchCell::Number(r.ssim, 3),
                          BenchCell::Number(r.f_score, 3), BenchCell::Number(r.ortho_psnr_db, 2, "dB"), BenchCell::Number(r.ortho_ssim, 3),
                          BenchCell::Seconds(r.train_seconds), BenchCell::Text(std::to_string(r.given_up.size()))});
  }
  return table;
}

BenchTable StagesOverTime(const std::vector<TimedVariant>& runs) {
  BenchTable table{.name = "stages", .title = "Stage by stage", .columns = {"run"}};
  for (const char* stage : kTimedStages) table.columns.emplace_back(stage);
  for (const TimedVariant& run : runs) {
    std::vector<BenchCell> row = {BenchCell::Text(run.result.label)};
    for (const char* stage : kTimedStages) row.push_back(BenchCell::Seconds(SecondsOf(run.result, stage)));
    table.rows.push_back(std::move(row));
  }
  return table;
}

BenchTable GivenUpTable(const std::vector<TimedVariant>& runs) {
  BenchTable table{.name = "given_up", .title = "What was given up", .columns = {"run", "given up"}};
  for (const TimedVariant& run : runs) {
    for (const std::string& text : run.result.given_up) table.rows.push_back({BenchCell::Text(run.result.label), BenchCell::Text(text)});
  }
  return table;
}

std::string ClockChart(const std::vector<StudiedPreset>& presets, const std::vector<TimedVariant>& runs) {
  std::vector<Priced> points;
  for (const TimedVariant& run : runs) points.push_back({run.result.wall_seconds, run.result.psnr_db});
  page::Curve front{.name = "best for its time", .points = {}, .band = true};
  for (const size_t i : ParetoFront(points)) front.points.emplace_back(points[i].cost / 60.0, points[i].quality);
  std::vector<page::Curve> curves = {std::move(front)};
  for (const StudiedPreset& preset : presets) {
    page::Curve curve{.name = preset.name, .points = {}, .marks = true};
    for (const TimedVariant& run : runs) {
      if (run.preset == preset.name) curve.points.emplace_back(run.result.wall_seconds / 60.0, run.result.psnr_db);
    }
    curves.push_back(std::move(curve));
  }
  return page::CurveChart(
      curves, {.title = "Quality for time on the clock", .x_label = "from photos to report (min)", .y_label = "PSNR (dB)", .log_x = true});
}

}  // namespace

StudyBench TradeoffWithin(Study& study, const WithinOptions& options) {
  const config::Override scoring_width = ScoringWidth(study);
  std::vector<TimedVariant> runs;
  for (const StudiedPreset& preset : options.presets) {
    for (const double within_s : options.totals_s) {
      std::vector<config::Override> overrides = preset.overrides;
      overrides.push_back(scoring_width);
      runs.push_back({preset.name, within_s,
                      study.RunWithin({.name = fmt::format("{}_within_{}s", preset.name, NumberInName(within_s)),
                                       .label = fmt::format("{} within {}", preset.name, base::FormatDuration(within_s)),
                                       .overrides = std::move(overrides)},
                                      within_s)});
    }
  }
  StudyBench bench;
  BenchPage& page = bench.page;
  page.name = "tradeoff";
  page.title = "Speed against accuracy, by the clock";
  page.lead = "What a run shows that has so much time for everything, from photos to report, with each preset.";
  std::vector<VariantResult> results;
  for (const TimedVariant& run : runs) results.push_back(run.result);
  const auto n_on_time = std::count_if(runs.begin(), runs.end(), IsOnTime);
  page.verdicts.push_back(
      fmt::format("{} of {} runs took {:.0f} to {:.0f} % of their time.", n_on_time, runs.size(), 100.0 * kEarliest, 100.0 * kLatest));
  for (const double within_s : options.totals_s) {
    const TimedVariant* best = nullptr;
    for (const TimedVariant& run : runs) {
      if (run.within_s == within_s && std::isfinite(run.result.psnr_db) && (best == nullptr || run.result.psnr_db > best->result.psnr_db))
        best = &run;
    }
    if (best == nullptr) continue;
    page.verdicts.push_back(fmt::format("Within {}, '{}' is best: {:.2f} dB after {}.", base::FormatDuration(within_s), best->preset,
                                        best->result.psnr_db, base::FormatDuration(best->result.wall_seconds)));
  }
  page.figures.push_back({"runs on time", fmt::format("{} of {}", n_on_time, runs.size()), "80 to 105 % of what was allowed"});
  page.sections.push_back({.id = "within",
                           .title = "Total time",
                           .lead = "All are scored on held-out photos scaled down to a width of " + scoring_width.value + " pixels.",
                           .charts = {ClockChart(options.presets, runs)},
                           .tables = {QualityOverTime(runs), StagesOverTime(runs), GivenUpTable(runs)},
                           .pictures = {}});
  page.sections.push_back(PictureSection(results));
  bench.results = std::move(results);
  return bench;
}

}  // namespace skyquilt::bench
