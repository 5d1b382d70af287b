#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "bench/poses/poses_bench.h"
#include "core/base/amounts.h"
#include "core/base/json_text.h"
#include "core/base/system.h"

namespace skyquilt::bench {
namespace {

std::string SetAndSize(const PosesRow& row) {
  return fmt::format("{} ({} photos)", NameOf(row.set), row.n_files);
}

BenchCell Count(size_t n) {
  return BenchCell::Number(static_cast<double>(n), 0);
}

BenchTable RowsTable(const PosesResult& result) {
  BenchTable table{
      .name = "",
      .title = "",
      .note =
          "Right: off by less than 2 % of the height above ground and by less than 2 degrees, after the model was moved, turned and scaled "
          "to the true positions. Position and rotation: medians. Focal length: largest error of a camera. Intruders: photos of "
          "another place that got a pose. Seconds: from photos to the model, features included.",
      .columns = {"set", "photos", "way", "poses by", "registered", "right", "intruders", "position", "rotation", "focal length", "time",
                  "s per photo"},
      .rows = {}};
  for (const PosesRow& row : result.rows) {
    const PoseScore& score = row.score;
    table.rows.push_back({BenchCell::Text(NameOf(row.set)), Count(row.n_files), BenchCell::Text(row.way),
                          BenchCell::Text(row.used.empty() ? "no model" : row.used), Count(score.registered), Count(score.right),
                          Count(score.intruders), BenchCell::Number(score.position_m, 3, "m"), BenchCell::Number(score.rotation_deg, 3, "deg"),
                          BenchCell::Percent(score.focal_error), BenchCell::Seconds(row.seconds), BenchCell::Number(row.SecondsPerPhoto(), 2)});
  }
  return table;
}

BenchTable SetsTable(const PosesResult& result) {
  BenchTable table{.name = "sets", .title = "The photo sets", .note = "", .columns = {"set", "what is hard about it"}, .rows = {}};
  std::string last;
  for (const PosesRow& row : result.rows) {
    if (last == NameOf(row.set)) continue;
    last = NameOf(row.set);
    table.rows.push_back({BenchCell::Text(last), BenchCell::Text(AboutSet(row.set))});
  }
  return table;
}

BenchTable SlopesTable(const std::vector<PosesSlope>& slopes) {
  BenchTable table{.name = "slopes",
                   .title = "Time per photo in the largest survey, relative to the smallest",
                   .note = "",
                   .columns = {"set", "way", "few", "many", "ratio"},
                   .rows = {}};
  for (const PosesSlope& slope : slopes) {
    table.rows.push_back(
        {BenchCell::Text(NameOf(slope.set)), BenchCell::Text(slope.way), Count(slope.few), Count(slope.many), BenchCell::Number(slope.ratio, 2)});
  }
  return table;
}

std::string FewerSentence(const std::vector<WayComparison>& comparisons) {
  std::string fewer, fell_back;
  for (const WayComparison& both : comparisons) {
    const std::string what = fmt::format("{}: {} against {}", SetAndSize(*both.fast), both.fast->score.registered, both.colmap->score.registered);
    if (!both.Passed()) fewer += (fewer.empty() ? "" : "; ") + what;
    if (both.fast->FellBack()) fell_back += (fell_back.empty() ? "" : "; ") + what;
  }
  std::string text =
      fewer.empty()
          ? fmt::format("In all {} sets the fast way registers no fewer photos than COLMAP alone, or its fall-back was taken.", comparisons.size())
          : "The fast way registers fewer photos than COLMAP alone: " + fewer + ".";
  if (!fell_back.empty()) text += " The fall-back (more pairs, COLMAP's own settings) was taken for " + fell_back + ".";
  return text;
}

std::string IntruderSentence(const PosesResult& result) {
  std::string with;
  bool asked = false;
  for (const PosesRow& row : result.rows) {
    asked = asked || row.set == PhotoSet::kOtherPlace;
    if (row.score.intruders > 0) with += fmt::format("{}{} of {}, {}", with.empty() ? "" : "; ", row.score.intruders, SetAndSize(row), row.way);
  }
  if (!asked) return "";
  return with.empty() ? "No photo of another place got a pose." : "Photos of another place got a pose: " + with + ".";
}

std::string SlopeSentence(const PosesSlope& slope) {
  const std::string text = fmt::format("{}, {}: a photo takes {:.2f} times as long among {} photos as among {}", NameOf(slope.set), slope.way,
                                       slope.ratio, slope.many, slope.few);
  if (slope.way != kFastWay) return text + ".";
  return text + fmt::format("; the target of at most {} is {}.", kMaxSlope, slope.ratio <= kMaxSlope ? "met" : "missed");
}

std::vector<std::string> Verdicts(const PosesResult& result) {
  std::vector<std::string> verdicts;
  if (const auto comparisons = result.Comparisons(); !comparisons.empty()) verdicts.push_back(FewerSentence(comparisons));
  if (const std::string intruders = IntruderSentence(result); !intruders.empty()) verdicts.push_back(intruders);
  for (const PosesSlope& slope : result.Slopes()) verdicts.push_back(SlopeSentence(slope));
  for (const PosesRow& row : result.rows) {
    if (!row.failure.empty()) verdicts.push_back(fmt::format("{}, {}: no model. {}", SetAndSize(row), row.way, row.failure));
    if (row.failure.empty() && !row.score.problem.empty())
      verdicts.push_back(fmt::format("{}, {}: the model cannot be compared with the truth: {}.", SetAndSize(row), row.way, row.score.problem));
  }
  return verdicts;
}

}  // namespace

BenchPage PosesPage(const PosesResult& result, const std::string& command) {
  BenchPage page{
      .name = "poses",
      .title = "Poses of photos that are hard to place",
      .lead = "Each set is photos with tags, made from a simulated survey (" + result.place +
              "; solar_farm of its own) without its model. Poses are found in the fast way of prepare and by COLMAP alone, and compared with "
              "the true ones.",
      .figures = {},
      .verdicts = Verdicts(result),
      .sections = {},
      .command = command,
      .machine = base::MachineDescription(),
      .date = base::UtcTimestamp()};
  const auto comparisons = result.Comparisons();
  if (!comparisons.empty()) {
    size_t passed = 0;
    for (const WayComparison& both : comparisons) passed += both.Passed() ? 1 : 0;
    page.figures.push_back(
        {"No fewer photos than COLMAP", fmt::format("{} of {} sets", passed, comparisons.size()), "in " + base::FormatDuration(result.seconds)});
  }
  const std::vector<PosesSlope> slopes = result.Slopes();
  for (const PosesSlope& slope : slopes) {
    if (slope.way != kFastWay) continue;
    page.figures.push_back({fmt::format("Time per photo, {} against {}", slope.many, slope.few), fmt::format("{:.2f} x", slope.ratio),
                            fmt::format("{}, fast way; at most {} x wanted", NameOf(slope.set), kMaxSlope)});
  }
  BenchSection section{.id = "sets", .title = "Found poses", .lead = "", .charts = {}, .tables = {RowsTable(result)}, .pictures = {}};
  if (!slopes.empty()) section.tables.push_back(SlopesTable(slopes));
  section.tables.push_back(SetsTable(result));
  page.sections.push_back(std::move(section));
  return page;
}

std::string PosesJson(const PosesResult& result, const std::string& command) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array(), slopes = nlohmann::ordered_json::array(), sets = nlohmann::ordered_json::array();
  for (const PosesRow& row : result.rows) {
    rows.push_back({{"set", NameOf(row.set)},
                    {"photos", row.n_files},
                    {"way", row.way},
                    {"used", row.used},
                    {"failure", row.failure.empty() ? row.score.problem : row.failure},
                    {"own_photos", row.score.n_photos},
                    {"registered", row.score.registered},
                    {"right", row.score.right},
                    {"intruders", row.score.intruders},
                    {"position_m", base::NumberOrNull(row.score.position_m)},
                    {"rotation_deg", base::NumberOrNull(row.score.rotation_deg)},
                    {"focal_error", base::NumberOrNull(row.score.focal_error)},
                    {"seconds", row.seconds},
                    {"seconds_per_photo", row.SecondsPerPhoto()}});
  }
  for (const WayComparison& both : result.Comparisons()) {
    sets.push_back({{"set", NameOf(both.fast->set)},
                    {"photos", both.fast->n_files},
                    {"no_fewer", both.NoFewer()},
                    {"fell_back", both.fast->FellBack()},
                    {"passed", both.Passed()}});
  }
  for (const PosesSlope& slope : result.Slopes())
    slopes.push_back(
        {{"set", NameOf(slope.set)}, {"way", slope.way}, {"few", slope.few}, {"many", slope.many}, {"ratio", base::NumberOrNull(slope.ratio)}});
  const nlohmann::ordered_json json = {{"bench", "poses"},
                                       {"place", result.place},
                                       {"seconds", result.seconds},
                                       {"rows", rows},
                                       {"comparisons", sets},
                                       {"slopes", slopes},
                                       {"command", command},
                                       {"machine", base::MachineDescription()},
                                       {"date", base::UtcTimestamp()}};
  return base::JsonText(json, 2) + "\n";
}

}  // namespace skyquilt::bench
