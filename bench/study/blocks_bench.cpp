#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "bench/study/common_pixels.h"
#include "bench/study/compare.h"
#include "bench/study/study_benches.h"
#include "bench/study/study_tables.h"
#include "core/page/curve_chart.h"
#include "partition/block_grid.h"

namespace skyquilt::bench {
namespace {

// The variant of the highest PSNR, and those that are as good as far as can be seen.
void AddBest(const std::vector<VariantResult>& results, BenchPage* page) {
  const std::vector<double> psnr_db = ComparablePsnr(PointersTo(results));
  const auto highest =
      std::max_element(psnr_db.begin(), psnr_db.end(), [](double a, double b) { return a < b || (std::isnan(a) && !std::isnan(b)); });
  if (highest == psnr_db.end() || std::isnan(*highest)) return;
  const VariantResult& best = results[static_cast<size_t>(highest - psnr_db.begin())];
  page->figures.push_back({"Best", fmt::format("{:.2f} dB", *highest), best.label});
  page->verdicts.push_back(fmt::format("Best at this budget: {} with {:.2f} dB, {:.1f} M parameters, {:.2f} M samples/s.", best.label, *highest,
                                       best.parameters / 1e6, best.samples_per_second / 1e6));
  for (const VariantResult& other : results) {
    const Difference difference = PsnrDifference(other, best);
    if (&other == &best || difference.pairs == 0 || difference.seen) continue;
    page->verdicts.push_back(fmt::format("{} against it: {}.", other.label, Shown(difference)));
  }
}

int CountOf(const std::string& blocks) {
  const partition::BlockRequest request = partition::ParseBlockRequest(blocks);
  return request.rows * request.columns;
}

// Every variant gets the same time, or the same steps, of which the context has its share and every block as many as the others.
std::vector<config::Override> BudgetOf(const BlocksBenchOptions& options, double context_share, int blocks) {
  if (options.steps == 0) return {{"run.time_budget_s", fmt::format("{}", options.budget_s)}};
  const int context = std::max(1, static_cast<int>(std::lround(options.steps * context_share)));
  return {{"run.time_budget_s", "0"},
          {"context.steps", std::to_string(context)},
          {"train.steps", std::to_string(std::max(1, (options.steps - context) / blocks))}};
}

}  // namespace

StudyBench BlocksBench(Study& study, const BlocksBenchOptions& options) {
  StudyBench bench;
  BenchTable grid{.name = "psnr",
                  .title = "PSNR by number of blocks and table size",
                  .note = "Columns: entries per level of each block's tables.",
                  .columns = {"blocks"},
                  .rows = {}};
  std::vector<page::Curve> curves;
  for (const int log2 : options.log2_table_sizes) grid.columns.push_back(fmt::format("2^{}", log2));
  for (const std::string& blocks : options.blocks) {
    std::vector<BenchCell> row = {BenchCell::Text(blocks)};
    for (const int log2 : options.log2_table_sizes) {
      const std::string tables = std::to_string(log2);
      Variant variant{
          .name = fmt::format("{}_t{}", blocks, log2),
          .label = fmt::format("{}, 2^{}", blocks, log2),
          .overrides = {{"partition.blocks", blocks}, {"partition.min_log2_table_size", tables}, {"partition.max_log2_table_size", tables}}};
      for (config::Override& entry : BudgetOf(options, study.settings().run.context_share, CountOf(blocks)))
        variant.overrides.push_back(std::move(entry));
      bench.results.push_back(study.Run(variant));
      row.push_back(BenchCell::Number(bench.results.back().psnr_db, 2, "dB"));
    }
    grid.rows.push_back(std::move(row));
  }
  ScoreCommonPixels(study.folder(), PointersTo(bench.results));
  for (size_t c = 0; c < options.log2_table_sizes.size(); ++c) {
    page::Curve curve{.name = fmt::format("2^{}", options.log2_table_sizes[c]), .points = {}, .marks = true};
    for (size_t r = 0; r < options.blocks.size(); ++r) curve.points.emplace_back(CountOf(options.blocks[r]), grid.rows[r][c + 1].value);
    curves.push_back(std::move(curve));
  }
  BenchPage& page = bench.page;
  page.name = "blocks";
  page.title = "Number of blocks and table size";
  page.lead = fmt::format("Compares numbers of blocks and sizes of each block's tables, with {} for every variant.",
                          options.steps > 0 ? fmt::format("{} training steps of context and blocks together", options.steps)
                                            : fmt::format("{:.0f} s of training", options.budget_s));
  AddBest(bench.results, &page);
  page.sections.push_back({.id = "grid",
                           .title = "Number of blocks and table size",
                           .lead = "",
                           .charts = {page::CurveChart(curves, {.title = "PSNR by number of blocks", .x_label = "blocks", .y_label = "PSNR (dB)"})},
                           .tables = {grid},
                           .pictures = {}});
  page.sections.push_back({.id = "all", .title = "All figures", .lead = "", .charts = {}, .tables = {QualityTable(bench.results)}, .pictures = {}});
  page.sections.push_back(PictureSection(bench.results));
  return bench;
}

}  // namespace skyquilt::bench
