#include "coordinator/stages/level_settings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "coordinator/stages/stage.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "tests/support/connect_alone.h"
#include "tests/support/nadir_photo.h"
#include "tests/support/project_fixture.h"

namespace skyquilt::coordinator {
namespace {

class LevelSettings : public ProjectFixture {
 protected:
  Pipeline Begin() const {
    Pipeline pipeline{.comm = *comm_, .project = project_, .settings = {}};
    pipeline.level_settings = pipeline.settings;
    pipeline.level_settings->products.video_seconds = 9.0;
    pipeline.level_settings->train.levels = 5;
    return pipeline;
  }
  static survey::Survey Level() {
    survey::Survey survey;
    survey.cameras.push_back({camera::CameraModel::kPinhole, 100, 80, {90.0, 91.0, 50.0, 40.0}});
    survey.photos = {LevelPhoto({0.0, 0.0, 2.0}, "a.jpg"), LevelPhoto({1.0, 0.0, 2.0}, "b.jpg")};
    return survey;
  }
  // What is logged while a pipeline decides about these photos.
  static std::string SaidOf(Pipeline& pipeline, const survey::Survey& survey) {
    testing::internal::CaptureStderr();
    base::InitLog(false);
    UseLevelSettings(pipeline, survey);
    return testing::internal::GetCapturedStderr();
  }
  // Marks a stage as made with these settings.
  void MadeWith(Settings settings, const std::string& stage) const {
    SaveStamp(project_, {.stage = stage, .state = StageStamp::kDone, .options = StageOptions(StageNamed(stage), settings), .inputs = {}});
  }

  std::unique_ptr<comm::Communicator> comm_ = comm::ConnectAlone();
};

TEST_F(LevelSettings, AreTakenForPhotosThatLookLevelAndSaidOnce) {
  Pipeline pipeline = Begin();
  const std::string said = SaidOf(pipeline, Level());
  EXPECT_EQ(pipeline.settings.Flat(), pipeline.level_settings->Flat());
  for (const char* words : {"photos look level", "preset level", "products.video_seconds: 5.0 -> 9.0", "train.levels: 8 -> 5", "--config default"}) {
    EXPECT_NE(said.find(words), std::string::npos) << said;
  }
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1);
  EXPECT_EQ(SaidOf(pipeline, Level()), "");
}

TEST_F(LevelSettings, AreNotTakenForPhotosThatLookDownOrWhereThereAreNone) {
  survey::Survey down;
  down.photos = {NadirPhoto({0.0, 0.0, 50.0}, "a.jpg"), LevelPhoto({1.0, 0.0, 2.0}, "b.jpg")};
  Pipeline pipeline = Begin();
  EXPECT_EQ(SaidOf(pipeline, down), "");
  EXPECT_EQ(pipeline.settings.Flat(), Settings().Flat());
  pipeline.level_settings.reset();
  EXPECT_EQ(SaidOf(pipeline, Level()), "");
  EXPECT_EQ(pipeline.settings.Flat(), Settings().Flat());
}

TEST_F(LevelSettings, AreNotSaidWhereAllTheirOptionsWereGiven) {
  Pipeline pipeline = Begin();
  pipeline.settings.products.video_seconds = 30.0;
  pipeline.level_settings = pipeline.settings;
  EXPECT_EQ(SaidOf(pipeline, Level()), "");
  EXPECT_EQ(pipeline.settings.products.video_seconds, 30.0);
}

TEST_F(LevelSettings, MustBeAllowed) {
  Pipeline pipeline = Begin();
  pipeline.level_settings->train.levels = 7;
  pipeline.level_settings->train.features = 2;
  EXPECT_THROW(UseLevelSettings(pipeline, Level()), base::UsageError);
  EXPECT_EQ(pipeline.settings.Flat(), Settings().Flat());
}

TEST_F(LevelSettings, OfAFinishedSurveyAreTheSameAgain) {
  const auto taken = [](Pipeline pipeline) {
    RecallLevelSettings(pipeline);
    return pipeline.settings.Flat() == pipeline.level_settings->Flat();
  };
  EXPECT_FALSE(taken(Begin())) << "no survey";
  survey::SaveSurvey(Level(), project_.SurveyFolder());
  EXPECT_FALSE(taken(Begin())) << "a survey that may be unfinished";
  MadeWith({}, "prepare");
  EXPECT_TRUE(taken(Begin()));
  MadeWith(*Begin().level_settings, "partition");
  MadeWith(*Begin().level_settings, "train");
  Pipeline resumed = Begin();
  RecallLevelSettings(resumed);
  EXPECT_NO_THROW(RequireSameConfiguration(resumed, "prepare"));
  Pipeline with_preset = Begin();
  with_preset.level_settings.reset();
  RecallLevelSettings(with_preset);
  EXPECT_THROW(RequireSameConfiguration(with_preset, "prepare"), base::UsageError);
  Pipeline restarted = Begin();
  restarted.restart = true;
  EXPECT_FALSE(taken(restarted)) << "the survey is made anew";
}

// As programs made them that did not choose.
TEST_F(LevelSettings, LeaveResultsOfOtherSettingsTheirs) {
  const auto taken = [this] {
    Pipeline pipeline = Begin();
    return UseLevelSettings(pipeline, Level());
  };
  MadeWith({}, "partition");  // which depends on none of these options
  EXPECT_TRUE(taken());
  MadeWith({}, "train");
  EXPECT_FALSE(taken());
  MadeWith(*Begin().level_settings, "products");
  EXPECT_TRUE(taken()) << "neither fits, and that is for the user to decide";
}

}  // namespace
}  // namespace skyquilt::coordinator
