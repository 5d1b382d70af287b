// Trainings whose rays are cones and come from photos of several sizes: bits, resuming and the stored range of footprints.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/scene/field_file.h"
#include "tests/worker/small_survey.h"
#include "worker/trainer.h"

namespace skyquilt::worker {
namespace {

struct Rays {
  std::string name;
  int multisample;
  std::vector<double> pyramid, pyramid_start;
  bool scale_features = false;
};

std::vector<double> AllSizes() {
  return {0.6, 0.2, 0.12, 0.08};
}

class TrainingWithCones : public SmallSurvey {
 protected:
  static TrainJob With(const Rays& rays, TrainJob job) {
    job.options.multisample = rays.multisample;
    job.options.pyramid = rays.pyramid;
    job.options.pyramid_start = rays.pyramid_start;
    job.options.scale_features = rays.scale_features;
    return job;
  }
  render::TrainedField Field(const std::string& name) const { return scene::GetField(checkpoint::ArchiveReader(folder_ / name), folder_ / name, ""); }
  void ExpectSame(const std::string& a, const std::string& b) const {
    EXPECT_EQ(Bytes(a), Bytes(b)) << a << " " << b;
    EXPECT_EQ(Field(a).occupancy.occupied, Field(b).occupancy.occupied) << a << " " << b;
    EXPECT_EQ(Field(a).footprint_min_m, Field(b).footprint_min_m) << a << " " << b;
    EXPECT_EQ(Field(a).footprint_max_m, Field(b).footprint_max_m) << a << " " << b;
  }
};

class ConesTest : public TrainingWithCones, public ::testing::WithParamInterface<Rays> {
 protected:
  TrainJob JobOf(const std::string& name, int steps) const { return With(GetParam(), Job(name, steps)); }
};

TEST_P(ConesTest, TrainTheSameBitsWithAnyNumberOfThreads) {
  for (const int n : {1, 3}) {
    base::ThreadPool threads(n);
    const std::string end = std::to_string(n) + ".h5";
    const TrainResult context = TrainContext(JobOf("context" + end, 20), Box(20.0, 0.0), threads, {});
    ASSERT_TRUE(context.ok) << context.reason;
    const TrainResult block = TrainBlock(JobOf("block" + end, 30), Box(12.0, 1.0), folder_ / ("context" + end), threads, {});
    ASSERT_TRUE(block.ok) << block.reason;
    EXPECT_EQ(block.dropped_steps, 0);
    EXPECT_EQ(Field("block" + end).config.multisample, GetParam().multisample);
    EXPECT_EQ(Field("block" + end).config.scale_features, GetParam().scale_features);
    if (n == 1) continue;
    ExpectSame("context1.h5", "context" + end);
    ExpectSame("block1.h5", "block" + end);
  }
}

TEST_P(ConesTest, ResumeWithTheSameBits) {
  base::ThreadPool threads(2);
  TrainContext(JobOf("context.h5", 20), Box(20.0, 0.0), threads, {});
  TrainBlock(JobOf("whole.h5", 40), Box(12.0, 1.0), folder_ / "context.h5", threads, {});
  TrainInterrupted(JobOf("resumed_context.h5", 20), [&](const TrainJob& job) { TrainContext(job, Box(20.0, 0.0), threads, {}); });
  TrainInterrupted(JobOf("resumed.h5", 40), [&](const TrainJob& job) { TrainBlock(job, Box(12.0, 1.0), folder_ / "context.h5", threads, {}); });
  ExpectSame("context.h5", "resumed_context.h5");
  ExpectSame("whole.h5", "resumed.h5");
}

TEST_P(ConesTest, LearnTheScene) {
  base::ThreadPool threads(2);
  ASSERT_TRUE(TrainContext(JobOf("context.h5", 100), Box(20.0, 0.0), threads, {}).ok);
  const TrainResult early = TrainBlock(JobOf("early.h5", 15), Box(12.0, 1.0), folder_ / "context.h5", threads, {});
  const TrainResult late = TrainBlock(JobOf("late.h5", 250), Box(12.0, 1.0), folder_ / "context.h5", threads, {});
  ASSERT_TRUE(early.ok && late.ok) << early.reason << late.reason;
  EXPECT_GT(late.final_psnr_db, early.final_psnr_db + 3.0);
  EXPECT_GT(late.final_psnr_db, 20.0);
}

INSTANTIATE_TEST_SUITE_P(Rays, ConesTest,
                         ::testing::Values(Rays{"points_of_all_sizes", 0, AllSizes(), {}}, Rays{"cones", 1, {1.0}, {}},
                                           Rays{"cones_of_all_sizes", 1, AllSizes(), {}},
                                           Rays{"cones_from_coarse_to_fine", 1, {1.0}, {0.0, 0.0, 1.0}}, Rays{"four_positions", 4, {1.0}, {}},
                                           Rays{"six_positions_of_all_sizes", 6, AllSizes(), {}},
                                           Rays{"cones_with_scale_features", 1, AllSizes(), {}, true},
                                           Rays{"four_positions_with_scale_features", 4, AllSizes(), {}, true}),
                         [](const auto& of) { return of.param.name; });

class FootprintRange : public TrainingWithCones {
 protected:
  render::TrainedField TrainedWith(const std::string& name, int multisample, const std::vector<double>& pyramid,
                                   const std::vector<double>& pyramid_start = {}) {
    base::ThreadPool threads(1);
    EXPECT_TRUE(TrainContext(With({name, multisample, pyramid, pyramid_start, false}, Job(name, 2)), Box(20.0, 0.0), threads, {}).ok);
    return Field(name);
  }
};

// The photos are from 30 to 32 m above the ground, and the field from 1 m below it to 6 m above. A pixel is a fiftieth of its distance wide.
TEST_F(FootprintRange, IsThatOfThePhotosPixels) {
  const render::TrainedField f = TrainedWith("context.h5", 1, {1.0});
  EXPECT_TRUE(f.config.Cones());
  EXPECT_GT(f.footprint_min_m, 0.8 * 24.0 / 50.0);
  EXPECT_LT(f.footprint_min_m, 30.0 / 50.0);
  EXPECT_GT(f.footprint_max_m, 30.0 / 50.0);
  EXPECT_LT(f.footprint_max_m, 33.0 / 50.0 * 1.2);
}

TEST_F(FootprintRange, CoversEverySizeThatIsEverDrawn) {
  const render::TrainedField full = TrainedWith("full.h5", 1, {1.0}), all = TrainedWith("all.h5", 1, AllSizes());
  const render::TrainedField half = TrainedWith("half.h5", 1, {0.0, 1.0}), schedule = TrainedWith("schedule.h5", 1, {0.0, 1.0}, {0.0, 0.0, 1.0});
  EXPECT_DOUBLE_EQ(all.footprint_min_m, full.footprint_min_m);
  EXPECT_DOUBLE_EQ(all.footprint_max_m, 8.0 * full.footprint_max_m);
  EXPECT_DOUBLE_EQ(half.footprint_min_m, 2.0 * full.footprint_min_m);
  EXPECT_DOUBLE_EQ(half.footprint_max_m, 2.0 * full.footprint_max_m);
  EXPECT_DOUBLE_EQ(schedule.footprint_min_m, 2.0 * full.footprint_min_m);
  EXPECT_DOUBLE_EQ(schedule.footprint_max_m, 4.0 * full.footprint_max_m);
}

TEST_F(FootprintRange, IsNotStoredWithPoints) {
  const render::TrainedField f = TrainedWith("points.h5", 0, AllSizes());
  EXPECT_FALSE(f.config.Cones());
  const checkpoint::ArchiveReader reader(folder_ / "points.h5");
  for (const char* name : {"multisample", "scale_features", "footprint_min_m", "footprint_max_m"}) EXPECT_FALSE(reader.HasAttribute(name)) << name;
}

// Photos at a quarter of the width have pixels four times as wide; so have the drawn quarter sizes of the photos.
TEST_F(FootprintRange, OfAReducedPhotoIsThatOfAPhotoTakenSoSmall) {
  const render::TrainedField quarter = TrainedWith("quarter.h5", 1, {0.0, 0.0, 1.0});
  std::vector<image::PixelSource> sources;
  for (const survey::Photo& photo : survey_.photos) sources.push_back({folder_ / photo.name, {}});
  base::ThreadPool threads(1);
  pixels_ = std::make_unique<image::PixelCache>(image::PixelCache::Open(folder_ / "small.bin", sources, kSmallWidth / 4, threads));
  const render::TrainedField small = TrainedWith("small.h5", 1, {1.0});
  EXPECT_NEAR(quarter.footprint_min_m / small.footprint_min_m, 1.0, 0.05);
  EXPECT_NEAR(quarter.footprint_max_m / small.footprint_max_m, 1.0, 0.05);
}

}  // namespace
}  // namespace skyquilt::worker
