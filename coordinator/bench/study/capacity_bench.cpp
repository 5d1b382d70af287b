#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "coordinator/bench/study/study_benches.h"
#include "coordinator/bench/study/study_tables.h"
#include "coordinator/report/curve_chart.h"

namespace skyquilt::coordinator {
namespace {

constexpr double kAimShare = 0.5, kAimLoss_db = 0.1;

// Largest table of any block.
int LargestTable(const VariantResult& result) {
  int largest = 0;
  for (const VariantField& field : result.fields) largest = std::max(largest, field.log2_table_size);
  return largest;
}

// What was trained and what the scene keeps, field by field.
BenchTable FieldTable(const VariantResult& result) {
  BenchTable table{.name = "fields",
                   .title = result.label,
                   .note = "A scene keeps the entries that some occupied cell reads: pictures are the same to the bit.",
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

std::string AgainstUniform(const VariantResult& fitted, const VariantResult& uniform) {
  const double share = 1.0 - fitted.scene_parameters / uniform.parameters;
  const double change_db = fitted.psnr_db - uniform.psnr_db;
  const double bytes = 1.0 - fitted.scene_bytes / uniform.scene_bytes;
  return fmt::format(
      "Against {}: {:.0f} % fewer parameters in the scene than that trained ({:.2f} M against {:.2f} M; its file is {:.0f} % smaller than that "
      "one's, "
      "which leaves out unread entries too), PSNR {:+.2f} dB. The aim, {:.0f} % fewer at a loss of at most {:g} dB, is {}.",
      uniform.label, 100.0 * share, fitted.scene_parameters / 1e6, uniform.parameters / 1e6, 100.0 * bytes, change_db, 100.0 * kAimShare, kAimLoss_db,
      share >= kAimShare && change_db >= -kAimLoss_db ? "met" : "missed");
}

}  // namespace

StudyBench CapacityBench(Study& study, const CapacityOptions& options) {
  StudyBench bench;
  const Override budget = {"run.time_budget_s", fmt::format("{}", options.budget_s)};
  std::vector<Override> first = {budget};
  if (!options.blocks.empty()) first.push_back({"partition.blocks", options.blocks});
  const VariantResult fitted = study.Run({.name = "fitted", .label = "fitted to each block", .overrides = first});
  bench.results.push_back(fitted);
  // Other tables would make automatic partition cut other blocks.
  const std::string layout = fitted.layout.empty() ? study.settings().partition.blocks : fitted.layout;
  report::Curve curve{.name = "the same for all blocks", .points = {}, .marks = true};
  for (const int log2 : options.log2_table_sizes) {
    const std::string size = std::to_string(log2);
    bench.results.push_back(study.Run(
        {.name = "uniform_" + size,
         .label = "2^" + size + " for all blocks",
         .overrides = {budget, {"partition.blocks", layout}, {"partition.min_log2_table_size", size}, {"partition.max_log2_table_size", size}}}));
    curve.points.emplace_back(bench.results.back().parameters, bench.results.back().psnr_db);
  }
  BenchPage& page = bench.page;
  page.name = "capacity";
  page.title = "Only what a scene requires";
  page.lead = fmt::format(
      "Each block's tables as large as its ground sampling distance, its area and the roughness of its surface ask for, against one size for all. "
      "{:.0f} s of training for every variant.",
      options.budget_s);
  const int largest = LargestTable(fitted);
  for (size_t i = 1; i < bench.results.size(); ++i) {
    const VariantResult& uniform = bench.results[i];
    if (!fitted.failure.empty() || !uniform.failure.empty()) continue;
    if (options.log2_table_sizes[i - 1] >= largest) page.verdicts.push_back(AgainstUniform(fitted, uniform));
    if (options.log2_table_sizes[i - 1] != largest) continue;
    page.figures.push_back({"Parameters", fmt::format("{:+.0f} %", 100.0 * (fitted.scene_parameters / uniform.parameters - 1.0)),
                            "against the largest block's tables for all"});
    page.figures.push_back({"PSNR", fmt::format("{:+.2f} dB", fitted.psnr_db - uniform.psnr_db), "at equal training time"});
  }
  if (fitted.failure.empty()) {
    page.figures.push_back({"Left out after training", fmt::format("{:.0f} %", 100.0 * (1.0 - fitted.scene_parameters / fitted.parameters)),
                            "entries that nothing reads; changes no pixel"});
  }
  const report::Curve own{
      .name = "fitted, trained", .points = {{fitted.parameters, fitted.psnr_db}}, .emphasised = true, .line = false, .marks = true};
  const report::Curve kept{.name = "fitted, in the scene", .points = {{fitted.scene_parameters, fitted.psnr_db}}, .line = false, .marks = true};
  page.sections.push_back(
      {.id = "quality",
       .title = "Quality for size",
       .lead = "",
       .charts = {report::CurveChart({curve, own, kept},
                                     {.title = "PSNR by parameters", .x_label = "parameters of all fields", .y_label = "PSNR (dB)", .log_x = true})},
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

}  // namespace skyquilt::coordinator
