#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "bench/study/common_pixels.h"
#include "bench/study/compare.h"
#include "bench/study/study_benches.h"
#include "bench/study/study_tables.h"
#include "core/page/curve_chart.h"

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

}  // namespace

StudyBench BlocksBench(Study& study, const BlocksBenchOptions& options) {
  StudyBench bench;
  const std::string budget = fmt::format("{}", options.budget_s);
  BenchTable grid{.name = "psnr",
                  .title = "PSNR by number of blocks and table size",
                  .note = "Columns: entries per level of each block's tables.",
                  .columns = {"blocks"},
                  .rows = {}};
  std::vector<page::Curve> curves;
  for (const int log2 : options.log2_table_sizes) grid.columns.push_back(fmt::format("2^{}", log2));
  for (const int side : options.per_side) {
    std::vector<BenchCell> row = {BenchCell::Text(fmt::format("{0} x {0}", side))};
    for (const int log2 : options.log2_table_sizes) {
      const std::string tables = std::to_string(log2);
      bench.results.push_back(study.Run({.name = fmt::format("{0}x{0}_t{1}", side, log2),
                                         .label = fmt::format("{0} x {0}, 2^{1}", side, log2),
                                         .overrides = {{"partition.blocks", fmt::format("{0}x{0}", side)},
                                                       {"partition.min_log2_table_size", tables},
                                                       {"partition.max_log2_table_size", tables},
                                                       {"run.time_budget_s", budget}}}));
      row.push_back(BenchCell::Number(bench.results.back().psnr_db, 2, "dB"));
    }
    grid.rows.push_back(std::move(row));
  }
  ScoreCommonPixels(study.folder(), PointersTo(bench.results));
  for (size_t c = 0; c < options.log2_table_sizes.size(); ++c) {
    page::Curve curve{.name = fmt::format("2^{}", options.log2_table_sizes[c]), .points = {}, .marks = true};
    for (size_t r = 0; r < options.per_side.size(); ++r)
      curve.points.emplace_back(options.per_side[r] * options.per_side[r], grid.rows[r][c + 1].value);
    curves.push_back(std::move(curve));
  }
  BenchPage& page = bench.page;
  page.name = "blocks";
  page.title = "Number of blocks and table size";
  page.lead =
      fmt::format("Compares numbers of blocks and sizes of each block's tables, with {:.0f} s of training for every variant.", options.budget_s);
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
