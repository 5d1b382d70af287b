#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "bench/study/buildings_parts.h"
#include "bench/study/study_tables.h"
#include "core/page/bar_chart.h"

namespace skyquilt::bench {
namespace {

using evaluate::buildings::BuildingErrors;

constexpr double kLargeFrom_m2 = 50.0;
constexpr double kAny_m2 = std::numeric_limits<double>::infinity();
constexpr int kMeasureDecimals = 3;

struct PooledSize {
  const char* name;
  double from_m2, to_m2;
};
// Invented buildings may be smaller than outlines that count; they are in the first.
constexpr std::array<PooledSize, 3> kPooledSizes = {
    {{"all", 0.0, kAny_m2}, {"10 to 50 m\xC2\xB2", 0.0, kLargeFrom_m2}, {"over 50 m\xC2\xB2", kLargeFrom_m2, kAny_m2}}};

BuildingPool LargeOf(const BuildingPool& pool) {
  return OfSize(pool, kLargeFrom_m2, kAny_m2);
}

BenchCell ShareCell(const PooledFigure& share) {
  if (!std::isfinite(share.value)) return BenchCell::Percent(VariantResult::kNone);
  if (!std::isfinite(share.low)) return BenchCell::Percent(share.value);
  return {fmt::format("{:.1f} % ({:.1f} to {:.1f})", 100.0 * share.value, 100.0 * share.low, 100.0 * share.high), share.value};
}

BenchCell ErrorCell(const PooledFigure& error, const std::string& unit) {
  if (!std::isfinite(error.value) || !std::isfinite(error.low)) return BenchCell::Number(error.value, kMeasureDecimals, unit);
  return {fmt::format("{:.3f} ({:.3f} to {:.3f}) {}", error.value, error.low, error.high, unit), error.value};
}

PooledFigure RmseOf(const BuildingPool& pool, const std::string& measure, bool in_gsd = false) {
  return Bootstrap(WithMeasure(pool, measure), [&](const BuildingPool& drawn) { return PooledErrors(drawn, measure, in_gsd).rmse; });
}

BenchCell Whole(int64_t count) {
  return {std::to_string(count), static_cast<double>(count)};
}

// Removes columns without any number but the first ones.
void RemoveEmptyColumns(size_t texts, BenchTable* table) {
  for (size_t c = table->columns.size(); c-- > texts;) {
    if (std::any_of(table->rows.begin(), table->rows.end(), [c](const auto& row) { return std::isfinite(row[c].value); })) continue;
    table->columns.erase(table->columns.begin() + static_cast<std::ptrdiff_t>(c));
    for (auto& row : table->rows) row.erase(row.begin() + static_cast<std::ptrdiff_t>(c));
  }
}

// What the program wants to reach.
struct ErrorTarget {
  const char* measure;
  double limit;      // RMSE
  double without;    // without oblique photos
  const char* unit;  // "GSD" or of the measure
};
constexpr std::array<ErrorTarget, 6> kTargets = {{{"deck", 0.15, 0.15, "m"},
                                                  {"eave", 0.20, 0.20, "m"},
                                                  {"ridge", 0.20, 0.20, "m"},
                                                  {"length", 1.0, 2.0, "GSD"},
                                                  {"width", 1.0, 2.0, "GSD"},
                                                  {"yaw", 1.0, 1.0, "degrees"}}};
constexpr double kShareTarget = 0.95;
constexpr double kWithinLow = 0.90, kWithinHigh = 0.99;

std::string VerdictOf(const BuildingsResults& of, const BuildingPool& pool) {
  const BuildingPool large = LargeOf(pool);
  std::string met, failed;
  const auto tell = [&](bool ok, const std::string& text) {
    std::string& list = ok ? met : failed;
    list += (list.empty() ? "" : "; ") + text;
  };
  for (const auto& [name, share] : {std::pair{"completeness", Completeness(large)}, {"correctness", Correctness(large)}}) {
    if (std::isfinite(share)) tell(share >= kShareTarget, fmt::format("{} over 50 m\xC2\xB2 {:.1f} %", name, 100.0 * share));
  }
  for (const ErrorTarget& target : kTargets) {
    const bool in_gsd = std::string_view(target.unit) == "GSD";
    const double rmse = PooledErrors(pool, target.measure, in_gsd).rmse;
    if (std::isfinite(rmse)) {
      tell(rmse <= (of.obliques ? target.limit : target.without), fmt::format("{} RMSE {:.2f} {}", target.measure, rmse, target.unit));
    }
  }
  if (const double within = WithinSigma(pool); std::isfinite(within)) {
    tell(within >= kWithinLow && within <= kWithinHigh, fmt::format("{:.1f} % of errors within 1.96 sigma", 100.0 * within));
  }
  std::string text = fmt::format("'{}'", of.label);
  text += met.empty() ? " reaches no target" : " reaches: " + met;
  return text + (failed.empty() ? "." : ". Not: " + failed + ".");
}

}  // namespace

BenchTable BuildingsTable(const std::vector<BuildingsResults>& results, const std::string& name) {
  BenchTable table{.name = name,
                   .title = "",
                   .note =
                       "Buildings of all towns together; in parentheses the interval of 95 % of the samples that were drawn anew from them "
                       "(bootstrap over buildings). A building is found when its footprint and an outline overlap by at least half of their union. "
                       "Completeness: found of the true ones; correctness: true of the found ones. Within 1.96 sigma: share of the errors of all "
                       "measures, 95 % when the stated uncertainties are right.",
                   .columns = {"variant", "outlines", "completeness", "completeness over 50 m\xC2\xB2", "correctness",
                               "correctness over 50 m\xC2\xB2", "quality", "kind of roof right", "within 1.96 sigma"},
                   .rows = {}};
  for (const BuildingsResults& of : results) {
    const BuildingPool pool = PoolBuildings(of.towns), large = LargeOf(pool);
    std::string label = of.label;
    for (const VariantResult& town : of.towns) {
      if (!town.failure.empty()) label += " (" + town.failure + ")";
    }
    table.rows.push_back({BenchCell::Text(label), Whole(Count(pool).Outlines()), ShareCell(Bootstrap(pool, Completeness)),
                          ShareCell(Bootstrap(large, Completeness)), ShareCell(Bootstrap(pool, Correctness)),
                          ShareCell(Bootstrap(large, Correctness)), ShareCell(Bootstrap(pool, Quality)), ShareCell(Bootstrap(pool, RoofKindRight)),
                          ShareCell(Bootstrap(pool, WithinSigma))});
  }
  return table;
}

BenchTable BuildingsSizeTable(const std::vector<BuildingsResults>& results, const std::string& name) {
  BenchTable table{.name = name,
                   .title = "By size",
                   .note = "",
                   .columns = {"variant", "size", "outlines", "found", "missed", "invented", "completeness", "correctness", "quality"},
                   .rows = {}};
  for (const BuildingsResults& of : results) {
    const BuildingPool pool = PoolBuildings(of.towns);
    for (const PooledSize& size : kPooledSizes) {
      const BuildingPool part = OfSize(pool, size.from_m2, size.to_m2);
      const PooledCounts counts = Count(part);
      table.rows.push_back({BenchCell::Text(of.label), BenchCell::Text(size.name), Whole(counts.Outlines()), Whole(counts.matched),
                            Whole(counts.missed), Whole(counts.invented), ShareCell(Bootstrap(part, Completeness)),
                            ShareCell(Bootstrap(part, Correctness)), ShareCell(Bootstrap(part, Quality))});
    }
  }
  return table;
}

BenchTable BuildingsMeasureTable(const std::vector<BuildingsResults>& results, const std::string& name) {
  BenchTable table{
      .name = name,
      .title = "Errors of measures",
      .note =
          "Found minus true, of all buildings that were found, of all towns together. Deck: of flat roofs; eave and ridge: of pitched ones. "
          "NMAD: 1.4826 times the median distance from the median. 90th percentile: of the sizes of errors. GSD: ground sampling distance "
          "of the town.",
      .columns = {"measure", "variant", "n", "bias", "RMSE", "RMSE in GSD", "NMAD", "90th percentile", "within 1.96 sigma"},
      .rows = {}};
  for (const char* measure : PooledMeasures()) {
    for (const BuildingsResults& of : results) {
      const BuildingPool pool = WithMeasure(PoolBuildings(of.towns), measure);
      if (pool.empty()) continue;
      const BuildingErrors errors = PooledErrors(pool, measure);
      const std::string unit = UnitOfMeasure(measure);
      const auto within = [&](const BuildingPool& drawn) { return PooledErrors(drawn, measure).within_sigma; };
      table.rows.push_back(
          {BenchCell::Text(measure),
           BenchCell::Text(of.label),
           Whole(errors.n),
           {Signed(errors.bias, kMeasureDecimals) + " " + unit, errors.bias},
           ErrorCell(RmseOf(pool, measure), unit),
           IsLength(measure) ? BenchCell::Number(PooledErrors(pool, measure, true).rmse, 2) : BenchCell::Number(VariantResult::kNone, 0),
           BenchCell::Number(errors.nmad, kMeasureDecimals, unit),
           BenchCell::Number(errors.p90_abs, kMeasureDecimals, unit),
           ShareCell(Bootstrap(pool, within))});
    }
  }
  return table;
}

BenchTable BuildingsTownTable(const std::vector<BuildingsResults>& results, const std::string& name) {
  BenchTable table{.name = name,
                   .title = "",
                   .note = "",
                   .columns = {"variant and town", "outlines", "found", "missed", "invented", "completeness", "correctness", "GSD", "deck RMSE",
                               "eave RMSE", "ridge RMSE", "length RMSE", "width RMSE", "PSNR", "PSNR, common", "training"},
                   .rows = {}};
  for (const BuildingsResults& of : results) {
    for (const VariantResult& town : of.towns) {
      const BuildingPool pool = PoolBuildings({&town, 1});
      const PooledCounts counts = Count(pool);
      std::vector<BenchCell> row = {BenchCell::Text(town.failure.empty() ? town.label : town.label + " (" + town.failure + ")"),
                                    Whole(counts.Outlines()),
                                    Whole(counts.matched),
                                    Whole(counts.missed),
                                    Whole(counts.invented),
                                    BenchCell::Percent(Completeness(pool)),
                                    BenchCell::Percent(Correctness(pool)),
                                    BenchCell::Number(town.buildings ? town.buildings->gsd_m : VariantResult::kNone, kMeasureDecimals, "m")};
      for (const char* measure : {"deck", "eave", "ridge", "length", "width"}) {
        row.push_back(BenchCell::Number(PooledErrors(pool, measure).rmse, kMeasureDecimals, "m"));
      }
      row.push_back(BenchCell::Number(town.psnr_db, 2, "dB"));
      row.push_back(BenchCell::Number(town.psnr_common_db, 2, "dB"));
      row.push_back(BenchCell::Seconds(town.train_seconds));
      table.rows.push_back(std::move(row));
    }
  }
  RemoveEmptyColumns(1, &table);
  return table;
}

std::vector<std::string> BuildingsCharts(const std::vector<BuildingsResults>& results) {
  std::vector<std::string> charts;
  for (const ErrorTarget& target : kTargets) {
    const bool in_gsd = std::string_view(target.unit) == "GSD";
    std::vector<page::Bar> bars;
    for (const BuildingsResults& of : results) {
      const PooledFigure rmse = RmseOf(PoolBuildings(of.towns), target.measure, in_gsd);
      page::Bar bar{.label = of.label, .value = rmse.value, .limit = of.obliques ? target.limit : target.without};
      if (std::isfinite(rmse.low)) bar.shown = fmt::format("{:.2f} ({:.2f} to {:.2f})", rmse.value, rmse.low, rmse.high);
      bars.push_back(std::move(bar));
    }
    if (std::none_of(bars.begin(), bars.end(), [](const page::Bar& bar) { return std::isfinite(bar.value); })) continue;
    charts.push_back(page::BarChart(bars, {.title = target.measure,
                                           .x_label = fmt::format("RMSE, {}", in_gsd ? "ground sampling distances" : target.unit),
                                           .value_name = "measured",
                                           .limit_name = "target"}));
  }
  return charts;
}

std::vector<std::string> BuildingsVerdicts(const std::vector<BuildingsResults>& results) {
  std::vector<std::string> verdicts;
  int64_t most = 0;
  for (const BuildingsResults& of : results) {
    const BuildingPool pool = PoolBuildings(of.towns);
    if (pool.empty()) continue;
    most = std::max(most, Count(pool).Outlines());
    verdicts.push_back(VerdictOf(of, pool));
  }
  constexpr int64_t kEnough = 100;
  if (!verdicts.empty() && most < kEnough) {
    verdicts.push_back(
        fmt::format("There are {} true building(s) in all, too few for sure conclusions: give more --seeds for at least {}.", most, kEnough));
  }
  return verdicts;
}

std::vector<BenchFigure> BuildingsFigures(const std::vector<BuildingsResults>& results) {
  const auto shown = std::find_if(results.begin(), results.end(), [](const BuildingsResults& of) { return of.name == "field"; });
  if (shown == results.end()) return {};
  const BuildingPool pool = PoolBuildings(shown->towns), large = LargeOf(pool);
  if (pool.empty()) return {};
  const std::string note = fmt::format("'{}', {} outlines", shown->label, Count(large).Outlines());
  std::vector<BenchFigure> figures;
  for (const auto& [title, share] : {std::pair{"Completeness over 50 m\xC2\xB2", Completeness(large)}, {"Correctness", Correctness(large)}}) {
    if (std::isfinite(share)) figures.push_back({title, fmt::format("{:.1f} %", 100.0 * share), note});
  }
  for (const ErrorTarget& target : kTargets) {
    const bool in_gsd = std::string_view(target.unit) == "GSD";
    const BuildingErrors errors = PooledErrors(pool, target.measure, in_gsd);
    if (errors.n == 0) continue;
    figures.push_back(
        {fmt::format("{} RMSE", target.measure), fmt::format("{:.2f} {}", errors.rmse, target.unit), fmt::format("of {} buildings", errors.n)});
  }
  return figures;
}

}  // namespace skyquilt::bench
