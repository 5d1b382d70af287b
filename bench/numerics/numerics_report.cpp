#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/numerics/numerics_bench.h"
#include "core/base/amounts.h"
#include "core/base/json_text.h"
#include "core/base/system.h"

namespace skyquilt::bench {
namespace {

// Smallest and largest error of the rows of one group and unit.
struct Range {
  double low = kEver, high = -kEver;
};

Range ComparedRange(const NumericsResult& result, const std::string& id, const std::string& unit) {
  Range range;
  for (const GroupResult& group : result.groups) {
    for (const NumericRow& row : group.rows) {
      if (group.id != id || row.verdict != Verdict::kShown || row.unit != unit || std::isnan(row.worst)) continue;
      range.low = std::min(range.low, row.worst);
      range.high = std::max(range.high, row.worst);
    }
  }
  return range;
}

const NumericRow* FindRow(const NumericsResult& result, const std::string& group_id, const std::string& name_part) {
  for (const GroupResult& group : result.groups) {
    if (group.id != group_id) continue;
    for (const NumericRow& row : group.rows) {
      if (row.name.find(name_part) != std::string::npos) return &row;
    }
  }
  return nullptr;
}

// Largest error in millimetres of the "space" rows. Rows "Block of ..." are left out: their limit is the float step of the block.
double WorstPlaceMm(const NumericsResult& result) {
  Worst worst;
  bool any = false;
  for (const GroupResult& group : result.groups) {
    for (const NumericRow& row : group.rows) {
      if (group.id != "space" || row.verdict == Verdict::kShown || row.name.rfind("Block of", 0) == 0) continue;
      worst.Take(row.worst);
      any = true;
    }
  }
  return any ? worst.value() : kNoNumber;
}

std::string CasesSentence(const NumericsResult& result) {
  const int passed = result.Count(Verdict::kPassed), failed = result.Count(Verdict::kFailed);
  if (failed == 0) return fmt::format("All {} cases pass.", passed);
  std::string names;
  for (const NumericRow& row : result.Failed()) names += (names.empty() ? "" : "; ") + row.group + ": " + row.name;
  return fmt::format("{} of {} cases fail: {}.", failed, passed + failed, names);
}

BenchTable GroupTable(const GroupResult& group) {
  BenchTable table{
      .name = group.id, .title = "", .note = "", .columns = {"case", "verdict", "worst error", "allowed", "expected", "seen"}, .rows = {}};
  for (const NumericRow& row : group.rows) {
    table.rows.push_back({BenchCell::Text(row.name), BenchCell::Text(VerdictName(row.verdict)),
                          BenchCell{FormatError(row.worst, row.unit), row.worst}, BenchCell{FormatError(row.limit, row.unit), row.limit},
                          BenchCell::Text(row.expected), BenchCell::Text(row.seen)});
  }
  return table;
}

}  // namespace

BenchPage NumericsPage(const NumericsResult& result, const std::string& command) {
  BenchPage page{
      .name = "numerics",
      .title = "Numerical accuracy in extreme cases",
      .lead =
          "Each case shows what is expected, what was measured and the largest error. References are independent implementations in double "
          "or long double. Rows \xE2\x80\x9C"
          "for comparison\xE2\x80\x9D show other ways to compute, such as single precision, and are not judged." +
          std::string(result.quick ? " This was a quick run: fewer places, fewer steps." : ""),
      .figures = {},
      .verdicts = {CasesSentence(result)},
      .sections = {},
      .command = command,
      .machine = base::MachineDescription(),
      .date = base::UtcTimestamp()};
  const int passed = result.Count(Verdict::kPassed), failed = result.Count(Verdict::kFailed);
  page.figures.push_back({"Cases passed", fmt::format("{} of {}", passed, passed + failed), "in " + base::FormatDuration(result.seconds)});
  if (const double worst = WorstPlaceMm(result); !std::isnan(worst)) {
    page.figures.push_back({"Places moved by at most", FormatError(worst, "mm"), "surveys of 1 m to 100 km, any latitude; 1 mm allowed"});
    const Range naive = ComparedRange(result, "space", "mm");
    page.verdicts.push_back(
        fmt::format("The pipeline moves a place by at most {} (allowed: 1 mm). Coordinates in single precision would move it by {} to {} "
                    "in a survey of 100 km, depending on the frame.",
                    FormatError(worst, "mm"), FormatError(naive.low, "mm"), FormatError(naive.high, "mm")));
  }
  const NumericRow* run = FindRow(result, "trainer", "steps of training");
  if (run != nullptr) {
    const double gradients = FindRow(result, "trainer", "Gradients") != nullptr ? result.WorstOf("trainer", "relative") : kNoNumber;
    page.figures.push_back({"Float against double trainer", FormatError(run->worst, "dB"), "held-out PSNR after " + run->name});
    page.verdicts.push_back(
        fmt::format("The trainer's loss and gradients agree with the double-precision reference to {}; after {} its held-out PSNR is "
                    "{} from the reference's.",
                    "a relative " + FormatError(gradients, ""), run->name, FormatError(run->worst, "dB")));
  }
  if (const double away = result.WorstOf("away", "dB"); !std::isnan(away)) {
    const Range naive = ComparedRange(result, "away", "dB");
    page.figures.push_back({"Away from the origin", FormatError(away, "dB"), "largest PSNR change of a fixed run, up to 6400 km"});
    page.verdicts.push_back(
        fmt::format("Moving the scene up to 6400 km from the origin changes a fixed training by at most {}; with survey-wide float "
                    "coordinates by {} to {}.",
                    FormatError(away, "dB"), FormatError(naive.low, "dB"), FormatError(naive.high, "dB")));
  }
  if (const double earth = result.WorstOf("earth", "dB"); !std::isnan(earth)) {
    page.figures.push_back(
        {"Anywhere on Earth", FormatError(earth, "dB"), "largest PSNR change of a moved survey with equally rotated axes; 0.1 dB allowed"});
    page.verdicts.push_back(
        fmt::format("Flown at the poles, across \xC2\xB1"
                    "180\xC2\xB0, below sea level and at 9 km, the survey's PSNR changes by at most {} with equally rotated axes "
                    "(allowed: 0.1 dB).",
                    FormatError(earth, "dB")));
  }
  for (const GroupResult& group : result.groups) {
    page.sections.push_back(
        {.id = group.id, .title = group.title, .lead = group.lead, .charts = group.charts, .tables = {GroupTable(group)}, .pictures = {}});
  }
  return page;
}

std::string NumericsJson(const NumericsResult& result, const std::string& command) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const GroupResult& group : result.groups) {
    for (const NumericRow& row : group.rows) {
      rows.push_back({{"group", group.id},
                      {"case", row.name},
                      {"expected", row.expected},
                      {"seen", row.seen},
                      {"worst", base::NumberOrNull(row.worst)},
                      {"unit", row.unit},
                      {"allowed", base::NumberOrNull(row.limit)},
                      {"verdict", row.verdict == Verdict::kPassed   ? "passed"
                                  : row.verdict == Verdict::kFailed ? "failed"
                                                                    : "comparison"},
                      {"seconds", row.seconds}});
    }
  }
  const nlohmann::ordered_json json = {{"bench", "numerics"},
                                       {"quick", result.quick},
                                       {"passed", result.Count(Verdict::kPassed)},
                                       {"failed", result.Count(Verdict::kFailed)},
                                       {"seconds", result.seconds},
                                       {"rows", rows},
                                       {"command", command},
                                       {"machine", base::MachineDescription()},
                                       {"date", base::UtcTimestamp()}};
  return base::JsonText(json, 2) + "\n";
}

}  // namespace skyquilt::bench
