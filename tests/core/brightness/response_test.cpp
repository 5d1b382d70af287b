#include "core/brightness/response.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/base/errors.h"
#include "core/brightness/response_learner.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::brightness {
namespace {

Response Sample() {
  Response response = Response::Neutral(3, 2);
  response.reference_exposure = 0.02;
  response.exif_gain = {1.0F, 2.0F, 0.5F};
  response.log_gain = {0.0F, 0.0F, 0.0F, 0.1F, 0.2F, 0.3F, -0.1F, -0.2F, -0.3F};
  response.camera = {0, 1, 0};
  response.vignetting = {0.0F, 0.0F, 0.0F, -0.4F, 0.1F, -0.05F};
  const std::string names = "a/one.jpg\nb/two.jpg\nb/one.jpg\n";
  response.names.assign(names.begin(), names.end());
  return response;
}

TEST(Response, MultipliesItsFactors) {
  const Response response = Sample();
  EXPECT_EQ(response.ExposureOf(0)[1].gain, 1.0F);
  const auto log = response.LogGain(1, 0.5F);
  EXPECT_NEAR(log[2], std::log(2.0F) + 0.3F + 0.5F * (-0.4F + 0.5F * (0.1F + 0.5F * -0.05F)), 1e-6F);
  EXPECT_NEAR(response.ExposureOf(1, 0.5F)[2].gain, std::exp(log[2]), 1e-5F);
}

TEST(Response, FindsPhotosByPathOrUniqueFileName) {
  const Response response = Sample();
  EXPECT_EQ(response.Find("b/one.jpg"), 2U);
  EXPECT_EQ(response.Find("two.jpg"), 1U);
  EXPECT_FALSE(response.Find("one.jpg"));
  EXPECT_FALSE(response.Find(""));
  EXPECT_FALSE(Response::Neutral(3, 1).Find("two.jpg"));
}

TEST(Response, IsReadBackAsWritten) {
  const TemporaryFolder folder;
  const Response response = Sample();
  checkpoint::ArchiveWriter writer("scene", 1);
  PutResponse(response, writer);
  writer.Commit(folder.path() / "r.h5");
  const checkpoint::ArchiveReader reader(folder.path() / "r.h5");
  const Response back = GetResponse(reader, folder.path() / "r.h5");
  EXPECT_EQ(back.exif_gain, response.exif_gain);
  EXPECT_EQ(back.log_gain, response.log_gain);
  EXPECT_EQ(back.vignetting, response.vignetting);
  EXPECT_EQ(back.names, response.names);
}

TEST(Response, RefusesArraysThatDisagree) {
  const TemporaryFolder folder;
  Response response = Sample();
  response.camera[1] = 7;
  checkpoint::ArchiveWriter writer("scene", 1);
  PutResponse(response, writer);
  writer.Commit(folder.path() / "r.h5");
  const checkpoint::ArchiveReader reader(folder.path() / "r.h5");
  EXPECT_THROW(GetResponse(reader, folder.path() / "r.h5"), base::InputError);
}

// One step with squared errors of the log gains from every photo's true gains.
void Learn(const std::vector<float>& truth, int steps, ResponseLearner& learner, Response& response) {
  for (int step = 0; step < steps; ++step) {
    for (size_t i = 0; i < response.photos(); ++i) {
      float gradient[3];
      for (size_t c = 0; c < 3; ++c) gradient[c] = response.log_gain[3 * i + c] - truth[3 * i + c];
      learner.Add(i, gradient, 0.01F);
    }
    learner.Step(static_cast<double>(step) / steps);
  }
}

TEST(ResponseLearner, FindsGainsAndKeepsTheirMeanAtZero) {
  Response response = Response::Neutral(4, 1);
  ResponseLearner learner(response, {{1, 1, 1, 1}, {}, false, false});
  const std::vector<float> truth = {0.5F, 0.6F, 0.4F, -0.3F, -0.3F, -0.3F, -0.8F, -0.5F, -0.4F, 0.6F, 0.2F, 0.3F};
  Learn(truth, 600, learner, response);
  for (size_t c = 0; c < 3; ++c) {
    double mean = 0.0;
    for (size_t i = 0; i < 4; ++i) {
      mean += static_cast<double>(response.log_gain[3 * i + c]) / 4.0;
      EXPECT_NEAR(response.log_gain[3 * i + c], truth[3 * i + c], 0.02) << i;
    }
    EXPECT_NEAR(mean, 0.0, 1e-6);
  }
}

TEST(ResponseLearner, TagWeightKeepsGainsThatNoPixelSupports) {
  Response response = Response::Neutral(2, 1);
  response.log_gain = {0.5F, 0.5F, 0.5F, -0.5F, -0.5F, -0.5F};
  ResponseLearner learner(response, {{1, 1}, {0.02F, 0.0F}, true, false});
  const float nothing[3] = {0.0F, 0.0F, 0.0F};
  for (int step = 0; step < 500; ++step) {
    for (const size_t photo : {0U, 1U}) learner.Add(photo, nothing, 0.01F);
    learner.Step(step / 500.0);
  }
  EXPECT_NEAR(response.log_gain[0], 0.0F, 0.02F);
  EXPECT_EQ(response.log_gain[3], -0.5F);
}

TEST(ResponseLearner, IsFrozenByRest) {
  Response response = Response::Neutral(1, 1);
  ResponseLearner learner(response, {{1}, {}, true, true});
  EXPECT_TRUE(learner.active());
  learner.Freeze();
  EXPECT_FALSE(learner.active());
}

TEST(ResponseLearner, LeavesAnchorsAndUnseenPhotosAlone) {
  Response response = Response::Neutral(3, 1);
  ResponseLearner learner(response, {{0, 1, 1}, {}, true, false});
  const float gradient[3] = {-1.0F, -1.0F, -1.0F};
  for (int step = 0; step < 10; ++step) {
    learner.Add(0, gradient, 0.01F);
    learner.Add(1, gradient, 0.01F);
    learner.Step(0.0);
  }
  EXPECT_EQ(response.log_gain[0], 0.0F);
  EXPECT_GT(response.log_gain[3], 0.1F);
  EXPECT_EQ(response.log_gain[6], 0.0F);
  EXPECT_EQ(response.vignetting[0], 0.0F);
}

TEST(ResponseLearner, StaysFiniteAndWithinTenStops) {
  Response response = Response::Neutral(2, 1);
  ResponseLearner learner(response, {{1, 1}, {}, true, true});
  const float huge[3] = {-1e30F, 1e30F, -1e30F}, broken[3] = {std::nanf(""), 0.0F, 0.0F};
  for (int step = 0; step < 2000; ++step) {
    learner.Add(0, huge, 0.01F);
    learner.Add(1, broken, 0.01F);
    learner.Step(0.0);
  }
  for (const float gain : response.log_gain) EXPECT_LE(std::abs(gain), kMaxLogGain);
  for (const float a : response.vignetting) EXPECT_TRUE(std::isfinite(a));
  EXPECT_EQ(response.log_gain[3], 0.0F);
}

TEST(ResponseLearner, ResumesFromItsFileWithTheSameBits) {
  const TemporaryFolder folder;
  const std::vector<float> truth = {0.5F, 0.4F, 0.3F, -0.5F, -0.4F, -0.3F};
  const LearnerOptions options{{1, 1}, {}, false, true};
  Response undisturbed = Response::Neutral(2, 1);
  ResponseLearner whole(undisturbed, options);
  Learn(truth, 20, whole, undisturbed);
  Learn(truth, 20, whole, undisturbed);
  Response response = Response::Neutral(2, 1);
  ResponseLearner first(response, options);
  Learn(truth, 20, first, response);
  checkpoint::ArchiveWriter writer("context", 1);
  PutResponse(response, writer);
  first.Put(writer);
  writer.Commit(folder.path() / "c.h5");
  const checkpoint::ArchiveReader reader(folder.path() / "c.h5");
  Response again = GetResponse(reader, folder.path() / "c.h5");
  ResponseLearner second(again, options);
  second.Get(reader, folder.path() / "c.h5");
  Learn(truth, 20, second, again);
  EXPECT_EQ(again.log_gain, undisturbed.log_gain);
  EXPECT_EQ(again.vignetting, undisturbed.vignetting);
}

}  // namespace
}  // namespace skyquilt::brightness
