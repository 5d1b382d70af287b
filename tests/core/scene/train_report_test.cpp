#include "core/scene/train_report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/base/errors.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::scene {
namespace {

class TrainReportFile : public testing::Test {
 protected:
  void Write(const std::string& text) const { std::ofstream(file_) << text; }
  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "train.json";
};

TEST_F(TrainReportFile, IsReadBackAsItWasWritten) {
  TrainReport report{.ranks = 3, .threads = 2, .wall_seconds = 31.5, .config_hash = "abc", .fields = {}};
  FieldTraining context{.name = "context", .ok = true, .steps = 10, .seconds = 20.25, .samples = (int64_t{1} << 60) + 1, .rays = 100};
  context.peak_rss_bytes = 1000;
  context.falls = {{700, 24.8, 12.1, 640}};
  context.ended_early = true;
  context.phase_seconds = {{"compose", 0.5}, {"hash forward", 1.5}};
  FieldTraining failed{.name = "r0c1",
                       .block = 1,
                       .reason = "diverged",
                       .psnr_db = std::nan(""),
                       .block_psnr_db = 15.0,
                       .context_psnr_db = 19.5,
                       .shows_context = true,
                       .attempts = 3,
                       .rank = 2};
  report.fields = {context, failed};
  WriteTrainReport(report, file_);
  const TrainReport back = ReadTrainReport(file_);
  EXPECT_EQ(back.ranks, 3);
  EXPECT_EQ(back.config_hash, "abc");
  EXPECT_EQ(back.wall_seconds, 31.5);
  EXPECT_EQ(back.PeakRssBytes(), 1000);
  ASSERT_EQ(back.fields.size(), 2U);
  EXPECT_EQ(back.Find("context")->samples, context.samples);
  EXPECT_EQ(back.Find("context")->block, -1);
  EXPECT_EQ(back.Find("context")->phase_seconds, context.phase_seconds);
  ASSERT_EQ(back.Find("context")->falls.size(), 1U);
  EXPECT_EQ(back.Find("context")->falls[0].step, 700);
  EXPECT_EQ(back.Find("context")->falls[0].best_psnr_db, 24.8);
  EXPECT_EQ(back.Find("context")->falls[0].psnr_db, 12.1);
  EXPECT_EQ(back.Find("context")->falls[0].restored_step, 640);
  EXPECT_TRUE(back.Find("context")->ended_early);
  EXPECT_TRUE(std::isnan(back.Find("context")->block_psnr_db));
  EXPECT_TRUE(back.Find("r0c1")->shows_context);
  EXPECT_EQ(back.Find("r0c1")->context_psnr_db, 19.5);
  EXPECT_TRUE(std::isnan(back.Find("r0c1")->psnr_db));
  EXPECT_EQ(back.Find("r0c1")->attempts, 3);
  EXPECT_EQ(back.Find("r9c9"), nullptr);
  EXPECT_EQ(back.Failed(), std::vector<std::string>{"block_r0c1: diverged"});
}

TEST_F(TrainReportFile, MissingOrDamagedIsAnErrorThatNamesTheFile) {
  EXPECT_FALSE(TryReadTrainReport(file_).has_value());
  EXPECT_THROW(ReadTrainReport(file_), base::InputError);
  for (const char* text : {"{\"ranks\": 2, \"fie", "[1, 2]", "{\"ranks\": 2}"}) {
    Write(text);
    EXPECT_FALSE(TryReadTrainReport(file_).has_value()) << text;
    const auto error = Caught<base::InputError>([&] { ReadTrainReport(file_); });
    ASSERT_TRUE(error) << text;
    EXPECT_EQ(error->file(), file_);
  }
}

TEST_F(TrainReportFile, LeavesOutValuesOfTheWrongType) {
  Write(R"({"ranks":2,"threads":"four","wall_seconds":50,"fields":[
    {"name":"context","ok":true,"seconds":20,"samples":1000,"rays":100,"parameters":7,"psnr_db":21.5,
     "phase_seconds":{"hash forward":1.5,"compose":null}}, 5,
    {"name":"r0c0","ok":false,"reason":"loss not finite","seconds":30,"samples":3000,"psnr_db":null}]})");
  const TrainReport report = ReadTrainReport(file_);
  ASSERT_EQ(report.fields.size(), 2U);
  EXPECT_EQ(report.threads, 0);
  EXPECT_EQ(report.fields[0].phase_seconds, (std::map<std::string, double>{{"hash forward", 1.5}}));
  EXPECT_TRUE(std::isnan(report.fields[1].psnr_db));
  EXPECT_DOUBLE_EQ(report.SamplesPerRay(), 40.0);
  EXPECT_DOUBLE_EQ(report.TrainSeconds(), 50.0);
  EXPECT_DOUBLE_EQ(report.SamplesPerSecond(), 80.0);
}

TEST(TrainReport, ShortLastSessionDoesNotInflateTheSpeed) {
  TrainReport report;
  EXPECT_TRUE(std::isnan(report.TrainSeconds()));
  EXPECT_TRUE(std::isnan(report.SamplesPerSecond()));
  report.ranks = 2;
  report.wall_seconds = 0.1;  // everything was already trained
  report.fields.resize(2);
  report.fields[0].seconds = 100.0;
  report.fields[0].samples = 5000;
  report.fields[1].seconds = 60.0;
  report.fields[1].samples = 3000;
  EXPECT_DOUBLE_EQ(report.TrainSeconds(), 80.0);
  EXPECT_DOUBLE_EQ(report.SamplesPerSecond(), 100.0);
}

}  // namespace
}  // namespace skyquilt::scene
