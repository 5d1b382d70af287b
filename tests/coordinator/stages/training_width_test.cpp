#include "coordinator/stages/training_width.h"

#include <gtest/gtest.h>

#include <memory>

#include "coordinator/planning/paying_width.h"
#include "coordinator/stages/stage.h"
#include "core/base/errors.h"
#include "tests/support/connect_alone.h"
#include "tests/support/nadir_photo.h"
#include "tests/support/project_fixture.h"

namespace skyquilt::coordinator {
namespace {

class TrainingWidth : public ProjectFixture {
 protected:
  void SetUp() override {
    survey::Survey survey;
    survey.cameras.push_back({.model = camera::CameraModel::kPinhole, .width = 2000, .height = 1500, .params = {2000.0, 2000.0, 1000.0, 750.0}});
    survey.photos = {NadirPhoto({0.0, 0.0, 50.0}, "a.jpg"), NadirPhoto({9.0, 0.0, 50.0}, "b.jpg")};
    survey::SaveSurvey(survey, project_.SurveyFolder());
  }
  Pipeline Begin(double time_budget_s = 0.0) const {
    Pipeline pipeline{.comm = *comm_, .project = project_, .settings = {}};
    pipeline.settings.run.time_budget_s = time_budget_s;
    pipeline.settings.run.image_width = kAutoWidth;
    return pipeline;
  }
  int Chosen(double time_budget_s) const {
    Pipeline pipeline = Begin(time_budget_s);
    ChooseTrainingWidth(pipeline);
    return pipeline.settings.run.image_width;
  }
  void MakeBlocksAt(int width) const {
    Settings settings;
    settings.run.image_width = width;
    SaveStamp(project_, {.stage = "partition", .state = StageStamp::kDone, .options = StageOptions(StageNamed("partition"), settings), .inputs = {}});
  }

  std::unique_ptr<comm::Communicator> comm_ = comm::ConnectAlone();
};

TEST_F(TrainingWidth, FollowsTheTimeBudget) {
  EXPECT_EQ(Chosen(0.0), kLeastAutoWidth) << "no time is given";
  EXPECT_EQ(Chosen(1.0), kLeastAutoWidth);
  EXPECT_EQ(Chosen(3600.0), 2000);
}

TEST_F(TrainingWidth, ThatIsGivenIsKept) {
  Pipeline pipeline = Begin(3600.0);
  pipeline.settings.run.image_width = 1200;
  ChooseTrainingWidth(pipeline);
  EXPECT_EQ(pipeline.settings.run.image_width, 1200);
}

TEST_F(TrainingWidth, IsThatOfTheBlocksOnceThereAreAny) {
  MakeBlocksAt(1600);
  Pipeline pipeline = Begin(3600.0);
  pipeline.level_settings = pipeline.settings;
  EXPECT_NO_THROW(RequireSameConfiguration(pipeline, "prepare"));
  EXPECT_EQ(pipeline.settings.run.image_width, 1600);
  EXPECT_EQ(pipeline.level_settings->run.image_width, 1600);
  Pipeline another = Begin();
  another.settings.run.image_width = 1200;
  EXPECT_THROW(RequireSameConfiguration(another, "prepare"), base::UsageError);
  Pipeline restarted = Begin();
  restarted.restart = true;
  RecallTrainingWidth(restarted, "partition");
  EXPECT_EQ(restarted.settings.run.image_width, kAutoWidth);
  RecallTrainingWidth(restarted, "train");
  EXPECT_EQ(restarted.settings.run.image_width, 1600) << "the blocks stay";
}

}  // namespace
}  // namespace skyquilt::coordinator
