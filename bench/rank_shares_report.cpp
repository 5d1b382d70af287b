#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "bench/rank_shares.h"
#include "core/base/json_text.h"
#include "core/base/system.h"
#include "core/page/curve_chart.h"

namespace skyquilt::bench {
namespace {

double OwnSeconds(const RankShares& shares) {
  double own_s = 0.0;
  for (const StageWork& stage : shares.run.stages) own_s += stage.own_s;
  return own_s;
}

BenchTable SharesTable(const RankShares& shares) {
  BenchTable table{.name = "ranks",
                   .title = "",
                   .note = "Rank 0 alone: while other ranks wait. With one rank, that one does the rest too; with more, the other ranks do it.",
                   .columns = {"ranks", "time", "rank 0 alone", "rays", "blocks", "share of rank 0"},
                   .rows = {}};
  for (const RankShareRow& row : shares.rows) {
    table.rows.push_back({BenchCell::Number(row.ranks, 0), BenchCell::Seconds(row.WallSeconds()), BenchCell::Seconds(row.own_s),
                          BenchCell::Seconds(row.divided_s), BenchCell::Seconds(row.blocks_s), BenchCell::Percent(row.Share())});
  }
  return table;
}

BenchTable WorkTable(const RankShares& shares) {
  BenchTable table{.name = "stages",
                   .title = "The stages on one process",
                   .note = "",
                   .columns = {"stage", "rank 0 alone", "of all that it does alone", "divided"},
                   .rows = {}};
  const double own_s = std::max(OwnSeconds(shares), 1e-9);
  for (const StageWork& stage : shares.run.stages) {
    table.rows.push_back(
        {BenchCell::Text(stage.name), BenchCell::Seconds(stage.own_s), BenchCell::Percent(stage.own_s / own_s), BenchCell::Seconds(stage.divided_s)});
  }
  return table;
}

std::string ShareVerdict(const RankShares& shares) {
  const auto row = std::find_if(shares.rows.begin(), shares.rows.end(), [](const RankShareRow& one) { return one.ranks == kShareRanks; });
  if (row == shares.rows.end()) return "";
  const auto most =
      std::max_element(shares.run.stages.begin(), shares.run.stages.end(), [](const StageWork& a, const StageWork& b) { return a.own_s < b.own_s; });
  return fmt::format(
      "{}: at {} ranks, rank 0 works alone for less than {:.0f} % of the time: {:.1f} %. Most of it is '{}' with {:.0f} % of what it does alone.",
      row->Share() < kMostShare ? "Met" : "Missed", kShareRanks, 100.0 * kMostShare, 100.0 * row->Share(),
      most == shares.run.stages.end() ? "" : most->name,
      most == shares.run.stages.end() ? 0.0 : 100.0 * most->own_s / std::max(OwnSeconds(shares), 1e-9));
}

}  // namespace

BenchPage RankSharesPage(const RankShares& shares, const std::string& command) {
  BenchPage page;
  page.name = "schedule";
  page.title = "What rank 0 does alone";
  page.lead = fmt::format(
      "From the times of the stages of a run of one process with {} blocks, for a survey with {} blocks of the same kind. Every rank is taken to "
      "be as fast as that process. Blocks are handed out by the real scheduler on a simulated clock, rays are divided evenly, and all else is "
      "done by rank 0.",
      shares.measured_blocks, shares.run.block_seconds.size());
  page.SetOrigin(command);
  if (const std::string verdict = ShareVerdict(shares); !verdict.empty()) page.verdicts.push_back(verdict);
  page::Curve share{.name = "share of rank 0", .points = {}, .marks = true};
  for (const RankShareRow& row : shares.rows) share.points.emplace_back(row.ranks, 100.0 * row.Share());
  page.sections.push_back(
      {.id = "ranks",
       .title = "By number of ranks",
       .lead = "",
       .charts = {page::CurveChart({share}, {.title = "Rank 0 alone", .x_label = "ranks", .y_label = "share of the time (%)", .log_x = true})},
       .tables = {SharesTable(shares), WorkTable(shares)},
       .pictures = {}});
  return page;
}

std::string RankSharesJson(const RankShares& shares, const std::string& command) {
  using nlohmann::json;
  json rows = json::array(), stages = json::array();
  for (const RankShareRow& row : shares.rows) {
    rows.push_back({{"ranks", row.ranks},
                    {"wall_s", row.WallSeconds()},
                    {"rank_0_s", row.own_s},
                    {"rays_s", row.divided_s},
                    {"blocks_s", row.blocks_s},
                    {"rank_0_share", row.Share()}});
  }
  for (const StageWork& stage : shares.run.stages)
    stages.push_back({{"stage", stage.name}, {"rank_0_s", stage.own_s}, {"divided_s", stage.divided_s}});
  const json all = {{"bench", "schedule"},
                    {"command", command},
                    {"machine", base::MachineDescription()},
                    {"date", base::UtcTimestamp()},
                    {"blocks", shares.run.block_seconds.size()},
                    {"measured_blocks", shares.measured_blocks},
                    {"stages", std::move(stages)},
                    {"rows", std::move(rows)}};
  return base::JsonText(all, 2) + "\n";
}

}  // namespace skyquilt::bench
