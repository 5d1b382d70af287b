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

constexpr double kAimShare = 0.5, kAimLoss_db = 0.1;

// Largest table of any block.
int LargestTable(const VariantResult& result) {
  int largest = 0;
  for (const VariantField& field : result.fields) largest = std::max(largest, field.log2_table_size);
  return largest;
}

// Trained parameters and parameters stored in the scene, for each field.
BenchTable FieldTable(const VariantResult& result) {
  BenchTable table{.name = "fields",
                   .title = result.label,
                   .note = "A scene stores only table entries that an occupied cell reads. Rendered images stay bit-identical.",
                   .columns = {"field", "entries per level", "trained", "in the scene", "left out", "PSNR"},
                   .rows = {}};
  for (const VariantField& field : result.fields) {
    const double share = 1.0 - static_cast<double>(field.scene_parameters) / static_cast<double>(field.parameters);
    table.rows.push_back({BenchCell::Text(field.name),
                          field.log2_table_size > 0 ? BenchCell{fmt::format("2^{}", field.log2_table_size), std::exp2(field.log2_table_size)}
                                                    : BenchCell::Text("\xE2\x80\x93"),
                          BenchCell::Count(static_cast<double>(field.parameters)), BenchCell::Count(static_cast<double>(field.scene_parameters)),
                          BenchCell::Percent(share), BenchCell::Number(field.psnr_db, 2, "dB")});
  }
  return table;
}

const char* TargetReached(double share, const Difference& change) {
  if (share < kAimShare) return "missed";
  if (change.median >= -kAimLoss_db) return "met";
  return change.seen ? "missed" : "open, as the loss is within the noise";
}

std::string AgainstLarger(const VariantResult& fitted, const VariantResult& other) {
  const double share = 1.0 - fitted.scene_parameters / other.parameters;
  const Difference change = PsnrDifference(fitted, other);
  const double bytes = 1.0 - fitted.scene_bytes / other.scene_bytes;
  return fmt::format(
      "Compared with {}: the scene has {:.0f} % fewer parameters than that variant trained ({:.2f} M and {:.2f} M; the scene file is {:.0f} % "
      "smaller, "
      "and both files leave out unread entries), PSNR {}. The target of {:.0f} % fewer parameters at a loss of at most {:g} dB is {}.",
      other.label, 100.0 * share, fitted.scene_parameters / 1e6, other.parameters / 1e6, 100.0 * bytes, Shown(change), 100.0 * kAimShare, kAimLoss_db,
      TargetReached(share, change));
}

std::string Even(const VariantResult& fitted, const VariantResult& leaner) {
  return fmt::format("{}: {:.0f} % of the fitted scene's parameters ({:.2f} M), PSNR {}.", leaner.label,
                     100.0 * leaner.scene_parameters / fitted.scene_parameters, leaner.scene_parameters / 1e6, Shown(PsnrDifference(leaner, fitted)));
}

page::Curve Points(const std::string& name, const std::vector<VariantResult>& results) {
  page::Curve curve{.name = name, .points = {}, .marks = true};
  for (const VariantResult& r : results) curve.points.emplace_back(r.scene_parameters, r.psnr_db);
  std::sort(curve.points.begin(), curve.points.end());
  return curve;
}

}  // namespace

StudyBench CapacityBench(Study& study, const CapacityOptions& options) {
  const config::Override budget = {"run.time_budget_s", fmt::format("{}", options.budget_s)};
  std::vector<config::Override> own = {budget};
  if (!options.blocks.empty()) own.push_back({"partition.blocks", options.blocks});
  VariantResult fitted = study.Run({.name = "fitted", .label = "fitted to each block", .overrides = own});
  // The blocks are fixed, because automatic partition would make other blocks for other tables.
  const std::string layout = fitted.layout.empty() ? study.settings().partition.blocks : fitted.layout;
  std::vector<VariantResult> uniform, shared, cut;
  for (const int log2 : options.log2_table_sizes) {
    const std::string size = std::to_string(log2);
    uniform.push_back(study.Run(
        {.name = "uniform_" + size,
         .label = "2^" + size + " for all blocks",
         .overrides = {budget, {"partition.blocks", layout}, {"partition.min_log2_table_size", size}, {"partition.max_log2_table_size", size}}}));
  }
  const partition::PartitionOptions& partition = study.settings().partition;
  for (const double load : options.voxels_per_entry) {
    if (load == partition.voxels_per_entry) continue;
    shared.push_back(study.Run({.name = "shared_" + NumberInName(load),
                                .label = fmt::format("{:g} voxels per entry", load),
                                .overrides = {budget, {"partition.blocks", layout}, {"partition.voxels_per_entry", fmt::format("{}", load)}}}));
  }
  if (options.blocks.empty() && partition.blocks == "auto" && partition.max_voxels_per_entry > 1.0) {
    cut.push_back(study.Run(
        {.name = "small_blocks", .label = "blocks cut until no entry is shared", .overrides = {budget, {"partition.max_voxels_per_entry", "1"}}}));
  }
  std::vector<VariantResult*> all = {&fitted};
  for (auto* group : {&uniform, &shared, &cut}) {
    for (VariantResult& result : *group) all.push_back(&result);
  }
  ScoreCommonPixels(study.folder(), all);

  StudyBench bench;
  bench.results = {fitted};
  for (const auto* group : {&uniform, &shared, &cut}) bench.results.insert(bench.results.end(), group->begin(), group->end());
  BenchPage& page = bench.page;
  page.name = "capacity";
  page.title = "Table sizes chosen per block";
  page.lead = fmt::format(
      "Compares table sizes chosen from each block's ground sampling distance, area and roughness ({:g} finest surface voxels per entry) with one "
      "size "
      "for all blocks, and with more and fewer voxels per entry. {:.0f} s of training for every variant.",
      partition.voxels_per_entry, options.budget_s);
  const int largest = LargestTable(fitted);
  for (size_t i = 0; i < uniform.size(); ++i) {
    const VariantResult& same = uniform[i];
    if (!fitted.failure.empty() || !same.failure.empty() || options.log2_table_sizes[i] < largest) continue;
    page.verdicts.push_back(AgainstLarger(fitted, same));
    if (options.log2_table_sizes[i] != largest) continue;
    page.figures.push_back({"Parameters", Signed(100.0 * (fitted.scene_parameters / same.parameters - 1.0), 0) + " %",
                            "compared with the largest block's table size for all blocks"});
    page.figures.push_back(DifferenceFigure("PSNR", PsnrDifference(fitted, same), "at equal training time"));
  }
  for (const auto* group : {&shared, &cut}) {
    for (const VariantResult& other : *group) {
      if (!fitted.failure.empty() || !other.failure.empty()) continue;
      page.verdicts.push_back(other.scene_parameters > fitted.scene_parameters ? AgainstLarger(fitted, other) : Even(fitted, other));
    }
  }
  if (fitted.failure.empty()) {
    page.figures.push_back({"Left out after training", fmt::format("{:.0f} %", 100.0 * (1.0 - fitted.scene_parameters / fitted.parameters)),
                            "entries that no occupied cell reads; changes no pixel"});
  }
  const page::Curve here{.name = "fitted", .points = {{fitted.scene_parameters, fitted.psnr_db}}, .emphasised = true, .line = false, .marks = true};
  page.sections.push_back(
      {.id = "quality",
       .title = "Quality and size",
       .lead = "",
       .charts = {page::CurveChart(
           {Points("one size for all blocks", uniform), Points("other voxels per entry", shared), Points("smaller blocks", cut), here},
           {.title = "PSNR by parameters", .x_label = "parameters in the scene", .y_label = "PSNR (dB)", .log_x = true})},
       .tables = {QualityTable(bench.results)},
       .pictures = {}});
  page.sections.push_back({.id = "fields",
                           .title = "Field by field",
                           .lead = "",
                           .charts = {},
                           .tables = {FieldTable(fitted), BlockTable(bench.results, "blocks")},
                           .pictures = {}});
  page.sections.push_back(PictureSection(bench.results));
  return bench;
}

}  // namespace skyquilt::bench
