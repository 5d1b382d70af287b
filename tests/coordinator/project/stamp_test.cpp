#include "coordinator/project/stamp.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::coordinator {
namespace {

class Stamp : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    project_ = Project::Create(std::filesystem::temp_directory_path() / ("skyquilt_stamp_" + std::to_string(getpid()) + "_" + info->name()));
  }
  void TearDown() override { std::filesystem::remove_all(project_.folder); }

  void Touch(const std::filesystem::path& file, const std::string& text = "x") const {
    std::filesystem::create_directories(file.parent_path());
    base::WriteFileAtomically(file, text);
  }
  void Finish(const std::string& stage, const std::string& state = "done") const {
    SaveStamp(project_, {.stage = stage, .state = state, .options = options_, .inputs = inputs_});
  }

  Project project_;
  FlatOptions options_ = {{"train.steps", "2000"}, {"train.levels", "8"}};
  FlatOptions inputs_ = {{"survey", "abc"}};
};

TEST_F(Stamp, FinishedStageWithItsFilesIsFresh) {
  EXPECT_EQ(CheckStage(project_, "merge", options_, inputs_), Freshness::kAbsent);
  Finish("merge", "running");
  EXPECT_EQ(CheckStage(project_, "merge", options_, inputs_), Freshness::kUnfinished);
  Finish("merge");
  EXPECT_EQ(CheckStage(project_, "merge", options_, inputs_), Freshness::kUnfinished) << "its file is missing";
  Touch(project_.SceneFile());
  EXPECT_EQ(CheckStage(project_, "merge", options_, inputs_), Freshness::kFresh);
  Finish("merge", "failed");
  EXPECT_EQ(CheckStage(project_, "merge", options_, inputs_), Freshness::kUnfinished);
}

TEST_F(Stamp, ChangedOptionIsNamedWithBothValuesAndTheWayOut) {
  Finish("train");
  FlatOptions changed = options_;
  changed["train.steps"] = "4000";
  try {
    CheckStage(project_, "train", changed, inputs_);
    FAIL() << "nothing thrown";
  } catch (const base::UsageError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("train.steps: 2000 -> 4000"), std::string::npos) << text;
    EXPECT_NE(text.find("--restart"), std::string::npos) << text;
    EXPECT_EQ(text.find("train.levels"), std::string::npos) << text;
  }
}

TEST_F(Stamp, ChangedInputIsSeen) {
  Finish("merge");
  Touch(project_.SceneFile());
  EXPECT_EQ(CheckStage(project_, "merge", options_, {{"survey", "other"}}), Freshness::kInputsChanged);
}

TEST_F(Stamp, RestartRemovesThisStageAndLaterOnesOnly) {
  for (const std::string& stage : StageNames()) Finish(stage);
  Touch(project_.SurveyFolder() / "survey.json");
  Touch(project_.BlocksFile());
  Touch(project_.ContextCheckpoint());
  Touch(project_.SceneFile());
  Touch(project_.ReportFolder() / "metrics.json");
  RemoveStagesFrom(project_, "train");
  EXPECT_TRUE(std::filesystem::exists(project_.SurveyFolder() / "survey.json"));
  EXPECT_TRUE(std::filesystem::exists(project_.BlocksFile()));
  EXPECT_TRUE(LoadStamp(project_, "partition").has_value());
  EXPECT_FALSE(std::filesystem::exists(project_.CheckpointFolder()));
  EXPECT_FALSE(std::filesystem::exists(project_.SceneFile()));
  EXPECT_FALSE(std::filesystem::exists(project_.ReportFolder()));
  EXPECT_FALSE(LoadStamp(project_, "train").has_value());
  EXPECT_FALSE(LoadStamp(project_, "evaluate").has_value());
}

TEST_F(Stamp, DamagedStampIsAnInputErrorThatNamesTheFile) {
  Touch(project_.StampFile("train"), "{ half");
  try {
    CheckStage(project_, "train", options_, inputs_);
    FAIL() << "nothing thrown";
  } catch (const base::InputError& error) {
    EXPECT_EQ(error.file(), project_.StampFile("train"));
  }
}

TEST_F(Stamp, PhotosIdentityFollowsImagesAndNothingElse) {
  const std::filesystem::path photos = project_.folder / "photos";
  Touch(photos / "a.jpg");
  const std::string one = PhotosIdentity(photos, photos / "out");
  Touch(photos / "notes.txt");
  Touch(photos / "out" / "render.png");
  EXPECT_EQ(PhotosIdentity(photos, photos / "out"), one);
  Touch(photos / "deeper" / "b.JPG");
  const std::string two = PhotosIdentity(photos, photos / "out");
  EXPECT_NE(two, one);
  Touch(photos / "a.jpg", "longer");
  EXPECT_NE(PhotosIdentity(photos, photos / "out"), two);
}

TEST_F(Stamp, OpeningAFolderThatIsNoProjectSaysSo) {
  EXPECT_THROW(Project::Open(project_.folder / "absent"), base::InputError);
  EXPECT_THROW(Project::Open(project_.folder), base::InputError);
  Touch(project_.SurveyFolder() / "survey.json");
  EXPECT_NO_THROW(Project::Open(project_.folder));
}

}  // namespace
}  // namespace skyquilt::coordinator
