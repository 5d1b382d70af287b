#include "coordinator/project/stamp.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/base/errors.h"
#include "tests/support/error_of.h"
#include "tests/support/project_fixture.h"

namespace skyquilt::coordinator {
namespace {

class Stamp : public ProjectFixture {};

TEST_F(Stamp, FinishedStageWithItsFilesIsFresh) {
  EXPECT_EQ(CheckStage(project_, "merge", options_, inputs_, {project_.SceneFile()}), Freshness::kNotStarted);
  Finish("merge", "running");
  EXPECT_EQ(CheckStage(project_, "merge", options_, inputs_, {project_.SceneFile()}), Freshness::kUnfinished);
  Finish("merge");
  EXPECT_EQ(CheckStage(project_, "merge", options_, inputs_, {project_.SceneFile()}), Freshness::kUnfinished) << "its file is missing";
  Touch(project_.SceneFile());
  EXPECT_EQ(CheckStage(project_, "merge", options_, inputs_, {project_.SceneFile()}), Freshness::kUpToDate);
  Finish("merge", "failed");
  EXPECT_EQ(CheckStage(project_, "merge", options_, inputs_, {project_.SceneFile()}), Freshness::kUnfinished);
}

TEST_F(Stamp, ChangedOptionIsNamedWithBothValuesAndTheFix) {
  Finish("train");
  FlatOptions changed = options_;
  changed["train.steps"] = "4000";
  const std::string text = UsageErrorOf([&] { CheckStage(project_, "train", changed, inputs_, {project_.SceneFile()}); });
  EXPECT_NE(text.find("train.steps: 2000 -> 4000"), std::string::npos) << text;
  EXPECT_NE(text.find("--restart"), std::string::npos) << text;
  EXPECT_EQ(text.find("train.levels"), std::string::npos) << text;
}

TEST_F(Stamp, ChangedInputIsSeen) {
  Finish("merge");
  Touch(project_.SceneFile());
  EXPECT_EQ(CheckStage(project_, "merge", options_, {{"survey", "other"}}, {project_.SceneFile()}), Freshness::kInputsChanged);
}

TEST_F(Stamp, DamagedStampIsAnInputErrorThatNamesTheFile) {
  Touch(project_.StampFile("train"), "{ half");
  const auto error = Caught<base::InputError>([&] { CheckStage(project_, "train", options_, inputs_, {project_.SceneFile()}); });
  ASSERT_TRUE(error) << "nothing thrown";
  EXPECT_EQ(error->file(), project_.StampFile("train"));
}

TEST_F(Stamp, PhotosIdentityDependsOnImagesOnly) {
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

// It may still be worked on, and gives no photos.
TEST_F(Stamp, AnotherProjectAmongThePhotosDoesNotChangeTheirIdentity) {
  const std::filesystem::path photos = project_.folder / "photos";
  Touch(photos / "a.jpg");
  const std::string one = PhotosIdentity(photos, {});
  Touch(photos / "earlier" / "survey" / "survey.json");
  Touch(photos / "earlier" / "report" / "images" / "x.png");
  EXPECT_EQ(PhotosIdentity(photos, {}), one);
  Touch(photos / "flight" / "sparse" / "0" / "cameras.txt");
  Touch(photos / "flight" / "images" / "b.jpg");
  EXPECT_NE(PhotosIdentity(photos, {}), one);
}

TEST_F(Stamp, OpeningAFolderThatIsNoProjectIsAnInputError) {
  EXPECT_THROW(Project::Open(project_.folder / "absent"), base::InputError);
  EXPECT_THROW(Project::Open(project_.folder), base::InputError);
  Touch(project_.SurveyFolder() / "survey.json");
  EXPECT_NO_THROW(Project::Open(project_.folder));
}

}  // namespace
}  // namespace skyquilt::coordinator
