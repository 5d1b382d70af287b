#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "bench/study/priors_parts.h"
#include "bench/study/study_tables.h"
#include "core/page/bar_chart.h"
#include "evaluate/metrics/metrics.h"

namespace skyquilt::bench {
namespace {

constexpr int kPercentDecimals = 1;
constexpr const char* kPsnr = "PSNR";
constexpr const char* kCommonPsnr = "PSNR, common";

double OfClass(const VariantResult& result, const char* name, double evaluate::metrics::ClassScore::*figure) {
  const auto at =
      std::find_if(result.classes.begin(), result.classes.end(), [name](const evaluate::metrics::ClassScore& c) { return c.name == name; });
  return at == result.classes.end() ? VariantResult::kNone : (*at).*figure;
}

PriorFigure DepthOf(const char* title, const char* name) {
  return {title, "m", 3, ChangeKind::kPercent,
          [name](const VariantResult& r) { return OfClass(r, name, &evaluate::metrics::ClassScore::depth_nmad_m); }};
}

PriorFigure NormalsOf(const char* title, const char* name) {
  return {title, "\xC2\xB0", 1, ChangeKind::kDifference,
          [name](const VariantResult& r) { return OfClass(r, name, &evaluate::metrics::ClassScore::normal_median_deg); }};
}

// Mean over the blocks.
double StepsOfBlocks(const VariantResult& result) {
  double steps = 0.0;
  int blocks = 0;
  for (const VariantField& field : result.fields) {
    if (field.name == "context") continue;
    steps += static_cast<double>(field.steps);
    ++blocks;
  }
  return blocks == 0 ? VariantResult::kNone : steps / blocks;
}

bool MeasuredInAny(const std::vector<PriorResults>& results, const PriorFigure& figure) {
  return std::any_of(results.begin(), results.end(), [&](const PriorResults& r) { return std::isfinite(MedianOverSeeds(r, figure)); });
}

// The unit as the change of the figure has it, with a space in front where there is one.
std::string UnitOfChange(const PriorFigure& figure) {
  if (figure.change == ChangeKind::kPercent) return " %";
  return figure.unit.empty() || figure.unit == "\xC2\xB0" ? figure.unit : " " + figure.unit;
}

int DecimalsOfChange(const PriorFigure& figure) {
  return figure.change == ChangeKind::kPercent ? kPercentDecimals : figure.decimals;
}

// "-12.3 % (-15.0 to -9.6)"; an en dash when nothing was measured.
BenchCell ChangeCell(const PriorChange& change, const PriorFigure& figure) {
  const double median = change.difference.median;
  if (std::isnan(median)) return BenchCell::Number(median, 0);
  const int decimals = DecimalsOfChange(figure);
  std::string shown = Signed(median, decimals) + UnitOfChange(figure);
  if (change.difference.pairs > 1) shown += fmt::format(" ({} to {})", Signed(change.lowest, decimals), Signed(change.highest, decimals));
  return {std::move(shown), median};
}

std::string WithFailures(const PriorResults& results) {
  std::string text = results.label;
  for (const VariantResult& r : results.seeds) {
    if (!r.failure.empty()) text += " (" + r.failure + ")";
  }
  return text;
}

double Change(double before, double after, ChangeKind kind) {
  if (kind == ChangeKind::kDifference) return after - before;
  return before != 0.0 ? 100.0 * (after / before - 1.0) : VariantResult::kNone;
}

}  // namespace

std::string ComparedPsnr(const std::vector<PriorResults>& results) {
  return std::any_of(results.begin(), results.end(),
                     [](const PriorResults& r) {
                       return std::any_of(r.seeds.begin(), r.seeds.end(),
                                          [](const VariantResult& seed) { return std::isfinite(seed.psnr_common_db); });
                     })
             ? kCommonPsnr
             : kPsnr;
}

const std::vector<PriorFigure>& PriorFigures() {
  using R = const VariantResult&;
  static const std::vector<PriorFigure> kFigures = {
      {"steps", "", 0, ChangeKind::kPercent, StepsOfBlocks},
      {"training", "s", 1, ChangeKind::kNone, [](R r) { return r.train_seconds; }},
      {kPsnr, "dB", 2, ChangeKind::kDifference, [](R r) { return r.psnr_db; }},
      {kCommonPsnr, "dB", 2, ChangeKind::kDifference, [](R r) { return r.psnr_common_db; }},
      {"SSIM", "", 4, ChangeKind::kDifference, [](R r) { return r.ssim; }},
      {"FLIP", "", 4, ChangeKind::kDifference, [](R r) { return r.flip; }},
      DepthOf("roofs, NMAD", "roof"),
      DepthOf("ground, NMAD", "ground"),
      DepthOf("walls, NMAD", "wall"),
      DepthOf("trees, NMAD", "tree"),
      NormalsOf("roofs, normals", "roof"),
      NormalsOf("walls, normals", "wall"),
      NormalsOf("ground, normals", "ground"),
      {"flat roofs, rms", "m", 3, ChangeKind::kPercent, [](R r) { return r.flat_roof_rms_m; }},
      {"flat roofs, NMAD", "m", 3, ChangeKind::kPercent, [](R r) { return r.flat_roof_nmad_m; }},
      {"kept points, median", "GSD", 2, ChangeKind::kDifference, [](R r) { return r.kept_median_gsd; }},
      {"kept points, NMAD", "GSD", 2, ChangeKind::kPercent, [](R r) { return r.kept_nmad_gsd; }},
  };
  return kFigures;
}

double MedianOverSeeds(const PriorResults& results, const PriorFigure& figure) {
  std::vector<double> values;
  for (const VariantResult& r : results.seeds) {
    if (const double value = figure.value(r); std::isfinite(value)) values.push_back(value);
  }
  return evaluate::MedianOfMeasured(std::move(values));
}

PriorChange ChangeOf(const PriorResults& before, const PriorResults& after, const PriorFigure& figure) {
  PriorChange change;
  if (figure.change == ChangeKind::kNone) return change;
  std::vector<double> each;
  for (size_t seed = 0; seed < std::min(before.seeds.size(), after.seeds.size()); ++seed) {
    const double from = figure.value(before.seeds[seed]), to = figure.value(after.seeds[seed]);
    const double own = Change(from, to, figure.change);
    if (!std::isfinite(own)) continue;
    each.push_back(own);
    // std::fmin ignores NaN.
    change.lowest = std::fmin(change.lowest, own);
    change.highest = std::fmax(change.highest, own);
  }
  const bool noise_known = figure.title == kPsnr || figure.title == kCommonPsnr;
  change.difference = DifferenceOf(std::move(each), noise_known ? kNoise_db : VariantResult::kNone);
  return change;
}

BenchTable PriorTable(const std::vector<PriorResults>& results, const std::string& name) {
  BenchTable table{.name = name,
                   .title = "",
                   .note =
                       "Medians over the seeds. Steps: mean over blocks. PSNR, SSIM and FLIP over the pixels of held-out photos that at least two "
                       "training photos see; common: over those where this is so for all variants of the seed. NMAD: spread of the depth error, "
                       "1.4826 times the median distance from its median. Normals: median "
                       "angle to the true surface. Flat roofs: rms about the plane that fits best. Kept points: depth at sparse points that were "
                       "kept from training, in ground sampling distances.",
                   .columns = {"variant"},
                   .rows = {}};
  for (const PriorResults& r : results) table.rows.push_back({BenchCell::Text(WithFailures(r))});
  for (const PriorFigure& figure : PriorFigures()) {
    if (!MeasuredInAny(results, figure)) continue;
    table.columns.push_back(figure.title);
    for (size_t i = 0; i < results.size(); ++i) {
      table.rows[i].push_back(BenchCell::Number(MedianOverSeeds(results[i], figure), figure.decimals, figure.unit));
    }
  }
  return table;
}

BenchTable PriorChangeTable(const std::vector<PriorResults>& results, const std::string& name) {
  BenchTable table{.name = name,
                   .title = "Change against no priors",
                   .note = "Median over those seeds in which both were measured; in parentheses the range over seeds.",
                   .columns = {"variant"},
                   .rows = {}};
  for (size_t i = 1; i < results.size(); ++i) table.rows.push_back({BenchCell::Text(results[i].label)});
  for (const PriorFigure& figure : PriorFigures()) {
    if (figure.change == ChangeKind::kNone || !MeasuredInAny(results, figure)) continue;
    table.columns.push_back(figure.title);
    for (size_t i = 1; i < results.size(); ++i) table.rows[i - 1].push_back(ChangeCell(ChangeOf(results.front(), results[i], figure), figure));
  }
  return table;
}

BenchTable PriorTrainingTable(const std::vector<PriorResults>& results, const std::string& name) {
  BenchTable table{.name = name, .title = "", .note = "", .columns = {"training"}, .rows = {}};
  for (const PriorResults& of_variant : results) {
    for (const VariantResult& r : of_variant.seeds) {
      table.rows.push_back({BenchCell::Text(r.failure.empty() ? r.label : r.label + " (" + r.failure + ")")});
    }
  }
  for (const PriorFigure& figure : PriorFigures()) {
    if (!MeasuredInAny(results, figure)) continue;
    table.columns.push_back(figure.title);
    size_t row = 0;
    for (const PriorResults& of_variant : results) {
      for (const VariantResult& r : of_variant.seeds) {
        table.rows[row++].push_back(BenchCell::Number(figure.value(r), figure.decimals, figure.unit));
      }
    }
  }
  return table;
}

std::vector<std::string> PriorCharts(const std::vector<PriorResults>& results) {
  std::vector<std::string> charts;
  for (const PriorFigure& figure : PriorFigures()) {
    if (!figure.title.ends_with(", NMAD")) continue;
    std::vector<page::Bar> bars;
    for (size_t i = 1; i < results.size(); ++i) {
      const double change = ChangeOf(results.front(), results[i], figure).difference.median;
      page::Bar bar{.label = results[i].label, .value = 100.0 + change, .limit = 100.0, .limit_shown = "100 %"};
      if (std::isfinite(change)) bar.shown = Signed(change, kPercentDecimals) + " %";
      bars.push_back(std::move(bar));
    }
    if (std::none_of(bars.begin(), bars.end(), [](const page::Bar& bar) { return std::isfinite(bar.value); })) continue;
    charts.push_back(page::BarChart(
        bars, {.title = figure.title, .x_label = "percent of training without priors", .value_name = "with priors", .limit_name = "without"}));
  }
  return charts;
}

std::vector<std::string> PriorVerdicts(const std::vector<PriorResults>& results) {
  std::vector<std::string> verdicts;
  bool noise_unknown = false;
  for (size_t i = 1; i < results.size(); ++i) {
    std::string text;
    for (const PriorFigure& figure : PriorFigures()) {
      const Difference change = ChangeOf(results.front(), results[i], figure).difference;
      const bool told = figure.change == ChangeKind::kPercent || figure.title == ComparedPsnr(results);
      if (!told || change.pairs == 0) continue;
      text += fmt::format("{}{} {}", text.empty() ? "" : "; ", figure.title, Shown(change, DecimalsOfChange(figure), UnitOfChange(figure)));
      noise_unknown |= std::isnan(change.noise);
    }
    if (!text.empty()) verdicts.push_back(fmt::format("'{}' against '{}': {}.", results[i].label, results.front().label, text));
  }
  if (noise_unknown) verdicts.emplace_back("Three seeds or more would tell which changes in percent are larger than those of equal trainings.");
  return verdicts;
}

}  // namespace skyquilt::bench
