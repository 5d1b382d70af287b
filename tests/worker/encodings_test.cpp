// Fields with every encoding learn the small survey, as block and as context; shallow hash grids do so in train_block_test.cpp.
#include <gtest/gtest.h>

#include "core/encoding/encoding.h"
#include "tests/worker/small_survey.h"
#include "worker/trainer.h"

namespace skyquilt::worker {
namespace {

struct Baseline {
  encoding::Kind encoding;
  int density_hidden_layers;
  double learning_rate;
};

class EncodingTest : public SmallSurvey, public ::testing::WithParamInterface<Baseline> {
 protected:
  TrainJob JobWith(const std::string& name, int steps) const {
    TrainJob job = Job(name, steps);
    job.options.encoding = encoding::Name(GetParam().encoding);
    job.options.density_hidden_layers = GetParam().density_hidden_layers;
    job.options.learning_rate = GetParam().learning_rate;
    return job;
  }
};

TEST_P(EncodingTest, LearnsWithBitsThatDoNotDependOnThreads) {
  base::ThreadPool one(1), two(2);
  ASSERT_TRUE(TrainContext(Job("context.h5", 100), Box(20.0, 0.0), two, {}).ok);
  const TrainResult early = TrainBlock(JobWith("early.h5", 15), Box(12.0, 1.0), folder_ / "context.h5", two, {});
  const TrainResult late = TrainBlock(JobWith("one.h5", 300), Box(12.0, 1.0), folder_ / "context.h5", one, {});
  ASSERT_TRUE(early.ok && late.ok) << early.reason << late.reason;
  EXPECT_GT(late.final_psnr_db, early.final_psnr_db + 3.0);
  EXPECT_GT(late.final_psnr_db, 20.0);
  EXPECT_EQ(late.dropped_steps, 0);
  TrainBlock(JobWith("two.h5", 300), Box(12.0, 1.0), folder_ / "context.h5", two, {});
  EXPECT_EQ(Bytes("one.h5"), Bytes("two.h5"));
}

TEST_P(EncodingTest, IsGoodForAContextToo) {
  base::ThreadPool two(2);
  const TrainResult context = TrainContext(JobWith("context.h5", 200), Box(20.0, 0.0), two, {});
  ASSERT_TRUE(context.ok) << context.reason;
  EXPECT_GT(context.final_psnr_db, 18.0);
  const TrainResult block = TrainBlock(Job("block.h5", 50), Box(12.0, 1.0), folder_ / "context.h5", two, {});
  EXPECT_TRUE(block.ok) << block.reason;
}

INSTANTIATE_TEST_SUITE_P(Kinds, EncodingTest,
                         ::testing::Values(Baseline{encoding::Kind::kHash, 2, 3e-2}, Baseline{encoding::Kind::kVoxels, 1, 3e-2},
                                           Baseline{encoding::Kind::kPlanes, 1, 3e-2}, Baseline{encoding::Kind::kFrequency, 3, 3e-3}),
                         [](const auto& of) { return encoding::Name(of.param.encoding) + std::to_string(of.param.density_hidden_layers); });

}  // namespace
}  // namespace skyquilt::worker
