#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "bench/bench_page.h"
#include "bench/schedule_bench.h"
#include "core/base/json_text.h"

namespace skyquilt::bench {
namespace {

// For the default cluster: 10000 blocks of 600 s on 1000 ranks.
ScheduleBenchResult DefaultCluster() {
  ScheduleBenchResult result;
  result.work_s = 6e6;
  result.longest_s = 4500.0;
  result.undisturbed = {.wall_s = 6250.0,
                        .efficiency = 0.96,
                        .restarts = 0,
                        .moves = 12,
                        .messages_per_second = 1900.0,
                        .bytes_per_second = 420e3,
                        .coordinator_load = 0.014};
  result.failing = {.wall_s = 6750.0,
                    .efficiency = 0.889,
                    .restarts = 10,
                    .moves = 13,
                    .messages_per_second = 1800.0,
                    .bytes_per_second = 400e3,
                    .coordinator_load = 0.015};
  result.coordinator_bytes = 12 << 20;
  return result;
}

TEST(ScheduleBenchPage, HasTheFiguresOfTheJson) {
  const ScheduleBenchResult result = DefaultCluster();
  const BenchPage page = ScheduleBenchPage(result, "skyquilt bench schedule");
  const nlohmann::json json = base::ParseJson(ScheduleBenchJson(result));
  const BenchTable& runs = page.sections.at(0).tables.at(0);
  ASSERT_EQ(runs.rows.size(), 2U);
  for (size_t i = 0; i < 2; ++i) {
    const nlohmann::json& run = json.at(i == 0 ? "undisturbed" : "failing");
    const std::vector<BenchCell>& row = runs.rows[i];
    ASSERT_EQ(row.size(), runs.columns.size());
    EXPECT_EQ(row[1].value, run.at("efficiency"));
    EXPECT_EQ(row[2].value, run.at("wall_s"));
    EXPECT_EQ(row[3].value, run.at("restarts"));
    EXPECT_EQ(row[4].value, run.at("moves"));
    EXPECT_EQ(row[5].value, run.at("messages_per_second"));
    EXPECT_EQ(row[6].value, run.at("bytes_per_second"));
    EXPECT_EQ(row[7].value, run.at("coordinator_load"));
  }
}

TEST(ScheduleBenchPage, SharesOfTheRanksTimeSumToOne) {
  const BenchPage page = ScheduleBenchPage(DefaultCluster(), "skyquilt bench schedule");
  const BenchTable& time = page.sections.at(1).tables.at(0);
  for (const size_t run : {size_t{1}, size_t{2}}) {
    double sum = 0.0;
    for (const auto& row : time.rows) sum += row.at(run).value;
    EXPECT_NEAR(sum, 1.0, 1e-12);
  }
  EXPECT_NEAR(time.rows.at(2).at(2).value, 0.999 * 10 * 30.0 / 6750.0, 1e-12) << "ten restarts of 30 s, rank 0 counted elsewhere";
  EXPECT_EQ(time.rows.at(2).at(1).value, 0.0);
  EXPECT_EQ(page.sections.at(1).charts.size(), 2U);
}

TEST(ScheduleBenchPage, ChecksTargetsOnlyForTheDefaultCluster) {
  ScheduleBenchResult result = DefaultCluster();
  const BenchPage page = ScheduleBenchPage(result, "");
  ASSERT_EQ(page.verdicts.size(), 2U);
  EXPECT_NE(page.verdicts[0].find("is met"), std::string::npos) << page.verdicts[0];
  EXPECT_NE(page.verdicts[1].find("is missed"), std::string::npos) << page.verdicts[1];
  result.options.seed = 7;
  result.options.status_every_s = 5.0;
  result.options.measured_seconds = {30.0, 60.0};
  EXPECT_EQ(ScheduleBenchPage(result, "").verdicts.size(), 2U);
  result.options.ranks = 100;
  EXPECT_TRUE(ScheduleBenchPage(result, "").verdicts.empty());
  result.options.ranks = 1000;
  result.options.failing = 0.05;
  EXPECT_TRUE(ScheduleBenchPage(result, "").verdicts.empty());
}

TEST(ScheduleBenchPage, IsOneOfflineFileWithBars) {
  const std::string html = BenchHtml(ScheduleBenchPage(DefaultCluster(), "skyquilt bench schedule <--quick>"));
  EXPECT_EQ(html.find("http"), std::string::npos);
  EXPECT_EQ(html.find("<--quick>"), std::string::npos);
  EXPECT_NE(html.find("<rect class=\"bar"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::bench
