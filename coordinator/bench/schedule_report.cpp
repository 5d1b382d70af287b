#include <spdlog/fmt/fmt.h>

#include <nlohmann/json.hpp>

#include "coordinator/bench/schedule_bench.h"
#include "core/base/progress.h"
#include "core/base/system.h"

namespace skyquilt::coordinator {
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
  return json.dump(2) + "\n";
}

std::string ScheduleBenchTable(const ScheduleBenchResult& r) {
  const ScheduleBenchOptions& o = r.options;
  std::string text = fmt::format(
      "{} blocks of {} each on {} ranks ({} of work for each; the longest block takes {}), ranks' speed +-{:.0f} %, {:.1f} % at half speed\n",
      o.blocks, base::FormatDuration(o.block_seconds), o.ranks, base::FormatDuration(r.work_s / o.ranks), base::FormatDuration(r.longest_s),
      100.0 * o.speed_spread, 100.0 * o.stragglers);
  const auto row = [&text](const std::string& what, const ScheduleRun& run) {
    text += fmt::format("  {:<28}{:>6.1f} %  {:>9}  {:>8}  {:>6}  {:>11.0f}/s  {:>8}B/s  {:>7.1f} %\n", what, 100.0 * run.efficiency,
                        base::FormatDuration(run.wall_s), run.restarts, run.moves, run.messages_per_second, base::FormatCount(run.bytes_per_second),
                        100.0 * run.coordinator_load);
  };
  text += fmt::format("  {:<28}{:>8}  {:>9}  {:>8}  {:>6}  {:>13}  {:>12}  {:>9}\n", "", "efficient", "time", "restarts", "moves", "messages",
                      "traffic", "rank 0 CPU");
  row("nothing fails", r.undisturbed);
  row(fmt::format("{:.1f} % of ranks lost", 100.0 * o.failing), r.failing);
  text += fmt::format(
      "Rank 0 counts as a rank but does not train. A lost rank ends the job: {} to start again, and the work since the last checkpoint\n"
      "(every {}) is done twice. Memory of rank 0 for it, simulation included: {}B\n",
      base::FormatDuration(o.restart_s), base::FormatDuration(o.checkpoint_every_s), base::FormatCount(static_cast<double>(r.coordinator_bytes)));
  return text;
}

}  // namespace skyquilt::coordinator
