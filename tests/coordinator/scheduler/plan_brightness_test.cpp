#include "coordinator/scheduler/plan_brightness.h"

#include <gtest/gtest.h>

#include <string>

namespace skyquilt::coordinator {
namespace {

// Nine photos exposed for 1/100 s, of which photos 0, 4 and 8 are held out.
survey::Survey TaggedSurvey() {
  survey::Survey survey;
  survey.cameras.resize(1);
  survey.photos.resize(9);
  for (size_t i = 0; i < 9; ++i) {
    survey.photos[i].name = "p" + std::to_string(i) + ".jpg";
    survey.photos[i].exposure.time_s = 0.01;
    survey.photos[i].is_test = i % 4 == 0;
  }
  return survey;
}

TEST(PlanBrightness, HeldOutTagsChangeNoTrainingPhoto) {
  survey::Survey survey = TaggedSurvey();
  survey.photos[3].exposure.time_s = 0.02;
  survey.photos[5].exposure.time_s = 0.02;
  survey.photos[6].exposure.time_s = 0.02;  // half of the training photos
  const BrightnessPlan given = PlanBrightness(survey, {});
  for (survey::Photo& photo : survey.photos) {
    if (photo.is_test) photo.exposure.time_s = 1.0;
  }
  const BrightnessPlan other = PlanBrightness(survey, {});
  EXPECT_EQ(other.response.reference_exposure, given.response.reference_exposure);
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    EXPECT_EQ(other.learn.learns_gain[i], given.learn.learns_gain[i]);
    if (survey.photos[i].is_test) continue;
    EXPECT_EQ(other.response.exif_gain[i], given.response.exif_gain[i]) << i;
    EXPECT_EQ(other.learn.tag_weight[i], given.learn.tag_weight[i]) << i;
  }
  EXPECT_FLOAT_EQ(other.response.exif_gain[0], 50.0F) << "a held-out photo's own tags place it";
}

TEST(PlanBrightness, TheRemarkCountsTrainingPhotos) {
  survey::Survey survey = TaggedSurvey();
  survey.photos[0].exposure.time_s.reset();
  EXPECT_EQ(PlanBrightness(survey, {}).remark, "");
  survey.photos[1].exposure.time_s.reset();
  const std::string remark = PlanBrightness(survey, {}).remark;
  EXPECT_NE(remark.find("1 of 6 training photos"), std::string::npos) << remark;
}

// Six photos with what a training learned of them, and three behind them in twice the light per photo.
TEST(PlanBrightness, AddedPhotosAreFittedToTheEarlierOnes) {
  survey::Survey survey = TaggedSurvey();
  survey.cameras.resize(2);
  for (size_t i = 6; i < 9; ++i) {
    survey.photos[i].camera = 1;
    survey.photos[i].exposure.time_s = 0.04;
  }
  brightness::Response earlier = brightness::Response::Neutral(6, 1);
  earlier.reference_exposure = 0.02;  // as ExifExposure has it, without f-number and ISO
  earlier.exif_gain.assign(6, 0.5F);
  for (size_t i = 0; i < earlier.log_gain.size(); ++i) earlier.log_gain[i] = 0.01F * static_cast<float>(i);
  earlier.vignetting = {-0.1F, 0.02F, 0.003F};
  brightness::BrightnessOptions options;
  options.correction = "exif,gain,vignette";
  const BrightnessPlan plan = PlanBrightness(survey, options, &earlier);
  EXPECT_EQ(plan.response.reference_exposure, earlier.reference_exposure);
  EXPECT_TRUE(plan.learn.anchored);
  EXPECT_EQ(plan.learn.held_vignetting, 1U);
  for (size_t k = 0; k < 3; ++k) EXPECT_EQ(plan.response.vignetting[k], earlier.vignetting[k]);
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(plan.learn.learns_gain[i], 0);
    EXPECT_EQ(plan.response.exif_gain[i], 0.5F);
    for (size_t c = 0; c < 3; ++c) EXPECT_EQ(plan.response.log_gain[3 * i + c], earlier.log_gain[3 * i + c]);
  }
  for (size_t i = 6; i < 9; ++i) {
    EXPECT_FLOAT_EQ(plan.response.exif_gain[i], 2.0F) << "against the earlier reference, not the median of all";
    EXPECT_EQ(plan.learn.learns_gain[i], survey.photos[i].is_test ? 0 : 1);
    EXPECT_EQ(plan.response.log_gain[3 * i], 0.0F);
  }
  earlier.reference_exposure = 0.0;
  const BrightnessPlan untagged = PlanBrightness(survey, options, &earlier);
  EXPECT_EQ(untagged.response.exif_gain[7], 1.0F) << "tags say nothing against photos without";
  EXPECT_EQ(untagged.learn.tag_weight[7], 0.0F);
  EXPECT_EQ(untagged.learn.learns_gain[7], 1);
}

}  // namespace
}  // namespace skyquilt::coordinator
