#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "bench/bench_page.h"
#include "bench/kernel_bench.h"
#include "core/base/json_text.h"

namespace skyquilt::bench {
namespace {

KernelSpeed SpeedOf(int threads, double train, double limit) {
  KernelSpeed s;
  s.threads = threads;
  s.train_samples_per_second = train;
  s.infer_samples_per_second = 2.5 * train;
  s.roofline_train_samples_per_second = limit;
  s.roofline_infer_samples_per_second = 2.0 * limit;
  s.gflops_per_thread = 123.0;
  s.network_limit_s = 466.25e-9;
  s.gather_limit_s = 171.5e-9;
  s.scatter_limit_s = 262.75e-9;
  s.train_share[static_cast<size_t>(worker::Phase::kEncode)] = 0.25;
  s.train_share[static_cast<size_t>(worker::Phase::kScatter)] = 0.625;
  s.waiting_share = 0.125;
  return s;
}

KernelBenchResult TwoThreads() {
  KernelBenchResult result;
  result.isa = "AVX2";
  result.all = SpeedOf(2, 1.5e6, 2e6);
  result.one_thread = {SpeedOf(1, 0.8e6, 1e6)};
  result.train_flops = 56100.0;
  result.samplers = {{"stratified", {64, 128}, 193, 2e5, 0.0}, {"proposal", {64, 64, 32}, 32, 1e5, 5e4}};
  return result;
}

const BenchTable& TableOf(const BenchPage& page, const std::string& name) {
  for (const BenchSection& section : page.sections) {
    for (const BenchTable& table : section.tables) {
      if (table.name == name) return table;
    }
  }
  throw std::out_of_range("no table " + name);
}

TEST(KernelBenchPage, HasTheFiguresOfTheJson) {
  const KernelBenchResult result = TwoThreads();
  const BenchPage page = KernelBenchPage(result, "skyquilt bench kernel <-o out>");
  const nlohmann::json json = base::ParseJson(KernelBenchJson(result));
  const BenchTable& limit = TableOf(page, "limit");
  ASSERT_EQ(limit.rows.size(), 4U);
  EXPECT_EQ(limit.rows[0][1].value, json.at("train_samples_per_second"));
  EXPECT_EQ(limit.rows[0][2].value, json.at("roofline_train_samples_per_second"));
  EXPECT_EQ(limit.rows[0][3].value, json.at("roofline_fraction"));
  EXPECT_EQ(limit.rows[1][1].value, json.at("infer_samples_per_second"));
  const BenchTable& samplers = TableOf(page, "samplers");
  ASSERT_EQ(samplers.rows.size(), 2U);
  EXPECT_EQ(samplers.rows[0][1].shown, "64 + 128");
  EXPECT_EQ(samplers.rows[1][3].value, json.at("samplers").at("proposal").at("learn_rays_per_second"));
  // 1 / 100 k + 1 / 50 k seconds a ray beside 32 samples at 1.5 M/s.
  EXPECT_NEAR(samplers.rows[1][4].value, 30.0 / (30.0 + 32.0 / 1.5), 1e-9);
  EXPECT_EQ(limit.rows[1][2].value, json.at("roofline_infer_samples_per_second"));
  EXPECT_EQ(limit.rows[2][1].value, json.at("one_thread").at("train_samples_per_second"));
  const BenchTable& phases = TableOf(page, "phases");
  ASSERT_EQ(phases.rows.size(), json.at("share").size());
  for (const auto& row : phases.rows) {
    ASSERT_EQ(row.size(), phases.columns.size());
    const std::string key = row[0].shown == "waiting, bookkeeping" ? "waiting" : row[0].shown;
    EXPECT_EQ(row[1].value, json.at("share").at(key)) << key;
    EXPECT_EQ(row[3].value, json.at("one_thread").at("share").at(key)) << key;
    // Two threads process 1.5 samples per microsecond: 1333 ns of thread time per sample.
    EXPECT_NEAR(row[2].value, row[1].value * 4000.0 / 3.0, 1e-6) << key;
  }
  const BenchTable& machine = TableOf(page, "machine");
  const nlohmann::json& ns = json.at("limit_ns_per_sample_and_thread");
  EXPECT_EQ(machine.rows.at(0).at(1).value, ns.at("networks"));
  EXPECT_EQ(machine.rows.at(1).at(1).value, ns.at("random_reads"));
  EXPECT_EQ(machine.rows.at(2).at(1).value, ns.at("random_additions"));
  EXPECT_NEAR(machine.rows.at(3).at(1).value, 1000.0, 1e-9);  // 2 threads over 2 million samples per second
}

TEST(KernelBenchPage, IsOneOfflineFileWithBars) {
  const std::string html = BenchHtml(KernelBenchPage(TwoThreads(), "skyquilt bench kernel <-o out>"));
  EXPECT_EQ(html.find("http"), std::string::npos);
  EXPECT_EQ(html.find("<-o out>"), std::string::npos);
  EXPECT_NE(html.find("skyquilt bench kernel &lt;-o out&gt;"), std::string::npos);
  EXPECT_NE(html.find("class=\"limit\""), std::string::npos);
  EXPECT_NE(html.find("hash backward"), std::string::npos);
}

TEST(KernelBenchPage, HasNoOneThreadRowsWhenOnlyOneThreadIsUsed) {
  KernelBenchResult result = TwoThreads();
  result.all = result.one_thread.front();
  result.one_thread.clear();
  const BenchPage page = KernelBenchPage(result, "");
  EXPECT_EQ(TableOf(page, "limit").rows.size(), 2U);
  EXPECT_EQ(TableOf(page, "phases").columns.size(), 3U);
  EXPECT_EQ(TableOf(page, "machine").columns.size(), 2U);
  EXPECT_EQ(page.verdicts.size(), 1U);
}

TEST(KernelBenchPage, ShowsADashForNaN) {
  KernelBenchResult result = TwoThreads();
  result.all.infer_samples_per_second = std::numeric_limits<double>::quiet_NaN();
  const BenchPage page = KernelBenchPage(result, "");
  EXPECT_EQ(TableOf(page, "limit").rows.at(1).at(1).shown, "\xE2\x80\x93");
  for (const BenchFigure& figure : page.figures) EXPECT_EQ((figure.value + figure.note).find("nan"), std::string::npos) << figure.label;
  for (const BenchSection& section : page.sections) {
    for (const std::string& chart : section.charts) EXPECT_EQ(chart.find("nan"), std::string::npos) << section.id;
  }
}

}  // namespace
}  // namespace skyquilt::bench
