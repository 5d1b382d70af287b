#include "bench/study/stability_bench.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "bench/study/common_pixels.h"
#include "bench/study/compare.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/page/bar_chart.h"

namespace skyquilt::bench {
namespace {

constexpr const char* kLow = "height-low";
constexpr const char* kHigh = "height-high";
constexpr const char* kTinyBatch = "batch-256";

std::string Slug(std::string text) {
  std::replace(text.begin(), text.end(), '.', '_');
  return text;
}

SurveyEdit EditNamed(const std::string& extreme) {
  for (const NamedEdit& edit : SurveyEdits()) {
    if (extreme == edit.name) return edit.edit;
  }
  return SurveyEdit::kNone;
}

Variant VariantOf(const StabilityRun& run, const Study& study) {
  Variant variant;
  variant.name =
      Slug(fmt::format("{}{}-s{}-r{:g}-t{:g}", run.extreme.empty() ? "" : run.extreme + "-", run.blocks, run.seed, run.rate, run.budget_s));
  variant.label = fmt::format("{}: {}, {} blocks, seed {}, rate x {:g}, {:g} s", run.survey, run.extreme.empty() ? "as it is" : run.extreme,
                              run.blocks, run.seed, run.rate, run.budget_s);
  variant.edit = EditNamed(run.extreme);
  const coordinator::Settings& settings = study.settings();
  variant.overrides = {{"run.time_budget_s", fmt::format("{}", run.budget_s)},
                       {"run.seed", std::to_string(run.seed)},
                       {"partition.blocks", run.blocks},
                       {"train.learning_rate", fmt::format("{}", run.rate * settings.train.learning_rate)},
                       {"context.learning_rate", fmt::format("{}", run.rate * settings.context.learning_rate)}};
  if (run.extreme == kTinyBatch) {
    variant.overrides.push_back({"train.batch_samples", "256"});
    variant.overrides.push_back({"context.batch_samples", "256"});
  }
  if (run.extreme == kLow || run.extreme == kHigh) {
    const double agl_m = (run.extreme == kLow ? 0.1 : 10.0) * study.survey().MedianAgl();
    variant.overrides.push_back({"partition.altitudes", fmt::format("[{}]", agl_m)});
  }
  return variant;
}

std::vector<StabilityRun> Plan(const std::string& survey, const StabilityOptions& options) {
  std::vector<StabilityRun> runs;
  for (const double budget_s : options.budgets_s) {
    for (const std::string& blocks : options.blocks) {
      for (const double rate : options.rates) {
        for (const int seed : options.seeds) {
          runs.push_back(
              {.survey = survey, .extreme = "", .blocks = blocks, .seed = seed, .rate = rate, .budget_s = budget_s, .result = {}, .refused = ""});
        }
      }
    }
  }
  for (const std::string& extreme : options.extremes) {
    // A height is given for every block.
    const std::string blocks = extreme == kLow || extreme == kHigh ? "1x1" : options.blocks.front();
    runs.push_back({.survey = survey,
                    .extreme = extreme,
                    .blocks = blocks,
                    .seed = options.seeds.front(),
                    .rate = options.rates.front(),
                    .budget_s = options.budgets_s.front(),
                    .result = {},
                    .refused = ""});
  }
  return runs;
}

// Held-out PSNR minus the median of the runs that differ only in seed and learning rate.
double AgainstMedian(const StabilityRun& run, const std::vector<StabilityRun>& runs) {
  std::vector<const VariantResult*> row;
  for (const StabilityRun& other : runs) {
    const bool same_row = other.survey == run.survey && other.extreme == run.extreme && other.blocks == run.blocks && other.budget_s == run.budget_s;
    if (same_row) row.push_back(&other.result);
  }
  row.push_back(&run.result);
  std::vector<double> psnr_db = ComparablePsnr(row);
  const double own_db = psnr_db.back();
  psnr_db.pop_back();
  return own_db - evaluate::MedianOfMeasured(std::move(psnr_db));
}

bool EndsBelowBest(const StabilityRun& run) {
  return run.WorstEnd() > kMostBelowBest_db;
}

BenchTable RunTable(const std::vector<StabilityRun>& runs) {
  BenchTable table{.name = "",
                   .title = "",
                   .note =
                       "Fall: of a field's training PSNR from its best so far, after step 300. End: how far below its best a field ended. Against "
                       "median: held-out PSNR over common pixels minus the median over seeds and rates. On context: blocks in whose place the scene "
                       "shows the context.",
                   .columns = {"Survey", "Extreme", "Blocks", "Rate", "Seed", "Time", "Steps", "Held-out PSNR", "Against median", "Worst fall",
                               "Worst end", "Taken back", "On context", "Layout"},
                   .rows = {}};
  for (const StabilityRun& run : runs) {
    double steps = 0.0;
    for (const VariantField& field : run.result.fields) steps += static_cast<double>(field.steps);
    const bool failed = !run.refused.empty() || !run.result.failure.empty();
    table.rows.push_back({BenchCell::Text(run.survey), BenchCell::Text(run.extreme.empty() ? "none" : run.extreme), BenchCell::Text(run.blocks),
                          BenchCell::Number(run.rate, 1), BenchCell::Number(run.seed, 0), BenchCell::Seconds(run.budget_s), BenchCell::Count(steps),
                          failed ? BenchCell::Text("refused") : BenchCell::Number(run.result.psnr_db, 2, "dB"),
                          BenchCell::Number(AgainstMedian(run, runs), 2, "dB"), BenchCell::Number(run.WorstFall(), 2, "dB"),
                          BenchCell::Number(run.WorstEnd(), 2, "dB"), BenchCell::Number(run.Falls(), 0), BenchCell::Number(run.ContextBlocks(), 0),
                          BenchCell::Text(failed ? run.refused + run.result.failure : run.result.layout)});
  }
  return table;
}

// The worst run of every survey and learning rate, and of every extreme.
std::string WorstChart(const std::vector<StabilityRun>& runs, const char* title, double (StabilityRun::*measure)() const) {
  std::map<std::string, double> worst;
  std::vector<std::string> order;
  for (const StabilityRun& run : runs) {
    const double value = (run.*measure)();
    if (!std::isfinite(value)) continue;
    const std::string row = run.survey + ", " + (run.extreme.empty() ? fmt::format("rate x {:g}", run.rate) : run.extreme);
    const auto [at, is_new] = worst.try_emplace(row, value);
    if (is_new) order.push_back(row);
    at->second = std::max(at->second, value);
  }
  std::vector<page::Bar> bars;
  bars.reserve(order.size());
  for (const std::string& row : order) bars.push_back({.label = row, .value = worst[row], .limit = kMostBelowBest_db});
  return page::BarChart(bars, {.title = title, .x_label = "dB", .limit_name = fmt::format("{:g} dB", kMostBelowBest_db)});
}

}  // namespace

std::vector<std::string> StabilityExtremes() {
  std::vector<std::string> names;
  for (const NamedEdit& edit : SurveyEdits()) names.push_back(edit.name);
  for (const char* name : {kLow, kHigh, kTinyBatch}) names.push_back(name);
  return names;
}

int StabilityRun::Falls() const {
  int falls = 0;
  for (const VariantField& field : result.fields) falls += field.falls;
  return falls;
}

int StabilityRun::ContextBlocks() const {
  return static_cast<int>(std::count_if(result.fields.begin(), result.fields.end(), [](const VariantField& field) { return field.shows_context; }));
}

double StabilityRun::WorstFall() const {
  double worst = VariantResult::kNone;
  for (const VariantField& field : result.fields) worst = std::fmax(worst, field.worst_fall_db);
  return worst;
}

double StabilityRun::WorstEnd() const {
  double worst = VariantResult::kNone;
  for (const VariantField& field : result.fields) {
    if (!field.shows_context) worst = std::fmax(worst, field.end_below_best_db);
  }
  return worst;
}

std::vector<StabilityRun> RunStability(Study& study, const std::string& survey, const StabilityOptions& options) {
  std::vector<StabilityRun> runs = Plan(survey, options);
  for (StabilityRun& run : runs) {
    try {
      run.result = study.Run(VariantOf(run, study));
    } catch (const base::InputError& error) {
      // Too little of the survey is left. That it is said clearly is what this run measures.
      run.refused = error.what();
      base::LogWarning("{}, {}: refused: {}", survey, run.extreme, run.refused);
    } catch (const base::BlockError& error) {
      run.refused = error.what();
      base::LogWarning("{}, {}: {}", survey, run.extreme, run.refused);
    }
  }
  std::vector<VariantResult*> comparable;
  for (StabilityRun& run : runs) {
    if (run.extreme.empty()) comparable.push_back(&run.result);
  }
  ScoreCommonPixels(study.folder(), comparable);
  return runs;
}

BenchPage StabilityPage(const std::vector<StabilityRun>& runs) {
  BenchPage page;
  page.name = "stability";
  page.title = "Stability of training";
  page.lead = fmt::format(
      "Every survey is trained with all combinations of blocks, learning rates, seeds and budgets, and once with each extreme: photos that are black "
      "or "
      "far too bright, water in most of the picture, three photos, heights ten times too low or high, pixels of 1 mm and 10 m, a zone's edge, and a "
      "tiny "
      "batch. A training must not end more than {:g} dB below its best, and no block may be shown that is worse than the context.",
      kMostBelowBest_db);
  const auto count = [&](auto&& test) { return static_cast<int>(std::count_if(runs.begin(), runs.end(), test)); };
  const int below = count(EndsBelowBest);
  const int taken_back = count([](const StabilityRun& run) { return run.Falls() > 0; });
  const int refused = count([](const StabilityRun& run) { return !run.refused.empty() || !run.result.failure.empty(); });
  const int on_context = count([](const StabilityRun& run) { return run.ContextBlocks() > 0; });
  page.figures = {{"Runs", std::to_string(runs.size()), fmt::format("{} refused with a reason", refused)},
                  {"End below their best", std::to_string(below), fmt::format("by more than {:g} dB", kMostBelowBest_db)},
                  {"Taken back", std::to_string(taken_back), "runs with a field that fell"},
                  {"On context", std::to_string(on_context), "runs with a block that is worse than the context, which is shown instead"}};
  page.verdicts.push_back(below == 0 ? fmt::format("No run ends more than {:g} dB below its best.", kMostBelowBest_db)
                                     : fmt::format("{} of {} runs end more than {:g} dB below their best.", below, runs.size(), kMostBelowBest_db));
  const int poor = count([&runs](const StabilityRun& run) { return AgainstMedian(run, runs) < -kNoise_db; });
  page.verdicts.push_back(
      fmt::format("{} of {} runs are more than {:g} dB below the median over seeds and rates; smaller distances are no more than noise.", poor,
                  runs.size(), kNoise_db));
  page.sections.push_back({.id = "worst",
                           .title = "Worst runs",
                           .lead = "",
                           .charts = {WorstChart(runs, "Worst end below its best", &StabilityRun::WorstEnd),
                                      WorstChart(runs, "Worst fall on the way", &StabilityRun::WorstFall)},
                           .tables = {},
                           .pictures = {}});
  page.sections.push_back({.id = "runs", .title = "All runs", .lead = "", .charts = {}, .tables = {RunTable(runs)}, .pictures = {}});
  return page;
}

}  // namespace skyquilt::bench
