// Trainings with a code per photo, and with other activations of density.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <vector>

#include "core/render/ray_engine.h"
#include "core/scene/field_file.h"
#include "tests/worker/small_survey.h"
#include "worker/trainer.h"

namespace skyquilt::worker {
namespace {

class AppearanceTest : public SmallSurvey {
 protected:
  // Every second photo shows less red and more blue, which no exposure tag tells. The held-out photos 0 and 8 are of the first kind.
  void SetUp() override {
    Photograph([](int photo, int c, double value, double) { return photo % 2 == 0 ? value : value * (c == 0 ? 0.6 : c == 1 ? 0.8 : 1.25); });
  }
  // numbers: of a code. Colours do not depend on the direction, from which few photos could also be told apart.
  TrainJob CodedJob(const std::string& name, int steps, int numbers = 5) const {
    TrainJob job = Job(name, steps);
    job.options.appearance_codes = numbers;
    job.options.sh_degree = 1;
    return job;
  }
  TrainResult Context(const TrainJob& job) const {
    base::ThreadPool threads(2);
    return TrainContext(job, Box(20.0, 0.0), threads, {});
  }
  TrainResult Block(const TrainJob& job, int n_threads = 2) const {
    base::ThreadPool threads(n_threads);
    return TrainBlock(job, Box(12.0, 1.0), folder_ / "context.h5", threads, {});
  }
  std::vector<float> Array(const std::string& file, const std::string& name) const { return checkpoint::ArchiveReader(folder_ / file).Floats(name); }
  // All that is learned.
  std::string AllBytes(const std::string& file) const {
    std::string bytes = Bytes(file);
    for (const char* name : {"appearance/codes", "appearance/moment1", "appearance/moment2"}) {
      for (const float value : Array(file, name)) bytes += std::to_string(value) + " ";
    }
    return bytes;
  }
};

TEST_F(AppearanceTest, CodesTellThePhotosApartThatLookDifferent) {
  ASSERT_TRUE(Context(Job("context.h5", 200)).ok);
  const TrainResult without = Block(CodedJob("without.h5", 600, 0));
  const TrainResult with = Block(CodedJob("with.h5", 600));
  ASSERT_TRUE(without.ok && with.ok) << without.reason << with.reason;
  EXPECT_GT(with.final_psnr_db, without.final_psnr_db + 4.0);
  const std::vector<float> codes = Array("with.h5", "appearance/codes");
  ASSERT_EQ(codes.size(), 16U * 5U);
  const auto apart = [&](size_t a, size_t b) {
    double squares = 0.0;
    for (size_t k = 0; k < 5; ++k) squares += std::pow(static_cast<double>(codes[5 * a + k] - codes[5 * b + k]), 2.0);
    return std::sqrt(squares);
  };
  EXPECT_GT(apart(2, 5), 3.0 * apart(2, 10));
  EXPECT_GT(apart(2, 5), 3.0 * apart(5, 9));
  // Held-out photos have none, and zero is the mean of the others.
  const std::vector<int64_t> steps = checkpoint::ArchiveReader(folder_ / "with.h5").Ints("appearance/steps");
  for (const size_t photo : {0U, 8U}) {
    EXPECT_EQ(steps[photo], 0) << photo;
    for (size_t k = 0; k < 5; ++k) EXPECT_EQ(codes[5 * photo + k], 0.0F);
  }
  for (size_t k = 0; k < 5; ++k) {
    double sum = 0.0;
    for (size_t photo = 0; photo < 16; ++photo) sum += static_cast<double>(codes[5 * photo + k]);
    EXPECT_NEAR(sum, 0.0, 1e-4);
  }
}

// Photos of every look from one to another: a rendering is in the middle of them, everywhere.
TEST_F(AppearanceTest, RenderingsShowTheMeanLook) {
  std::filesystem::remove(folder_ / "pixels.bin");
  Photograph([](int photo, int c, double value, double) {
    const double share = photo * 7 % 16 / 15.0;  // neighbours differ
    return value * (c == 0 ? 0.6 + 0.4 * share : c == 2 ? 1.2 - 0.4 * share : 1.0);
  });
  ASSERT_TRUE(Context(CodedJob("context.h5", 300)).ok);
  ASSERT_TRUE(Block(CodedJob("block.h5", 1000)).ok);
  const render::TrainedField field = scene::GetField(checkpoint::ArchiveReader(folder_ / "block.h5"), folder_ / "block.h5", "");
  EXPECT_EQ(field.config.appearance, 5);
  render::FieldSet set;
  set.blocks = {&field};
  std::vector<render::Ray> rays;
  for (double x = -10.0; x <= 10.0; x += 1.0) {
    for (const double y : {-8.0, 7.0}) rays.push_back({.origin_enu = {x, y, 30.0}, .direction_enu = {0, 0, -1}, .pixel_pitch = 0.02F});
  }
  std::vector<render::RayColor> out(rays.size());
  base::ThreadPool threads(2);
  render::RenderRays(set, rays, out, {}, threads);
  double red = 0.0, blue = 0.0;
  for (size_t i = 0; i < rays.size(); ++i) {
    const Eigen::Vector3d color = SmallWorld::Shade(rays[i].origin_enu, rays[i].direction_enu);
    red += static_cast<double>(out[i].rgb_srgb[0]) / color[0] / static_cast<double>(rays.size());
    blue += static_cast<double>(out[i].rgb_srgb[2]) / color[2] / static_cast<double>(rays.size());
  }
  EXPECT_NEAR(red, 0.8, 0.08);
  EXPECT_NEAR(blue, 1.0, 0.08);
}

TEST_F(AppearanceTest, BitsDoNotDependOnThreads) {
  ASSERT_TRUE(Context(CodedJob("context.h5", 60)).ok);
  for (const int numbers : {1, 5, 8}) {
    ASSERT_TRUE(Block(CodedJob("one.h5", 60, numbers), 1).ok);
    ASSERT_TRUE(Block(CodedJob("three.h5", 60, numbers), 3).ok);
    EXPECT_EQ(AllBytes("one.h5"), AllBytes("three.h5")) << numbers;
    std::filesystem::remove(folder_ / "one.h5");
    std::filesystem::remove(folder_ / "three.h5");
  }
}

// Also over a fall, from which the codes go back with the field.
TEST_F(AppearanceTest, KilledItIsResumedWithTheSameBits) {
  ASSERT_TRUE(Context(CodedJob("context.h5", 120)).ok);
  const auto faulty = [this](const std::string& name) {
    TrainJob job = CodedJob(name, 600);
    job.rate_fault = [](int64_t step) { return step >= 400 && step < 470 ? 100.0 : 1.0; };
    return job;
  };
  const TrainResult whole = Block(faulty("whole.h5"), 1);
  ASSERT_TRUE(whole.ok) << whole.reason;
  ASSERT_FALSE(whole.falls.empty());
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    TrainJob job = faulty("killed.h5");
    job.options.checkpoint_every_s = 0.02;
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
  ASSERT_TRUE(std::filesystem::exists(folder_ / "killed.h5")) << "killed before anything was saved";
  ASSERT_TRUE(Block(faulty("killed.h5"), 3).ok);
  EXPECT_EQ(AllBytes("killed.h5"), AllBytes("whole.h5"));
}

// After the fall nothing learns any more: what is left is the state that it was taken back to, which another training reaches without a fall.
TEST_F(AppearanceTest, AFallTakesTheCodesBack) {
  ASSERT_TRUE(Context(CodedJob("context.h5", 120)).ok);
  TrainJob falling = CodedJob("falling.h5", 600);
  int64_t farthest = -1;
  falling.rate_fault = [&farthest](int64_t step) {
    const bool again = step <= farthest;
    farthest = again ? 600 : std::max(farthest, step);
    return again ? 0.0 : step >= 400 ? 100.0 : 1.0;
  };
  const TrainResult fallen = Block(falling);
  ASSERT_EQ(fallen.falls.size(), 1U);
  const int64_t good = fallen.falls.front().restored_step;
  TrainJob still = CodedJob("still.h5", 600);
  still.rate_fault = [good](int64_t step) { return step < good ? 1.0 : 0.0; };
  ASSERT_TRUE(Block(still).falls.empty());
  EXPECT_EQ(Array("falling.h5", "networks"), Array("still.h5", "networks"));
  const std::vector<float> codes = Array("falling.h5", "appearance/codes"), expected = Array("still.h5", "appearance/codes");
  ASSERT_EQ(codes.size(), expected.size());
  for (size_t i = 0; i < codes.size(); ++i) EXPECT_NEAR(codes[i], expected[i], 1e-6F) << i;
}

TEST_F(AppearanceTest, ACheckpointWithoutCodesHasNoneOfTheirArrays) {
  ASSERT_TRUE(Context(Job("context.h5", 20)).ok);
  const checkpoint::ArchiveReader reader(folder_ / "context.h5");
  for (const std::string& name : reader.Names()) EXPECT_EQ(name.find("appearance"), std::string::npos) << name;
  EXPECT_FALSE(reader.HasAttribute("appearance"));
  EXPECT_FALSE(reader.HasAttribute("density_activation"));
}

class ActivationTest : public SmallSurvey, public ::testing::WithParamInterface<const char*> {};

TEST_P(ActivationTest, LearnsAsContextAndBlockWithBitsThatDoNotDependOnThreads) {
  const auto job = [this](const std::string& name, int steps) {
    TrainJob with = Job(name, steps);
    with.options.density_activation = GetParam();
    return with;
  };
  base::ThreadPool one(1), two(2);
  const TrainResult context = TrainContext(job("context.h5", 300), Box(20.0, 0.0), two, {});
  ASSERT_TRUE(context.ok) << context.reason;
  EXPECT_GT(context.final_psnr_db, 18.0);
  const TrainResult block = TrainBlock(job("one.h5", 900), Box(12.0, 1.0), folder_ / "context.h5", one, {});
  ASSERT_TRUE(block.ok) << block.reason;
  EXPECT_GT(block.final_psnr_db, 24.0);
  EXPECT_EQ(block.dropped_steps, 0);
  TrainBlock(job("two.h5", 900), Box(12.0, 1.0), folder_ / "context.h5", two, {});
  EXPECT_EQ(Bytes("one.h5"), Bytes("two.h5"));
  // The depth of the box and of the ground, in a file that says how its density is to be read.
  const render::TrainedField field = scene::GetField(checkpoint::ArchiveReader(folder_ / "one.h5"), folder_ / "one.h5", "");
  EXPECT_EQ(field::Name(field.config.density_activation), GetParam());
  render::FieldSet set;
  set.blocks = {&field};
  const std::vector<render::Ray> rays = {{{0, 0, 30}, {0, 0, -1}}, {{8, 7, 30}, {0, 0, -1}}};
  std::vector<render::RayColor> out(2);
  render::RenderRays(set, rays, out, {}, two);
  EXPECT_NEAR(out[0].depth_median, 26.0F, 1.0F);
  EXPECT_NEAR(out[1].depth_median, 30.0F, 1.0F);
}

INSTANTIATE_TEST_SUITE_P(Activations, ActivationTest, ::testing::Values("exp", "softplus", "relu"), [](const auto& of) { return of.param; });

}  // namespace
}  // namespace skyquilt::worker
