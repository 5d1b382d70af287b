#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "bench/study/study_benches.h"
#include "bench/study/study_tables.h"

namespace skyquilt::bench {
namespace {

double StepsOfBlock(const VariantResult& result) {
  for (const VariantField& field : result.fields) {
    if (field.name != "context") return static_cast<double>(field.steps);
  }
  return VariantResult::kNone;
}

BenchTable RowsAsPublished(const std::vector<VariantResult>& results) {
  BenchTable table{
      .name = "",
      .title = "Held-out pictures, whole frames",
      .note =
          "Means over the pictures of the published split. PSNR and SSIM (Gaussian window of 11, sigma 1.5, data range 1) of display values, "
          "8 bits, over all pixels that are not masked.",
      .columns = {"method", "PSNR", "SSIM"},
      .rows = {}};
  const bool lpips = std::any_of(results.begin(), results.end(), [](const VariantResult& r) { return std::isfinite(r.lpips); });
  if (lpips) table.columns.emplace_back("LPIPS");
  table.columns.insert(table.columns.end(), {"trained on", "steps", "training", "parameters"});
  for (const VariantResult& r : results) {
    std::vector<BenchCell> row = {BenchCell::Text(r.label), BenchCell::Number(r.psnr_full_db, 2, "dB"), BenchCell::Number(r.ssim_full, 3)};
    if (lpips) row.push_back(BenchCell::Number(r.lpips, 3));
    row.insert(row.end(), {BenchCell::Number(r.training_photos, 0), BenchCell::Number(StepsOfBlock(r), 0), BenchCell::Seconds(r.train_seconds),
                           BenchCell::Count(r.parameters)});
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

StudyBench DataSetBench(Study& study, const DataSetOptions& options) {
  study.UseSeeds(options.seeds);
  StudyBench bench;
  for (const StudiedPreset& method : options.methods) {
    Variant variant{.name = method.name, .label = method.name, .overrides = method.overrides};
    variant.overrides.push_back({"partition.blocks", "1x1"});
    if (options.budget_s > 0.0) variant.overrides.push_back({"run.time_budget_s", fmt::format("{}", options.budget_s)});
    bench.results.push_back(study.Run(variant));
  }
  const auto held_out = std::count_if(study.survey().photos.begin(), study.survey().photos.end(), [](const survey::Photo& p) { return p.is_test; });
  BenchPage& page = bench.page;
  page.name = "methods";
  page.title = "Methods on " + options.data_set;
  page.lead = fmt::format(
      "Published methods as this program can train them (configs/methods), each as one field, on {} of {} pictures of a scene in the form "
      "of {}, scored on the {} pictures that its split holds out.",
      study.survey().photos.size() - static_cast<size_t>(held_out), study.survey().photos.size(), options.data_set, held_out);
  const VariantResult* best = nullptr;
  for (const VariantResult& result : bench.results) {
    if (std::isfinite(result.psnr_full_db) && (best == nullptr || result.psnr_full_db > best->psnr_full_db)) best = &result;
  }
  if (best != nullptr) page.figures.push_back({"Best", fmt::format("{:.2f} dB", best->psnr_full_db), best->label});
  page.sections.push_back({.id = "methods",
                           .title = "As published",
                           .lead = "",
                           .charts = {TrainingChart(bench.results)},
                           .tables = {RowsAsPublished(bench.results), QualityTable(bench.results, "cost")},
                           .pictures = {}});
  page.sections.push_back(PictureSection(bench.results));
  return bench;
}

}  // namespace skyquilt::bench
