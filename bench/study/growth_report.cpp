#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "bench/study/growth_bench.h"
#include "core/base/amounts.h"
#include "core/base/json_text.h"
#include "core/base/system.h"
#include "core/page/curve_chart.h"

namespace skyquilt::bench {
namespace {

using nlohmann::json;

constexpr double kManyPhotos = 20'000.0;
constexpr double kGiB = 1073741824.0;

std::vector<std::string> StageNames(const GrowthResult& result) {
  std::vector<std::string> names;
  for (const GrowthRow& row : result.rows) {
    for (const GrowthStage& stage : row.stages) {
      if (std::find(names.begin(), names.end(), stage.name) == names.end()) names.push_back(stage.name);
    }
  }
  return names;
}

template <typename Value>
std::vector<std::pair<double, double>> PointsOf(const GrowthResult& result, const std::string& stage, const Value& value) {
  std::vector<std::pair<double, double>> points;
  for (const GrowthRow& row : result.rows) {
    if (const GrowthStage* found = row.Find(stage); found != nullptr && value(*found) > 0.0) points.emplace_back(row.photos, value(*found));
  }
  return points;
}

double StageSecondsOf(const GrowthStage& stage) {
  return stage.seconds;
}
double BytesOf(const GrowthStage& stage) {
  return stage.peak_bytes;
}

std::optional<GrowthLaw> LawOf(const std::vector<std::pair<double, double>>& points) {
  if (points.size() < 2) return std::nullopt;
  return FitGrowth(points);
}

// Of the stage at the most photos.
double LastSeconds(const GrowthResult& result, const std::string& stage) {
  const GrowthStage* last = result.rows.empty() ? nullptr : result.rows.back().Find(stage);
  return last == nullptr ? 0.0 : last->seconds;
}

std::string TimeVerdict(const GrowthResult& result, const std::vector<std::string>& names) {
  const double most = std::log(kMostGrowth) / std::log(kGrowthPhotos);
  std::string beyond;
  for (const std::string& name : names) {
    if (name == kBudgetedStage || LastSeconds(result, name) < kShortStage_s) continue;
    const std::optional<GrowthLaw> law = LawOf(PointsOf(result, name, StageSecondsOf));
    if (law && law->exponent > most) beyond += fmt::format("{}{} ({:.2f})", beyond.empty() ? "" : ", ", name, law->exponent);
  }
  const std::string target = fmt::format("time of stages over {:.0f} s grows by at most {:.0f} times for {:.0f} times the photos (power {:.2f})",
                                         kShortStage_s, kMostGrowth, kGrowthPhotos, most);
  return beyond.empty() ? "Met: " + target + "." : "Missed: " + target + ", but faster in " + beyond + ".";
}

std::string MemoryVerdict(const GrowthResult& result) {
  const GrowthRow& last = result.rows.back();
  const double peak = last.PeakBytes();
  return fmt::format("{}: peak memory of {:.2f} GiB at {} photos, with a limit of {:.2f} GiB.", peak <= result.memory_bytes ? "Met" : "Missed",
                     peak / kGiB, last.photos, result.memory_bytes / kGiB);
}

template <typename Value>
std::vector<page::Curve> CurvesOf(const GrowthResult& result, const std::vector<std::string>& names, const Value& value) {
  std::vector<page::Curve> curves;
  for (const std::string& name : names) curves.push_back({.name = name, .points = PointsOf(result, name, value), .marks = true});
  return curves;
}

template <typename Value, typename Cell>
BenchTable TableOf(const GrowthResult& result, const std::vector<std::string>& names, const char* table, const char* title, const Value& value,
                   const Cell& cell) {
  BenchTable made{.name = table,
                  .title = title,
                  .note = "Power: of the number of photos, from the larger half of the surveys.",
                  .columns = {"stage"},
                  .rows = {}};
  for (const GrowthRow& row : result.rows) made.columns.push_back(fmt::format("{} photos", row.photos));
  made.columns.emplace_back("power");
  made.columns.push_back(fmt::format("{:.0f} photos, by the power", kManyPhotos));
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (const std::string& name : names) {
    std::vector<BenchCell> cells = {BenchCell::Text(name)};
    for (const GrowthRow& row : result.rows) {
      const GrowthStage* found = row.Find(name);
      cells.push_back(found == nullptr ? BenchCell::Number(kNone, 1) : cell(value(*found)));
    }
    const std::optional<GrowthLaw> law = LawOf(PointsOf(result, name, value));
    cells.push_back(BenchCell::Number(law ? law->exponent : kNone, 2));
    cells.push_back(law ? cell(law->At(kManyPhotos)) : BenchCell::Number(kNone, 1));
    made.rows.push_back(std::move(cells));
  }
  return made;
}

json RowJson(const GrowthRow& row) {
  json stages = json::array();
  for (const GrowthStage& stage : row.stages) stages.push_back({{"name", stage.name}, {"seconds", stage.seconds}, {"peak_bytes", stage.peak_bytes}});
  return {{"photos", row.photos}, {"blocks", row.blocks}, {"area_m2", row.area_m2}, {"points", row.points}, {"stages", std::move(stages)}};
}

}  // namespace

BenchPage GrowthPage(const GrowthResult& result, const std::string& command) {
  BenchPage page;
  page.name = "scale";
  page.title = "Time and memory by number of photos";
  page.lead =
      "Surveys of one place, height and overlap, of growing area, from photos to report with given poses. Training has a fixed time, so its time "
      "says "
      "nothing. Memory is the peak of rank 0 during the stage.";
  page.SetOrigin(command);
  if (result.rows.empty()) return page;
  const std::vector<std::string> names = StageNames(result);
  const GrowthRow& last = result.rows.back();
  double total = 0.0;
  for (const GrowthStage& stage : last.stages) total += stage.seconds;
  page.figures = {{"Photos", std::to_string(last.photos), fmt::format("{} blocks, {:.2f} km2", last.blocks, last.area_m2 / 1e6)},
                  {"All stages", base::FormatDuration(total), "at the most photos"},
                  {"Peak memory", fmt::format("{:.2f} GiB", last.PeakBytes() / kGiB), "at the most photos"}};
  if (result.rows.size() > 1) page.verdicts.push_back(TimeVerdict(result, names));
  page.verdicts.push_back(MemoryVerdict(result));
  BenchTable surveys{.name = "surveys", .title = "Surveys", .note = "", .columns = {"photos", "blocks", "area (km2)", "sparse points"}, .rows = {}};
  for (const GrowthRow& row : result.rows) {
    surveys.rows.push_back({BenchCell::Number(row.photos, 0), BenchCell::Number(row.blocks, 0), BenchCell::Number(row.area_m2 / 1e6, 3),
                            BenchCell::Count(static_cast<double>(row.points))});
  }
  const page::ChartOptions time{.title = "Time of the stages", .x_label = "photos", .y_label = "seconds", .log_y = true, .log_x = true};
  const page::ChartOptions memory{.title = "Peak memory of the stages", .x_label = "photos", .y_label = "bytes", .log_y = true, .log_x = true};
  page.sections.push_back({.id = "time",
                           .title = "Time",
                           .lead = "",
                           .charts = {page::CurveChart(CurvesOf(result, names, StageSecondsOf), time)},
                           .tables = {TableOf(result, names, "time", "Seconds", StageSecondsOf, BenchCell::Seconds)},
                           .pictures = {}});
  page.sections.push_back({.id = "memory",
                           .title = "Memory",
                           .lead = "",
                           .charts = {page::CurveChart(CurvesOf(result, names, BytesOf), memory)},
                           .tables = {TableOf(result, names, "memory", "Peak memory", BytesOf, BenchCell::Bytes)},
                           .pictures = {}});
  page.sections.push_back({.id = "surveys", .title = "Surveys", .lead = "", .charts = {}, .tables = {surveys}, .pictures = {}});
  return page;
}

std::string GrowthJson(const GrowthResult& result, const std::string& command) {
  json rows = json::array();
  for (const GrowthRow& row : result.rows) rows.push_back(RowJson(row));
  const json all = {{"command", command},    {"machine", base::MachineDescription()}, {"date", base::UtcTimestamp()},
                    {"ranks", result.ranks}, {"memory_bytes", result.memory_bytes},   {"rows", std::move(rows)}};
  return base::JsonText(all, 2) + "\n";
}

std::string GrowthRowJson(const GrowthRow& row, const std::string& identity) {
  json text = RowJson(row);
  text["identity"] = identity;
  return base::JsonText(text, 2) + "\n";
}

bool ParseGrowthRow(const std::string& text, const std::string& identity, GrowthRow* row) {
  const json parsed = base::TryParseJson(text);
  try {
    if (!parsed.is_object() || parsed.at("identity").get<std::string>() != identity) return false;
    GrowthRow read{.photos = parsed.at("photos").get<int>(),
                   .blocks = parsed.at("blocks").get<int>(),
                   .area_m2 = parsed.at("area_m2").get<double>(),
                   .points = parsed.at("points").get<int64_t>(),
                   .stages = {}};
    for (const json& stage : parsed.at("stages")) {
      read.stages.push_back({stage.at("name").get<std::string>(), stage.at("seconds").get<double>(), stage.at("peak_bytes").get<double>()});
    }
    *row = std::move(read);
    return true;
  } catch (const json::exception&) {
    return false;
  }
}

}  // namespace skyquilt::bench
