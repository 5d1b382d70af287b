#include "evaluate/train_log.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate {
namespace {

class TrainLogFiles : public testing::Test {
 protected:
  void Write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  TemporaryFolder folder_;
};

TEST(ParseCurve, ReadsColumnsByName) {
  const auto curve = ParseCurve("seconds,step,psnr,loss,more\n1.5,100,20.5,0.01,9\n3.0,200,22.5,0.005,9\n");
  ASSERT_EQ(curve.size(), 2U);
  EXPECT_DOUBLE_EQ(curve[1].step, 200.0);
  EXPECT_DOUBLE_EQ(curve[1].seconds, 3.0);
  EXPECT_DOUBLE_EQ(curve[1].loss, 0.005);
  EXPECT_DOUBLE_EQ(curve[1].psnr_db, 22.5);
}

TEST(ParseCurve, SkipsTornLinesAndMarksWhatIsNotANumber) {
  const auto curve = ParseCurve("step,seconds,loss,psnr\r\n1,0.1,nonsense,10\r\n2,0.2\n3,0.3,0.5,11");
  ASSERT_EQ(curve.size(), 2U);
  EXPECT_TRUE(std::isnan(curve[0].loss));
  EXPECT_DOUBLE_EQ(curve[0].psnr_db, 10.0);
  EXPECT_DOUBLE_EQ(curve[1].loss, 0.5);
  EXPECT_TRUE(ParseCurve("").empty());
}

TEST_F(TrainLogFiles, MissingOrDamagedFilesGiveAnEmptyLog) {
  EXPECT_FALSE(ReadTrainLog(folder_ / "train.json", folder_.path()).found);
  Write("train.json", "{\"ranks\": 2, \"fie");
  EXPECT_FALSE(ReadTrainLog(folder_ / "train.json", folder_.path()).found);
  EXPECT_TRUE(std::isnan(TrainLog{}.TrainSeconds()));
  EXPECT_TRUE(std::isnan(TrainLog{}.SamplesPerSecond()));
}

TEST_F(TrainLogFiles, ReadsFieldsAndTheirCurves) {
  Write("train.json", R"({"ranks":2,"threads":4,"wall_seconds":50,"peak_rss_bytes":1000,"fields":[
    {"name":"context","ok":true,"reason":"","steps":10,"seconds":20,"samples":1000,"rays":100,"parameters":7,"psnr_db":21.5,"dropped_steps":0,
     "stage_seconds":{"hash forward":1.5,"compose":null}},
    {"name":"r0c0","ok":false,"reason":"loss not finite","steps":5,"seconds":30,"samples":3000,"psnr_db":null}]})");
  Write("context.log.csv", "step,seconds,loss,psnr\n1,1,0.5,10\n");
  Write("block_r0c0.log.csv", "step,seconds,loss,psnr\n1,1,0.5,10\n2,2,0.4,11\n");
  const TrainLog log = ReadTrainLog(folder_ / "train.json", folder_.path());
  ASSERT_TRUE(log.found);
  ASSERT_EQ(log.fields.size(), 2U);
  EXPECT_EQ(log.ranks, 2);
  EXPECT_EQ(log.Find("context")->parameters, 7);
  EXPECT_EQ(log.Find("context")->curve.size(), 1U);
  ASSERT_EQ(log.Find("context")->stage_seconds.size(), 1U);
  EXPECT_EQ(log.Find("context")->stage_seconds.front().first, "hash forward");
  EXPECT_DOUBLE_EQ(log.SamplesPerRay(), 40.0);
  EXPECT_EQ(log.Find("r0c0")->curve.size(), 2U);
  EXPECT_FALSE(log.Find("r0c0")->ok);
  EXPECT_TRUE(std::isnan(log.Find("r0c0")->psnr_db));
  EXPECT_EQ(log.Find("r9c9"), nullptr);
  EXPECT_DOUBLE_EQ(log.TrainSeconds(), 50.0);
  EXPECT_DOUBLE_EQ(log.SamplesPerSecond(), 80.0);
}

TEST(TrainLog, ShortLastSessionDoesNotFlatterTheSpeed) {
  TrainLog log;
  log.ranks = 2;
  log.wall_seconds = 0.1;  // everything was already trained
  log.fields.resize(2);
  log.fields[0].seconds = 100.0;
  log.fields[0].samples = 5000;
  log.fields[1].seconds = 60.0;
  log.fields[1].samples = 3000;
  EXPECT_DOUBLE_EQ(log.TrainSeconds(), 80.0);
  EXPECT_DOUBLE_EQ(log.SamplesPerSecond(), 100.0);
}

}  // namespace
}  // namespace skyquilt::evaluate
