#include "core/trust/error_model.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/random.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::trust {
namespace {

struct Sample {
  std::vector<PixelFacts> facts;
  std::vector<float> squared_error;
};

// Pixels whose true mean squared error is residual * (1 + 20 gradient), with noise of an exponential distribution.
float TrueError(const PixelFacts& facts) {
  return std::exp(facts.evidence.log_residual) * (1.0F + 20.0F * facts.gradient);
}

Sample MakeSample(size_t n, uint64_t seed) {
  base::Random random(seed);
  Sample sample;
  for (size_t i = 0; i < n; ++i) {
    PixelFacts facts;
    facts.evidence = {.seen = true, .log_residual = -8.0F + 4.0F * random.Uniform(), .photos = 1.0F + 20.0F * random.Uniform()};
    facts.opacity = 0.9F + 0.1F * random.Uniform();
    facts.spread_pixels = 0.5F + 4.0F * random.Uniform();
    facts.gradient = 0.3F * random.Uniform() * random.Uniform();
    sample.facts.push_back(facts);
    sample.squared_error.push_back(-std::log(1.0F - random.Uniform() + 1e-7F) * TrueError(facts));
  }
  return sample;
}

TEST(ErrorModel, FindsWhatErrorsDependOnAndIsRightOnAverage) {
  const Sample fitted = MakeSample(20000, 1), fresh = MakeSample(20000, 2);
  const ErrorModel model(fitted.facts, fitted.squared_error);
  double expected = 0.0, found = 0.0, worst = 0.0;
  for (size_t i = 0; i < fresh.facts.size(); ++i) {
    const double error = static_cast<double>(model.RmsError(fresh.facts[i]));
    expected += error * error;
    found += static_cast<double>(fresh.squared_error[i]);
    worst = std::max(worst, std::abs(std::log(error * error / static_cast<double>(TrueError(fresh.facts[i])))));
  }
  EXPECT_NEAR(expected / found, 1.0, 0.05);
  EXPECT_LT(worst, 1.2);  // its features are not those of the truth
}

TEST(ErrorModel, KnowsThatPlacesThatNoPhotoShowsAreWorse) {
  Sample sample = MakeSample(4000, 3);
  for (size_t i = 0; i < 1000; ++i) {
    sample.facts[i].evidence = {};
    sample.squared_error[i] = 0.2F;
  }
  const ErrorModel model(sample.facts, sample.squared_error);
  PixelFacts unseen = sample.facts[2000];
  unseen.evidence = {};
  EXPECT_GT(model.RmsError(unseen), 2.0F * model.RmsError(sample.facts[2000]));
}

TEST(ErrorModel, OfFewPixelsIsTheirMean) {
  const Sample sample = MakeSample(50, 4);
  const ErrorModel model(sample.facts, sample.squared_error);
  double sum = 0.0;
  for (const float error : sample.squared_error) sum += static_cast<double>(error) / 50.0;
  for (const PixelFacts& facts : sample.facts) EXPECT_NEAR(static_cast<double>(model.RmsError(facts)), std::sqrt(sum), 0.02 * std::sqrt(sum) + 1e-3);
  EXPECT_GT(ErrorModel({}, {}).RmsError({}), 0.0F);
}

RC_GTEST_PROP(ErrorModel, IsFiniteForAnyFactsAndSample, ()) {
  const auto any = rc::gen::element(0.0F, 1e-30F, 0.01F, 0.5F, 1.0F, 1e30F, -1.0F, std::numeric_limits<float>::infinity(),
                                    std::numeric_limits<float>::quiet_NaN());
  const auto facts = [&] {
    return PixelFacts{
        {*rc::gen::arbitrary<bool>(), -5.0F * static_cast<float>(*rc::gen::inRange(0, 3)), static_cast<float>(*rc::gen::inRange(0, 300))},
        *any,
        *any,
        *any};
  };
  const size_t n = *rc::gen::element<size_t>(0, 1, 99, 150, 400);
  Sample sample;
  const PixelFacts same = facts();
  const bool alike = *rc::gen::arbitrary<bool>();
  for (size_t i = 0; i < n; ++i) {
    sample.facts.push_back(alike ? same : facts());
    sample.squared_error.push_back(*rc::gen::element(0.0F, 1e-6F, 0.3F, 1.0F));
  }
  const ErrorModel model(sample.facts, sample.squared_error);
  for (int i = 0; i < 20; ++i) {
    const float error = model.RmsError(facts());
    RC_ASSERT(std::isfinite(error));
    RC_ASSERT(error > 0.0F);
    RC_ASSERT(error <= 1.01F);
  }
}

TEST(ErrorModel, IsTheSameFromAFile) {
  const TemporaryFolder folder;
  const Sample sample = MakeSample(3000, 5);
  const ErrorModel model(sample.facts, sample.squared_error);
  checkpoint::ArchiveWriter writer("trust", 1);
  model.Put(writer);
  writer.Commit(folder / "model.h5");
  const ErrorModel again = ErrorModel::Get(checkpoint::ArchiveReader(folder / "model.h5"), folder / "model.h5");
  for (const PixelFacts& facts : sample.facts) ASSERT_EQ(model.RmsError(facts), again.RmsError(facts));
}

}  // namespace
}  // namespace skyquilt::trust
