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

}  // namespace
}  // namespace skyquilt::coordinator
