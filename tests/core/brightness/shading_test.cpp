#include "core/brightness/shading.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numeric>

#include "core/base/errors.h"
#include "core/brightness/brightness_options.h"
#include "core/brightness/response_learner.h"
#include "core/brightness/unshade.h"
#include "tests/support/gradient_check.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::brightness {
namespace {

const ShadingGrid kGrid = {5, 4};

std::vector<float> SomeShading(size_t photos, const ShadingGrid& grid) {
  std::vector<float> values(photos * grid.knots());
  for (size_t i = 0; i < values.size(); ++i) values[i] = std::sin(0.7F * static_cast<float>(i)) + 0.3F;
  return values;
}

TEST(Shading, ReadsGridsAndRefusesOthers) {
  EXPECT_EQ(ShadingGrid::Parse("8x6"), (ShadingGrid{8, 6}));
  EXPECT_EQ(ShadingGrid::Parse("2x32"), (ShadingGrid{2, 32}));
  for (const char* text : {"", "8", "8x", "x6", "1x6", "8x33", "8x6x2", "-8x6", "8 x 6", "8x6 "}) EXPECT_FALSE(ShadingGrid::Parse(text)) << text;
}

TEST(Shading, BadOptionsNameTheOptionAndSayWhatIsAllowed) {
  const auto message = [](const auto& change) -> std::string {
    BrightnessOptions options;
    change(options);
    try {
      options.Check();
    } catch (const base::UsageError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message([](BrightnessOptions& o) { o.correction = "exif,gain,vignette,shading"; }), "");
  EXPECT_NE(message([](BrightnessOptions& o) { o.shading_grid = "8"; }).find("brightness.shading_grid = '8'"), std::string::npos);
  EXPECT_NE(message([](BrightnessOptions& o) { o.shading_grid = "1x6"; }).find("2 to 32"), std::string::npos);
  EXPECT_NE(message([](BrightnessOptions& o) { o.shading_sigma = 0.0; }).find("shading_sigma"), std::string::npos);
  EXPECT_NE(message([](BrightnessOptions& o) { o.correction = "shade"; }).find("shading"), std::string::npos);
}

TEST(Shading, IsLinearBetweenKnotsAndReachesTheBorders) {
  Response response = Response::Neutral(2, 1);
  EXPECT_EQ(response.LogShading(1, {0.5F, 0.5F}), 0.0F);
  response.AddShading(kGrid, 0.3F);
  for (size_t k = 0; k < kGrid.knots(); ++k) {  // 2 x + 3 y
    const auto column = static_cast<float>(k % 5), row = static_cast<float>(k / 5);
    response.shading[kGrid.knots() + k] = 2.0F * column / 4.0F + 3.0F * row / 3.0F;
  }
  for (const float x : {0.0F, 0.1F, 0.5F, 0.83F, 1.0F}) {
    for (const float y : {0.0F, 0.4F, 1.0F}) EXPECT_NEAR(response.LogShading(1, {x, y}), 2.0F * x + 3.0F * y, 1e-5F);
  }
  EXPECT_EQ(response.LogShading(0, {0.3F, 0.3F}), 0.0F);
  EXPECT_NEAR(response.ExposureOf(1, 0.0F, {0.5F, 0.5F})[1].gain, std::exp(2.5F), 1e-4F);
}

RC_GTEST_PROP(Shading, BothMeansAreZeroAfterTheProjectionAndItChangesNothingElse, ()) {
  const ShadingGrid grid = {*rc::gen::inRange(2, 9), *rc::gen::inRange(2, 9)};
  const auto photos = *rc::gen::inRange<size_t>(1, 7);
  const size_t knots = grid.knots();
  const auto learns = *rc::gen::container<std::vector<uint8_t>>(photos, rc::gen::inRange<uint8_t>(0, 2));
  const auto whole = *rc::gen::container<std::vector<int>>(photos * knots, rc::gen::inRange(-2000, 2000));
  std::vector<float> given, centred;
  for (const int value : whole) given.push_back(static_cast<float>(value) / 1000.0F);
  centred = given;
  CentreShading(grid, learns, centred);
  const std::vector<double> shares = KnotShares(grid);
  RC_ASSERT(std::abs(std::accumulate(shares.begin(), shares.end(), 0.0) - 1.0) < 1e-12);
  std::vector<double> of_knot(knots, 0.0);
  for (size_t i = 0; i < photos; ++i) {
    double of_photo = 0.0;
    for (size_t k = 0; k < knots; ++k) {
      const auto value = static_cast<double>(centred[i * knots + k]);
      if (learns[i] == 0) RC_ASSERT(centred[i * knots + k] == given[i * knots + k]);
      if (learns[i] != 0) of_knot[k] += value;
      of_photo += shares[k] * value;
    }
    if (learns[i] != 0) RC_ASSERT(std::abs(of_photo) < 1e-5);
  }
  for (const double sum : of_knot) RC_ASSERT(std::abs(sum) < 1e-5);
  // What was taken out is a value per photo plus a value per knot: mixed differences stay.
  std::vector<size_t> learned;
  for (size_t i = 0; i < photos; ++i) {
    if (learns[i] != 0) learned.push_back(i);
  }
  for (size_t n = 1; n < learned.size(); ++n) {
    const size_t a = learned[0] * knots, b = learned[n] * knots;
    for (size_t k = 1; k < knots; ++k) {
      const float before = given[a] - given[a + k] - given[b] + given[b + k], after = centred[a] - centred[a + k] - centred[b] + centred[b + k];
      RC_ASSERT(std::abs(before - after) < 1e-4F);
    }
  }
  std::vector<float> again = centred;
  CentreShading(grid, learns, again);
  for (size_t i = 0; i < again.size(); ++i) RC_ASSERT(std::abs(again[i] - centred[i]) < 1e-5F);
}

TEST(Shading, PriorHasTheGradientOfItsFormula) {
  const auto value = [](const std::vector<double>& s) {
    double sum = 0.0;
    for (size_t row = 0; row < 4; ++row) {
      for (size_t column = 0; column < 5; ++column) {
        const double at = s[5 * row + column];
        sum += 0.5 * at * at;
        if (column < 4) sum += 0.5 * kShadingSmoothness * std::pow(at - s[5 * row + column + 1], 2);
        if (row < 3) sum += 0.5 * kShadingSmoothness * std::pow(at - s[5 * row + column + 5], 2);
      }
    }
    return 0.7 * sum;
  };
  const std::vector<float> shading = SomeShading(1, kGrid);
  const std::vector<double> at(shading.begin(), shading.end());
  std::vector<double> gradient(at.size(), 0.0);
  AddShadingPrior(kGrid, std::span<const double>(at), 0.7, gradient);
  testing::ExpectGradient(value, at, gradient);
}

TEST(Shading, IsTakenOutOfAPhoto) {
  Response response = Response::Neutral(1, 1);
  response.AddShading({2, 2}, 0.3F);
  response.shading = {-std::log(2.0F), 0.0F, -std::log(2.0F), 0.0F};  // the left border has half of the light
  image::Image8 photo(100, 4, 3, 100);
  DivideByShading(PhotoShading::Of(response), 0, photo);
  EXPECT_NEAR(*photo.At(0, 1), 138, 1);  // twice the light of 100
  EXPECT_EQ(*photo.At(99, 1), 100);
  image::Image8 same(10, 4, 3, 100);
  DivideByShading(PhotoShading::Of(Response::Neutral(1, 1)), 0, same);
  EXPECT_EQ(*same.At(0, 0), 100);
}

// Pixels of two photos whose light is 1 in the scene and shaded as in `truth`.
void Learn(const std::vector<float>& truth, int first, int steps, ResponseLearner& learner, Response& response) {
  for (int step = first; step < first + steps; ++step) {
    for (size_t photo = 0; photo < 2; ++photo) {
      for (int i = 0; i < 40; ++i) {
        const PicturePlace place = {static_cast<float>((7 * i + step) % 40) / 39.0F, static_cast<float>((11 * i + 3 * step) % 40) / 39.0F};
        Response of_truth = response;
        of_truth.shading = truth;
        const float off = response.LogShading(photo, place) - of_truth.LogShading(photo, place);
        learner.shading().Add(photo, place, 0.6F * off / 80.0F, 1.0F / 80.0F);
      }
    }
    learner.Step(0.2 + 0.8 * step / 400.0);
  }
}

LearnerOptions ShadesTwo(const ShadingGrid& grid) {
  LearnerOptions options;
  options.learns_gain = {0, 0};
  options.shading = {grid, {1, 1}, 0.5F};
  return options;
}

TEST(ShadingLearner, FindsShadingAndResumesWithTheSameBits) {
  std::vector<float> truth = SomeShading(2, kGrid);
  for (size_t k = 0; k < kGrid.knots(); ++k) {
    truth[k] = 0.5F * std::cos(0.9F * static_cast<float>(k % 5));
    truth[kGrid.knots() + k] = -truth[k];
  }
  CentreShading(kGrid, std::vector<uint8_t>{1, 1}, truth);
  Response whole = Response::Neutral(2, 1);
  whole.AddShading(kGrid, 0.5F);
  ResponseLearner learner(whole, ShadesTwo(kGrid));
  EXPECT_TRUE(learner.active());
  Learn(truth, 0, 400, learner, whole);
  for (size_t i = 0; i < truth.size(); ++i) EXPECT_NEAR(whole.shading[i], truth[i], 0.06F);

  Response half = Response::Neutral(2, 1);
  half.AddShading(kGrid, 0.5F);
  ResponseLearner first(half, ShadesTwo(kGrid));
  Learn(truth, 0, 150, first, half);
  const TemporaryFolder folder;
  checkpoint::ArchiveWriter writer("context", 1);
  PutResponse(half, writer);
  first.Put(writer);
  writer.Commit(folder.path() / "c.h5");
  const checkpoint::ArchiveReader reader(folder.path() / "c.h5");
  Response resumed = GetResponse(reader, folder.path() / "c.h5");
  EXPECT_EQ(resumed.shading_grid, kGrid);
  EXPECT_EQ(resumed.shading_sigma, 0.5F);
  ResponseLearner second(resumed, ShadesTwo(kGrid));
  second.Get(reader, folder.path() / "c.h5");
  Learn(truth, 150, 250, second, resumed);
  EXPECT_EQ(resumed.shading, whole.shading);
}

TEST(ShadingLearner, IsFrozenApartFromGains) {
  Response response = Response::Neutral(2, 1);
  response.AddShading(kGrid, 0.5F);
  LearnerOptions options = ShadesTwo(kGrid);
  options.learns_gain = {1, 1};
  ResponseLearner learner(response, options);
  learner.Freeze();
  EXPECT_TRUE(learner.active());
  EXPECT_FALSE(learner.LearnsGains());
  learner.shading().Freeze();
  EXPECT_FALSE(learner.active());
  learner.shading().Add(0, {0.2F, 0.2F}, 0.1F, 0.5F);
  learner.Step(0.5);
  for (const float value : response.shading) EXPECT_EQ(value, 0.0F);
}

TEST(ShadingLearner, LearnsNothingWhileTheFieldIsUnknownNorFromWhatIsNotFinite) {
  Response response = Response::Neutral(2, 1);
  response.AddShading(kGrid, 0.5F);
  ResponseLearner learner(response, ShadesTwo(kGrid));
  learner.shading().Add(0, {0.2F, 0.2F}, 0.1F, 0.5F);
  learner.Step(0.05);
  for (const float value : response.shading) EXPECT_EQ(value, 0.0F);
  learner.shading().Add(0, {0.2F, 0.2F}, std::nanf(""), 0.5F);
  learner.Step(0.5);
  for (const float value : response.shading) EXPECT_EQ(value, 0.0F);
  learner.shading().Add(0, {0.2F, 0.2F}, 0.1F, 0.5F);
  learner.Step(0.5);
  EXPECT_LT(response.LogShading(0, {0.2F, 0.2F}), 0.0F);
  EXPECT_GT(response.LogShading(1, {0.2F, 0.2F}), 0.0F);  // as the mean of both is zero
}

}  // namespace
}  // namespace skyquilt::brightness
