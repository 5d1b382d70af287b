// Trainings that would fall apart, are made to, or are worse than the context.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>

#include "core/base/random.h"
#include "core/scene/field_file.h"
#include "tests/worker/small_survey.h"
#include "worker/trainer.h"

namespace skyquilt::worker {
namespace {

class StabilityTest : public SmallSurvey {
 protected:
  render::TrainedField Field(const std::string& name) const { return scene::GetField(checkpoint::ArchiveReader(folder_ / name), folder_ / name, ""); }
  TrainResult Block(const TrainJob& job, int n_threads = 2) const {
    base::ThreadPool threads(n_threads);
    return TrainBlock(job, Box(12.0, 1.0), folder_ / "context.h5", threads, {});
  }
  void Context(int steps) const {
    base::ThreadPool threads(2);
    ASSERT_TRUE(TrainContext(Job("context.h5", steps), Box(20.0, 0.0), threads, {}).ok);
  }
  // A job whose learning rate is a hundred times too high in the steps [from, to).
  TrainJob Faulty(const std::string& name, int steps, int64_t from, int64_t to) const {
    TrainJob job = Job(name, steps);
    job.rate_fault = [from, to](int64_t step) { return step >= from && step < to ? 100.0 : 1.0; };
    return job;
  }
};

TEST_F(StabilityTest, AFallIsTakenBackAndTrainingGoesOn) {
  Context(200);
  // The fault does not come back when training goes over these steps again.
  int64_t farthest = -1;
  TrainJob job = Job("block.h5", 900);
  job.rate_fault = [&farthest](int64_t step) {
    const bool again = step <= farthest;
    farthest = std::max(farthest, step);
    return step >= 400 && step < 440 && !again ? 100.0 : 1.0;
  };
  const TrainResult result = Block(job);
  ASSERT_TRUE(result.ok) << result.reason;
  ASSERT_EQ(result.falls.size(), 1U);
  const Fall& fall = result.falls.front();
  EXPECT_GT(fall.step, 400);
  EXPECT_LE(fall.step, 500);
  EXPECT_LE(fall.restored_step, 400);
  EXPECT_LT(fall.psnr_db, fall.best_psnr_db - 1.0);
  EXPECT_FALSE(result.ended_early);
  EXPECT_EQ(result.steps, 900);
  EXPECT_GT(result.final_psnr_db, fall.best_psnr_db);
  EXPECT_FALSE(result.ShowsContext());
}

TEST_F(StabilityTest, AfterSeveralFallsItEndsAtItsBestState) {
  Context(200);
  const TrainResult result = Block(Faulty("block.h5", 1500, 1000, 100'000));
  ASSERT_TRUE(result.ok) << result.reason;
  EXPECT_TRUE(result.ended_early);
  EXPECT_EQ(result.falls.size(), 3U);
  EXPECT_LE(result.steps, 1000);
  EXPECT_NEAR(result.final_psnr_db, result.falls.front().best_psnr_db, 0.8);
  // All of it is in the checkpoint.
  const TrainResult again = Block(Job("block.h5", 1500));
  EXPECT_TRUE(again.ended_early);
  ASSERT_EQ(again.falls.size(), 3U);
  EXPECT_EQ(again.falls[2].step, result.falls[2].step);
}

TEST_F(StabilityTest, KilledInTheMiddleOfAFallItEndsWithTheSameBits) {
  Context(120);
  const auto faulty = [this](const std::string& name) { return Faulty(name, 700, 400, 470); };
  const TrainResult whole = Block(faulty("whole.h5"), 1);
  ASSERT_TRUE(whole.ok) << whole.reason;
  ASSERT_FALSE(whole.falls.empty());
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    TrainJob job = faulty("killed.h5");
    job.options.checkpoint_every_s = 0.05;
    const auto fault = job.rate_fault;
    job.rate_fault = [fault](int64_t step) {
      if (step == 410) raise(SIGKILL);
      return fault(step);
    };
    Block(job, 1);
    _exit(1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  const TrainResult resumed = Block(faulty("killed.h5"), 3);
  ASSERT_TRUE(resumed.ok) << resumed.reason;
  EXPECT_EQ(resumed.falls.size(), whole.falls.size());
  EXPECT_EQ(Bytes("killed.h5"), Bytes("whole.h5"));
}

// Half of the ground is water that is too dark for two colours and too bright for the third, with glints that change from photo to photo. With slopes
// at the ends of the colours' range that are not theirs, both seeds end at 12 to 13 dB: the networks push outwards until everything is opaque.
TEST_F(StabilityTest, ClippedWaterDoesNotPushTheNetworksOut) {
  base::Random random(1, 2);
  Photograph([&](int, int c, double value, double) {
    if (value > 0.5) return value;             // land, by its brightness
    if (random.Uniform() < 0.01F) return 1.0;  // glints
    return c == 2 ? 1.0 : 0.0;
  });
  Context(200);
  for (const uint64_t seed : {1ULL, 2ULL}) {
    TrainJob job = Job("block" + std::to_string(seed) + ".h5", 1200);
    job.seed = seed;
    const TrainResult result = Block(job);
    ASSERT_TRUE(result.ok) << result.reason;
    EXPECT_TRUE(result.falls.empty()) << seed;
    EXPECT_GT(result.final_psnr_db, 23.0) << seed;
  }
}

TEST_F(StabilityTest, ABlockThatIsWorseThanTheContextSaysSoAndIsTrainedAnewOnRequest) {
  Context(500);
  const TrainResult poor = Block(Job("block.h5", 10));
  ASSERT_TRUE(poor.ok) << poor.reason;
  ASSERT_TRUE(poor.comparison);
  EXPECT_TRUE(poor.ShowsContext());
  EXPECT_LT(poor.comparison->block_psnr_db, poor.comparison->context_psnr_db);
  // The same attempt is finished; the next one begins anew.
  EXPECT_EQ(Block(Job("block.h5", 1200)).steps, 10);
  TrainJob second = Job("block.h5", 1200);
  second.attempt = 1;
  const TrainResult better = Block(second);
  ASSERT_TRUE(better.ok) << better.reason;
  EXPECT_EQ(better.steps, 1200);
  EXPECT_FALSE(better.ShowsContext());
  EXPECT_GT(better.comparison->block_psnr_db, better.comparison->context_psnr_db - 0.1);
  // A good one is kept, whatever the attempt.
  second.attempt = 2;
  second.options.steps = 1300;
  EXPECT_EQ(Block(second).steps, 1200);
}

TEST_F(StabilityTest, IndependentBlocksAreNotCompared) {
  Context(100);
  TrainJob job = Job("block.h5", 10);
  job.options.coupling = "independent";
  const TrainResult result = Block(job);
  ASSERT_TRUE(result.ok) << result.reason;
  EXPECT_FALSE(result.comparison);
}

// Samples are then wider than a cell, so that none can tell single cells apart.
TEST_F(StabilityTest, VoxelsFarTooFineDoNotEraseTheSurface) {
  base::ThreadPool threads(2);
  BlockSpec area = Box(20.0, 0.0);
  area.finest_voxel_m = 0.12;  // a pixel is 0.6 m
  area.log2_table_size = 15;
  ASSERT_TRUE(TrainContext(Job("context.h5", 500), area, threads, {}).ok);
  const render::TrainedField field = Field("context.h5");
  EXPECT_EQ(std::count(field.occupancy.judged.begin(), field.occupancy.judged.end(), 1), 0) << "not the case that is tested";
  render::FieldSet set;
  set.context = &field;
  std::vector<render::Ray> rays;
  for (double x = -10.0; x <= 10.0; x += 2.0) rays.push_back({.origin_enu = {x, 7.0, 30.0}, .direction_enu = {0, 0, -1}, .pixel_pitch = 0.02F});
  std::vector<render::RayColor> out(rays.size());
  render::RenderRays(set, rays, out, {}, threads);
  for (const render::RayColor& color : out) {
    EXPECT_GT(color.opacity, 0.9F);
    EXPECT_NEAR(color.depth_median, 30.0F, 2.5F);
  }
}

TEST_F(StabilityTest, DiagnosticsHaveARowPerStep) {
  base::ThreadPool threads(2);
  TrainJob job = Job("context.h5", 30);
  job.diagnostics = folder_ / "context.diagnostics.csv";
  ASSERT_TRUE(TrainContext(job, Box(20.0, 0.0), threads, {}).ok);
  const std::string text = base::ReadFile(job.diagnostics);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 31);
  EXPECT_TRUE(text.starts_with("step,loss,batch_psnr,")) << text.substr(0, 60);
}

}  // namespace
}  // namespace skyquilt::worker
