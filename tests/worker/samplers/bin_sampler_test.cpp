// Samplers of bins and their proposal networks on the small survey.
#include "worker/samplers/bin_sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/scene/field_file.h"
#include "tests/support/error_of.h"
#include "tests/worker/small_survey.h"
#include "worker/step/step_taus.h"
#include "worker/trainer.h"

namespace skyquilt::worker {
namespace {

class SamplerTest : public SmallSurvey, public ::testing::WithParamInterface<const char*> {
 protected:
  TrainJob JobWith(const std::string& name, int steps) const {
    TrainJob job = Job(name, steps);
    job.options.sampler = GetParam();
    job.options.ray_samples = std::string(GetParam()) == "stratified" ? std::vector<double>{16, 24} : std::vector<double>{64, 64, 32};
    return job;
  }
};

// The context is trained with the sampler too, whose bins grow with distance there.
TEST_P(SamplerTest, LearnsTheSceneAndItsCells) {
  base::ThreadPool threads(2);
  const TrainResult context = TrainContext(JobWith("context.h5", 200), Box(20.0, 0.0), threads, {});
  ASSERT_TRUE(context.ok) << context.reason;
  const TrainResult block = TrainBlock(JobWith("block.h5", 500), Box(12.0, 1.0), folder_ / "context.h5", threads, {});
  ASSERT_TRUE(block.ok) << block.reason;
  EXPECT_GT(block.final_psnr_db, 22.0);
  EXPECT_EQ(block.dropped_steps, 0);
  // Rendering marches through the cells that were found at the end: the box's roof and the ground are in them, the air is not.
  const render::TrainedField field = scene::GetField(checkpoint::ArchiveReader(folder_ / "block.h5"), folder_ / "block.h5", "");
  EXPECT_LT(field.occupancy.OccupiedShare(), 0.8);
  const std::vector<render::RayColor> out = RoofAndGround(threads);
  EXPECT_NEAR(out[0].depth_median, 26.0F, 1.5F);
  EXPECT_NEAR(out[1].depth_median, 30.0F, 1.5F);
  EXPECT_GT(out[0].rgb_srgb[0], out[0].rgb_srgb[1] + 0.2F);
}

TEST_P(SamplerTest, BitsDoNotDependOnThreadsNorOnInterruption) {
  base::ThreadPool one(1), three(3);
  TrainContext(Job("context.h5", 40), Box(20.0, 0.0), three, {});
  TrainBlock(JobWith("a.h5", 90), Box(12.0, 1.0), folder_ / "context.h5", one, {});
  TrainBlock(JobWith("b.h5", 90), Box(12.0, 1.0), folder_ / "context.h5", three, {});
  EXPECT_EQ(Bytes("a.h5"), Bytes("b.h5"));
  TrainInterrupted(JobWith("c.h5", 90), [&](const TrainJob& job) { TrainBlock(job, Box(12.0, 1.0), folder_ / "context.h5", one, {}); });
  EXPECT_EQ(Bytes("a.h5"), Bytes("c.h5"));
}

INSTANTIATE_TEST_SUITE_P(Kinds, SamplerTest, ::testing::Values("stratified", "proposal"), [](const auto& of) { return std::string(of.param); });

TEST(BinSampler, RefusesSamplesThatItsPassesCannotHave) {
  TrainOptions options;
  options.sampler = "stratified";
  options.ray_samples = {64, 64, 32};
  EXPECT_NE(UsageErrorOf([&] { options.Check("train"); }).find("train.ray_samples"), std::string::npos);
  options.sampler = "proposal";
  options.Check("train");
  options.ray_samples = {64, 32.5};
  EXPECT_NE(UsageErrorOf([&] { options.Check("train"); }).find("whole numbers"), std::string::npos);
  EXPECT_EQ(SamplesPerPass(Sampler::kProposal, {}).size(), 3U);
  EXPECT_EQ(SamplesPerPass(Sampler::kStratified, {}).size(), 2U);
}

// A surface at a fifth of every ray, which a proposal network learns.
class ProposalTest : public ::testing::Test {
 protected:
  static constexpr int kRays = 40, kBins = 24, kFieldBins = 12;

  ProposalTest() : threads_(2), network_(Config(), 0.5, 0.01, threads_) {
    base::Random random(11);
    network_.Initialize(random);
    for (float& value : network_.parameters().grid) value = random.Uniform() - 0.5F;
    bins_.bins = kBins;
    for (int ray = 0; ray < kRays; ++ray) {
      const float x = random.Uniform(), y = random.Uniform();
      for (int k = 0; k <= kBins; ++k) bins_.edges.push_back(static_cast<float>(k) / kBins);
      for (int k = 0; k < kBins; ++k) {
        bins_.x.push_back(x);
        bins_.y.push_back(y);
        bins_.z.push_back((static_cast<float>(k) + 0.5F) / kBins);
        bins_.unit_length.push_back(2.0F);
      }
      for (int k = 0; k <= kFieldBins; ++k) edges_.push_back(0.15F + 0.1F * static_cast<float>(k) / kFieldBins);
      for (int k = 0; k < kFieldBins; ++k) weights_.push_back(0.9F / kFieldBins);
    }
    bins_.tau.resize(bins_.x.size());
  }
  static field::FieldConfig Config() {
    field::FieldConfig config;
    config.grid.base_resolution = 4;
    config.grid.finest_resolution = 32;
    config.density_bias = -2.0;
    return config;
  }
  void Evaluate() {
    network_.Prepare();
    StepTaus().Evaluate(network_.field(), network_.weights(), network_.parameters().grid, {bins_.x.data(), bins_.y.data(), bins_.z.data()},
                        static_cast<int64_t>(bins_.x.size()), bins_.tau.data());
    for (size_t i = 0; i < bins_.tau.size(); ++i) bins_.tau[i] *= bins_.unit_length[i];
  }
  // The loss as the header has it, in double.
  double Loss() {
    Evaluate();
    double sum = 0.0;
    InterlevelScratch scratch;
    std::vector<double> mass(kBins), gradient(kBins);
    for (size_t ray = 0; ray < kRays; ++ray) {
      BlurredWeights(kFieldBins, &edges_[ray * (kFieldBins + 1)], &weights_[ray * kFieldBins], 0.01, kBins, &bins_.edges[ray * (kBins + 1)], scratch,
                     mass.data());
      const std::vector<double> tau(&bins_.tau[ray * kBins], &bins_.tau[ray * kBins] + kBins);
      std::vector<double> own(kBins);
      WeightsOfTaus<double>(tau, own.data());
      sum += AddInterlevelLoss(1.0 / kRays, kBins, mass.data(), own.data(), gradient.data());
    }
    return sum;
  }
  double Learn(double rate) {
    const ProposalNetwork::Found found{&bins_, kFieldBins, edges_, weights_};
    return network_.Learn({&found, 1}, rate);
  }

  base::ThreadPool threads_;
  ProposalNetwork network_;
  ProposalBins bins_;
  std::vector<float> edges_, weights_;
};

// The first moments of Adam's first step are a tenth of the gradient.
TEST_F(ProposalTest, GradientMatchesFiniteDifferences) {
  const double expected = Loss();
  EXPECT_NEAR(Learn(1e-12), expected, 1e-4 * expected);
  const auto check = [&](std::vector<float>& values, const std::vector<float>& moments) {
    double largest = 0.0;
    for (const float m : moments) largest = std::max(largest, std::abs(static_cast<double>(m)));
    ASSERT_GT(largest, 0.0);
    int checked = 0, right = 0;
    for (size_t i = 0; i < values.size(); ++i) {
      const double gradient = 10.0 * static_cast<double>(moments[i]);
      if (std::abs(gradient) < largest) continue;  // a tenth of the largest
      const float keep = values[i], h = 2e-3F;
      values[i] = keep + h;
      const double above = Loss();
      values[i] = keep - h;
      const double numeric = (above - Loss()) / (2.0 * static_cast<double>(h));
      values[i] = keep;
      ++checked;
      if (std::abs(numeric - gradient) < 0.01 * std::abs(gradient)) ++right;
    }
    EXPECT_GT(checked, 20);
    EXPECT_GT(right, 0.8 * checked);  // of the others a ReLU turns on within h
  };
  const std::vector<float> network = network_.state().network_moment1, grid = network_.state().grid_moment1;
  check(network_.parameters().networks, network);
  check(network_.parameters().grid, grid);
}

TEST_F(ProposalTest, LearnsWhereTheFieldHasMatter) {
  const double before = Loss();
  for (int step = 0; step < 200; ++step) {
    Evaluate();
    Learn(1e-2);
  }
  EXPECT_LT(Loss(), 0.02 * before);
  std::vector<float> own(kBins);
  double near = 0.0;
  for (size_t ray = 0; ray < kRays; ++ray) {
    WeightsOfTaus(std::span<const float>(&bins_.tau[ray * kBins], kBins), own.data());
    for (size_t k = 3; k < 7; ++k) near += static_cast<double>(own[k]) / kRays;  // from 0.125 to 0.29
  }
  EXPECT_GT(near, 0.8);
}

TEST_F(ProposalTest, AStepThatIsNotFiniteChangesNothing) {
  Evaluate();
  const std::vector<float> grid = network_.parameters().grid, networks = network_.parameters().networks;
  weights_[3] = std::numeric_limits<float>::quiet_NaN();
  bins_.tau[5] = std::numeric_limits<float>::quiet_NaN();
  Learn(1e-2);
  EXPECT_EQ(network_.parameters().grid, grid);
  EXPECT_EQ(network_.parameters().networks, networks);
  EXPECT_EQ(network_.state().step, 0);
}

}  // namespace
}  // namespace skyquilt::worker
