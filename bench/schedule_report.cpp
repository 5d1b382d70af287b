#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "bench/schedule_bench.h"
#include "core/base/amounts.h"
#include "core/base/json_text.h"
#include "core/base/system.h"
#include "core/page/bar_chart.h"
#include "core/page/html.h"

namespace skyquilt::bench {
namespace {

nlohmann::ordered_json RunJson(const ScheduleRun& run) {
  return {{"efficiency", run.efficiency},
          {"wall_s", run.wall_s},
          {"restarts", run.restarts},
          {"moves", run.moves},
          {"messages_per_second", run.messages_per_second},
          {"bytes_per_second", run.bytes_per_second},
          {"coordinator_load", run.coordinator_load}};
}

constexpr double kTargetUndisturbed = 0.95, kTargetFailing = 0.90;

bool TargetsApply(ScheduleBenchOptions options) {
  const ScheduleBenchOptions stated;
  options.measured_seconds = stated.measured_seconds;
  options.status_every_s = stated.status_every_s;
  options.seed = stated.seed;
  return options == stated;
}

std::string LostRanks(const ScheduleBenchOptions& o) {
  return page::FormatPercent(o.failing) + " of ranks lost";
}

std::string TargetSentence(const std::string& what, double efficiency, double target) {
  return fmt::format("{}: efficiency {}; the target of {} is {}.", what, page::FormatPercent(efficiency, 2), page::FormatPercent(target, 0),
                     efficiency >= target ? "met" : "missed");
}

std::vector<BenchCell> RunRow(const std::string& what, const ScheduleRun& run) {
  return {BenchCell::Text(what),
          BenchCell::Percent(run.efficiency),
          BenchCell::Seconds(run.wall_s),
          BenchCell::Number(run.restarts, 0),
          BenchCell::Number(run.moves, 0),
          BenchCell::Count(run.messages_per_second),
          BenchCell::Bytes(run.bytes_per_second),
          BenchCell::Percent(run.coordinator_load)};
}

struct TimeShare {
  std::string what;
  double share = 0.0;  // fraction of ranks x wall time
};

std::vector<TimeShare> TimeShares(const ScheduleRun& run, const ScheduleBenchOptions& o) {
  const double rank_0 = 1.0 / o.ranks;
  const double restarting = (1.0 - rank_0) * run.restarts * o.restart_s / run.wall_s;
  return {{"useful work", run.efficiency},
          {"rank 0, which does not train", rank_0},
          {"restarts after lost ranks", restarting},
          {"idle, slow, moved or repeated work", 1.0 - run.efficiency - rank_0 - restarting}};
}

BenchSection RunsSection(const ScheduleBenchResult& r) {
  return {.id = "runs",
          .title = "Undisturbed, and with lost ranks",
          .lead = fmt::format("Messages and bytes are those to and from rank 0. The longest block alone takes {} on a rank of speed 1.",
                              base::FormatDuration(r.longest_s)),
          .charts = {},
          .tables = {{.name = "",
                      .title = "",
                      .note = fmt::format("Memory of rank 0 for queue, jobs and simulation: {}.", page::FormatBytes(r.coordinator_bytes)),
                      .columns = {"run", "efficiency", "time", "restarts", "moves", "messages per s", "bytes per s", "rank 0 CPU"},
                      .rows = {RunRow("nothing fails", r.undisturbed), RunRow("ranks lost", r.failing)}}},
          .pictures = {}};
}

BenchSection TimeSection(const ScheduleBenchResult& r) {
  const ScheduleBenchOptions& o = r.options;
  const std::vector<TimeShare> undisturbed = TimeShares(r.undisturbed, o), failing = TimeShares(r.failing, o);
  BenchTable table{
      .name = "time",
      .title = "",
      .note = "Work is counted in seconds of a rank of speed 1, so the last row includes the loss by slow ranks and the gain by fast ranks.",
      .columns = {"use of time", "nothing fails", "ranks lost"},
      .rows = {}};
  for (size_t i = 0; i < undisturbed.size(); ++i) {
    table.rows.push_back({BenchCell::Text(undisturbed[i].what), BenchCell::Percent(undisturbed[i].share), BenchCell::Percent(failing[i].share)});
  }
  const auto chart = [](const std::string& title, const std::vector<TimeShare>& shares) {
    std::vector<page::Bar> bars;
    bars.reserve(shares.size());
    for (const TimeShare& share : shares) {
      bars.push_back({.label = share.what, .value = 100.0 * share.share, .shown = page::FormatPercent(share.share)});
    }
    return page::BarChart(bars, {.title = title, .x_label = "fraction of all ranks' time (%)"});
  };
  return {.id = "time",
          .title = "Use of the ranks' time",
          .lead = fmt::format("A lost rank ends the job: all ranks need {} to start again and repeat the work since the last checkpoint (every {}).",
                              base::FormatDuration(o.restart_s), base::FormatDuration(o.checkpoint_every_s)),
          .charts = {chart("Nothing fails", undisturbed), chart(LostRanks(o), failing)},
          .tables = {table},
          .pictures = {}};
}

}  // namespace

std::string ScheduleBenchJson(const ScheduleBenchResult& r) {
  const ScheduleBenchOptions& o = r.options;
  const nlohmann::ordered_json json = {{"bench", "schedule"},
                                       {"work_s", r.work_s},
                                       {"longest_s", r.longest_s},
                                       {"undisturbed", RunJson(r.undisturbed)},
                                       {"failing", RunJson(r.failing)},
                                       {"coordinator_bytes", r.coordinator_bytes},
                                       {"config",
                                        {{"blocks", o.blocks},
                                         {"ranks", o.ranks},
                                         {"block_seconds", o.block_seconds},
                                         {"cost_spread", o.cost_spread},
                                         {"measured_blocks", o.measured_seconds.size()},
                                         {"cost_error", o.cost_error},
                                         {"speed_spread", o.speed_spread},
                                         {"stragglers", o.stragglers},
                                         {"failing", o.failing},
                                         {"checkpoint_every_s", o.checkpoint_every_s},
                                         {"restart_s", o.restart_s},
                                         {"skip_s", o.skip_s},
                                         {"move_s", o.move_s},
                                         {"status_every_s", o.status_every_s},
                                         {"seed", o.seed}}},
                                       {"machine", base::MachineDescription()},
                                       {"date", base::UtcTimestamp()}};
  return base::JsonText(json, 2) + "\n";
}

std::string ScheduleBenchTable(const ScheduleBenchResult& r) {
  const ScheduleBenchOptions& o = r.options;
  std::string text = fmt::format(
      "{} blocks of {} each on {} ranks ({} of work per rank; the longest block takes {}), rank speeds +-{:.0f} %, {:.1f} % at half speed\n",
      o.blocks, base::FormatDuration(o.block_seconds), o.ranks, base::FormatDuration(r.work_s / o.ranks), base::FormatDuration(r.longest_s),
      100.0 * o.speed_spread, 100.0 * o.stragglers);
  const auto row = [&text](const std::string& what, const ScheduleRun& run) {
    text += fmt::format("  {:<28}{:>6.1f} %  {:>9}  {:>8}  {:>6}  {:>11.0f}/s  {:>8}B/s  {:>7.1f} %\n", what, 100.0 * run.efficiency,
                        base::FormatDuration(run.wall_s), run.restarts, run.moves, run.messages_per_second, base::FormatCount(run.bytes_per_second),
                        100.0 * run.coordinator_load);
  };
  text += fmt::format("  {:<26}{:>10}  {:>9}  {:>8}  {:>6}  {:>13}  {:>12}  {:>9}\n", "", "efficiency", "time", "restarts", "moves", "messages",
                      "traffic", "rank 0 CPU");
  row("nothing fails", r.undisturbed);
  row(fmt::format("{:.1f} % of ranks lost", 100.0 * o.failing), r.failing);
  text += fmt::format(
      "Rank 0 counts as a rank but does not train. A lost rank ends the job: all ranks need {} to start again and repeat the work since the last\n"
      "checkpoint (every {}). Memory of rank 0 for queue, jobs and simulation: {}B\n",
      base::FormatDuration(o.restart_s), base::FormatDuration(o.checkpoint_every_s), base::FormatCount(static_cast<double>(r.coordinator_bytes)));
  return text;
}

BenchPage ScheduleBenchPage(const ScheduleBenchResult& r, const std::string& command) {
  const ScheduleBenchOptions& o = r.options;
  BenchPage page{.name = "schedule",
                 .title = "How well a cluster would be used",
                 .lead = fmt::format(
                     "The real scheduler with ranks on a simulated clock: {} blocks of {} each on {} ranks, including rank 0; {} of work per rank. "
                     "Rank speeds \xC2\xB1{}, {} at half speed; cost estimates wrong by {}.",
                     page::FormatInteger(o.blocks), base::FormatDuration(o.block_seconds), page::FormatInteger(o.ranks),
                     base::FormatDuration(r.work_s / o.ranks), page::FormatPercent(o.speed_spread, 0), page::FormatPercent(o.stragglers),
                     page::FormatPercent(o.cost_error, 0)),
                 .figures = {{"Efficiency, nothing fails", page::FormatPercent(r.undisturbed.efficiency), "useful fraction of all ranks' time"},
                             {"Efficiency, " + LostRanks(o), page::FormatPercent(r.failing.efficiency),
                              fmt::format("{} restart{} of the job", r.failing.restarts, r.failing.restarts == 1 ? "" : "s")},
                             {"Messages", page::FormatLarge(r.undisturbed.messages_per_second, "/s"),
                              "to and from rank 0, " + page::FormatPercent(r.undisturbed.coordinator_load) + " of one of its cores"}},
                 .verdicts = {},
                 .sections = {RunsSection(r), TimeSection(r)},
                 .command = command,
                 .machine = base::MachineDescription(),
                 .date = base::UtcTimestamp()};
  if (TargetsApply(o)) {
    page.verdicts = {TargetSentence("Nothing fails", r.undisturbed.efficiency, kTargetUndisturbed),
                     TargetSentence(LostRanks(o), r.failing.efficiency, kTargetFailing)};
  }
  return page;
}

}  // namespace skyquilt::bench
