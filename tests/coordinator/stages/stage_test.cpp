#include "coordinator/stages/stage.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "coordinator/stages/stage_bodies.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/survey/made_masks.h"
#include "tests/support/connect_alone.h"
#include "tests/support/error_of.h"
#include "tests/support/project_fixture.h"

namespace skyquilt::coordinator {
namespace {

class StageFiles : public ProjectFixture {};

TEST_F(StageFiles, RestartRemovesThisStageAndLaterOnesOnly) {
  for (const Stage& stage : Stages()) Finish(stage.name);
  Touch(project_.SurveyFolder() / "survey.json");
  Touch(project_.BlocksFile());
  Touch(project_.ContextCheckpoint());
  Touch(project_.SceneFile());
  Touch(project_.ReportFolder() / "metrics.json");
  Touch(project_.EvaluateProgressFile());
  RemoveStagesFrom(project_, "train");
  EXPECT_TRUE(std::filesystem::exists(project_.SurveyFolder() / "survey.json"));
  EXPECT_TRUE(std::filesystem::exists(project_.BlocksFile()));
  EXPECT_TRUE(LoadStamp(project_, "partition").has_value());
  EXPECT_FALSE(std::filesystem::exists(project_.CheckpointFolder()));
  EXPECT_FALSE(std::filesystem::exists(project_.SceneFile()));
  EXPECT_FALSE(std::filesystem::exists(project_.ReportFolder()));
  EXPECT_FALSE(std::filesystem::exists(project_.EvaluateProgressFile()));
  EXPECT_FALSE(LoadStamp(project_, "train").has_value());
  EXPECT_FALSE(LoadStamp(project_, "evaluate").has_value());
}

TEST_F(StageFiles, RestartOfTheEvaluationForgetsItsScores) {
  Touch(project_.EvaluateProgressFile());
  Touch(project_.PixelCacheFile());
  RemoveStagesFrom(project_, "evaluate");
  EXPECT_FALSE(std::filesystem::exists(project_.EvaluateProgressFile()));
  EXPECT_TRUE(std::filesystem::exists(project_.PixelCacheFile()));
}

TEST(Stages, StagesDependOnTheirOwnOptionsOnly) {
  Settings before;
  Settings after;
  after.train.levels += 1;
  EXPECT_EQ(StageOptions(StageNamed("partition"), before), StageOptions(StageNamed("partition"), after));
  EXPECT_NE(StageOptions(StageNamed("train"), before), StageOptions(StageNamed("train"), after));
  after = before;
  after.run.threads = 3;
  after.train.checkpoint_every_s = 1.0;
  after.evaluate.save_every_s = 1.0;
  after.products.preview = !before.products.preview;
  for (const Stage& stage : Stages()) EXPECT_EQ(StageOptions(stage, before), StageOptions(stage, after)) << stage.name;
  after.run.image_width = 640;
  EXPECT_NE(StageOptions(StageNamed("partition"), before), StageOptions(StageNamed("partition"), after));
}

// Another vertical system makes maps and surface again, without a complaint about options; the default leaves records of older programs valid.
TEST_F(StageFiles, AnotherVerticalSystemIsANewInput) {
  const auto comm = comm::ConnectAlone();
  Pipeline pipeline{.comm = *comm, .project = project_, .settings = {}};
  for (const Stage& stage : Stages()) {
    if (stage.name != "products" && stage.name != "surface") continue;
    pipeline.settings.products.vertical = "as-tagged";
    Settings before = pipeline.settings;
    const FlatOptions inputs = stage.inputs(pipeline);
    EXPECT_FALSE(inputs.contains("vertical")) << stage.name;
    pipeline.settings.products.vertical = "egm96";
    EXPECT_NE(stage.inputs(pipeline), inputs) << stage.name;
    EXPECT_EQ(StageOptions(stage, before), StageOptions(stage, pipeline.settings)) << stage.name;
  }
}

TEST_F(StageFiles, OtherKindsOfProductsAreANewInput) {
  const auto comm = comm::ConnectAlone();
  Pipeline pipeline{.comm = *comm, .project = project_, .settings = {}};
  const Stage& products = StageNamed("products");
  const Stage& surface = StageNamed("surface");
  EXPECT_FALSE(products.inputs(pipeline).contains("kinds"));
  EXPECT_FALSE(surface.inputs(pipeline).contains("terrain"));
  Settings before = pipeline.settings;
  pipeline.settings.products.kinds = "elevations,terrain";
  EXPECT_EQ(products.inputs(pipeline).at("kinds"), "elevations of walls");
  EXPECT_FALSE(surface.inputs(pipeline).contains("terrain"));
  pipeline.settings.products.kinds = "ortho,dsm,video";
  EXPECT_FALSE(products.inputs(pipeline).contains("kinds"));
  EXPECT_EQ(surface.inputs(pipeline).at("terrain"), "none");
  EXPECT_EQ(StageOptions(products, before), StageOptions(products, pipeline.settings));
}

// Surveys of programs without the option stay valid as long as it has its default; another value is an input that has changed.
TEST_F(StageFiles, PosesOfHeldOutPhotosAreAnInputWhereTheyAreNotTheDefault) {
  const auto comm = comm::ConnectAlone();
  Pipeline pipeline{.comm = *comm, .project = project_, .settings = {}, .photos = folder_.path()};
  const Stage& stage = StageNamed("prepare");
  const FlatOptions options = StageOptions(stage, pipeline.settings), inputs = stage.inputs(pipeline);
  EXPECT_TRUE(options.contains("prepare.holdout"));
  EXPECT_FALSE(options.contains("prepare.holdout_poses") || inputs.contains("prepare.holdout_poses"));
  SaveStamp(project_, {.stage = stage.name, .state = StageStamp::kDone, .options = options, .inputs = inputs});
  EXPECT_EQ(CheckStage(project_, stage.name, StageOptions(stage, pipeline.settings), stage.inputs(pipeline), {}), Freshness::kUpToDate);
  pipeline.settings.prepare.holdout_poses = "resected";
  EXPECT_EQ(CheckStage(project_, stage.name, StageOptions(stage, pipeline.settings), stage.inputs(pipeline), {}), Freshness::kInputsChanged);
}

TEST_F(StageFiles, ChosenPhotosAndMasksBesideImagesAreInputsWhereThereAreAny) {
  const auto comm = comm::ConnectAlone();
  const std::filesystem::path images = folder_.path() / "photos" / "images";
  std::filesystem::create_directories(images);
  Pipeline pipeline{.comm = *comm, .project = project_, .settings = {}, .photos = images};
  const Stage& stage = StageNamed("prepare");
  const FlatOptions options = StageOptions(stage, pipeline.settings), inputs = stage.inputs(pipeline);
  EXPECT_FALSE(options.contains("prepare.photos") || inputs.contains("prepare.photos") || inputs.contains("masks"));
  pipeline.settings.prepare.photos = "*.JPG";
  EXPECT_EQ(StageOptions(stage, pipeline.settings), options);
  EXPECT_EQ(stage.inputs(pipeline).at("prepare.photos"), "*.JPG");
  std::filesystem::create_directories(folder_.path() / "photos" / "masks");
  EXPECT_TRUE(stage.inputs(pipeline).contains("masks"));
}

TEST_F(StageFiles, VideosAndTheirOptionsAreInputsOfSurveysOfVideosAlone) {
  const auto comm = comm::ConnectAlone();
  const std::filesystem::path folder = folder_.path() / "photos";
  std::filesystem::create_directories(folder);
  base::WriteFileAtomically(folder / "a.dng", "raw");
  Pipeline pipeline{.comm = *comm, .project = project_, .settings = {}};
  const Stage& stage = StageNamed("prepare");
  TakePhotos(pipeline, folder);
  EXPECT_TRUE(pipeline.videos.empty()) << "a raw file is a photo";
  FlatOptions inputs = stage.inputs(pipeline);
  EXPECT_TRUE(inputs.contains("images") && inputs.contains("HEIC and raw"));
  EXPECT_FALSE(inputs.contains("videos") || inputs.contains("prepare.video_overlap"));
  base::WriteFileAtomically(folder / "a.jpg", "");
  EXPECT_FALSE(stage.inputs(pipeline).contains("HEIC and raw")) << "another form of a photo";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  base::WriteFileAtomically(folder / "a.mp4", "film");
  TakePhotos(pipeline, folder);
  ASSERT_EQ(pipeline.videos.size(), 1U);
  EXPECT_EQ(pipeline.photos, project_.SurveyFolder() / "frames");
  inputs = stage.inputs(pipeline);
  EXPECT_FALSE(inputs.contains("images"));
  EXPECT_EQ(inputs.at("prepare.video_limit"), "500");
  EXPECT_FALSE(StageOptions(stage, pipeline.settings).contains("prepare.video_limit"));
  base::WriteFileAtomically(folder / "a.SRT", "");
  EXPECT_NE(stage.inputs(pipeline).at("videos"), inputs.at("videos"));
}

// The files of masks count by their content, and what was trained without them stays as it is until the user removes it.
TEST_F(StageFiles, MasksOfOtherFilesAreRefusedOnceTrainingHasBegun) {
  const auto comm = comm::ConnectAlone();
  Pipeline pipeline{.comm = *comm, .project = project_, .settings = {}};
  const Stage& stage = StageNamed("masks");
  Settings before = pipeline.settings;
  EXPECT_FALSE(stage.wanted(pipeline.settings));
  Touch(project_.SurveyFolder() / "survey.json");
  pipeline.settings.masks.ignore_ground = (folder_ / "lake.geojson").string();
  EXPECT_TRUE(stage.wanted(pipeline.settings));
  EXPECT_EQ(StageOptions(stage, before), StageOptions(stage, pipeline.settings));
  EXPECT_NE(InputErrorOf([&] { stage.inputs(pipeline); }).find("lake.geojson"), std::string::npos);
  Touch(folder_ / "lake.geojson", "one");
  const FlatOptions one = stage.inputs(pipeline);
  Touch(folder_ / "lake.geojson", "two");
  EXPECT_NE(stage.inputs(pipeline), one);
  // Training is not begun without masks that are asked for.
  EXPECT_NE(InputErrorOf([&] { StageNamed("train").inputs(pipeline); }).find("skyquilt masks"), std::string::npos);
  EXPECT_NO_THROW(StageNamed("partition").inputs(pipeline));
  Touch(survey::MadeMasksFile(project_.SurveyFolder()));
  const FlatOptions with_masks = StageNamed("train").inputs(pipeline);
  pipeline.settings.masks = {};
  EXPECT_EQ(StageNamed("train").inputs(pipeline), with_masks);
  std::filesystem::remove(survey::MadeMasksFile(project_.SurveyFolder()));
  EXPECT_NE(StageNamed("train").inputs(pipeline), with_masks);

  pipeline.settings.masks.ignore_ground = (folder_ / "lake.geojson").string();
  SaveStamp(project_, {.stage = "train", .state = StageStamp::kRunning, .options = {}, .inputs = {}});
  const std::string error = UsageErrorOf([&] { RunStage(pipeline, "masks"); });
  for (const char* part : {"'train'", "ignored ground", "skyquilt masks", "--restart"}) EXPECT_NE(error.find(part), std::string::npos) << error;
  EXPECT_FALSE(LoadStamp(project_, "masks"));
}

TEST(Stages, HaveUniqueNamesAndNeedOnlyEarlierOnes) {
  std::set<std::string> names;
  for (const Stage& stage : Stages()) {
    for (const Stage::RequiredFile& required : stage.required)
      EXPECT_TRUE(names.contains(required.stage)) << stage.name << " needs " << required.stage;
    EXPECT_TRUE(names.insert(stage.name).second) << stage.name;
    EXPECT_TRUE(stage.inputs != nullptr && stage.outputs != nullptr && stage.completion_files != nullptr && stage.body != nullptr) << stage.name;
  }
}

TEST(Stages, RunMakesBuildingsWhereThereIsASurfaceToFindThemIn) {
  Settings settings;
  settings.surface = {.enabled = true, .cloud = true, .maps = true};
  settings.buildings.enabled = true;
  const auto wanted = [&settings](const char* stage) { return StageNamed(stage).wanted(settings); };
  EXPECT_TRUE(wanted("surface") && wanted("buildings"));
  settings.surface.maps = false;
  EXPECT_TRUE(wanted("surface") && !wanted("buildings"));
  settings.tour.auto_stops = 0;
  EXPECT_FALSE(wanted("tour"));
  settings.tour.auto_stops = 2;
  EXPECT_TRUE(wanted("tour"));
}

TEST(Stages, NameOptionsThatExist) {
  Settings settings;
  const FlatOptions all = settings.Flat();
  for (const Stage& stage : Stages()) {
    for (const std::string& key : stage.options) EXPECT_FALSE(Select(all, {key}).empty()) << stage.name << " depends on " << key;
    for (const std::string& key : stage.ignored_options) EXPECT_FALSE(Select(all, {key}).empty()) << stage.name << " has " << key;
  }
}

TEST_F(StageFiles, ProofOfAStageIsRemovedWithIt) {
  for (const Stage& stage : Stages()) {
    if (stage.separate_folder != nullptr) continue;
    for (const std::filesystem::path& proof : stage.completion_files(project_)) {
      bool removed = false;
      for (const std::filesystem::path& output : stage.outputs(project_)) removed = removed || proof.string().starts_with(output.string());
      EXPECT_TRUE(removed) << stage.name << " leaves " << proof;
    }
  }
}

TEST_F(StageFiles, RestartLeavesToursAndWhatPeopleUploaded) {
  const std::filesystem::path uploaded = project_.TourFolder() / "assets" / "a.glb";
  for (const std::filesystem::path& file :
       {project_.TourFile(), uploaded, project_.TourFolder() / "index.html", project_.TourFolder() / "data" / "x.js"}) {
    Touch(file);
  }
  RemoveStagesFrom(project_, "prepare");
  EXPECT_TRUE(std::filesystem::exists(project_.TourFile()) && std::filesystem::exists(uploaded));
  EXPECT_FALSE(std::filesystem::exists(project_.TourFolder() / "index.html") || std::filesystem::exists(project_.TourFolder() / "data"));
}

// So that a proposed tour is proposed again with a new scene, and one that a person touched never is.
TEST_F(StageFiles, ATourIsEditedUnlessItIsAsProposed) {
  EXPECT_EQ(EditedTourIdentity(project_), "");
  Touch(project_.TourFile(), "a tour");
  EXPECT_NE(EditedTourIdentity(project_), "");
  Touch(project_.TourProposal(), base::HashHex("a tour"));
  EXPECT_EQ(EditedTourIdentity(project_), "");
  Touch(project_.TourFile(), "a tour of mine");
  EXPECT_NE(EditedTourIdentity(project_), "");
  const auto comm = comm::ConnectAlone();
  Pipeline pipeline{.comm = *comm, .project = project_, .settings = {}};
  EXPECT_THROW(ExportProjectTour(pipeline, {.out = folder_ / "out", .auto_stops = 3, .video = false}), base::UsageError);
  EXPECT_EQ(base::ReadFile(project_.TourFile()), "a tour of mine");
}

TEST_F(StageFiles, AStageWithUnreadableResultsRunsAgain) {
  const auto comm = comm::ConnectAlone();
  Pipeline pipeline{.comm = *comm, .project = project_, .settings = {}};
  scene::WriteTrainReport({.ranks = 2, .config_hash = "a", .fields = {{.name = "context", .ok = true}}}, project_.TrainReport());
  evaluate::metrics::Metrics metrics;
  metrics.psnr = 27.5;
  Touch(project_.MetricsFile(), evaluate::metrics::MetricsJson(metrics));
  EXPECT_TRUE(StageNamed("train").load_results(pipeline));
  EXPECT_EQ(pipeline.training.ranks, 2);
  EXPECT_TRUE(StageNamed("evaluate").load_results(pipeline));
  EXPECT_EQ(pipeline.metrics.psnr, 27.5);
  Touch(project_.TrainReport(), "{\"fields\": [");
  Touch(project_.MetricsFile(), "{\"psnr\": 2");
  EXPECT_FALSE(StageNamed("train").load_results(pipeline));
  EXPECT_FALSE(StageNamed("evaluate").load_results(pipeline));
}

TEST_F(StageFiles, ADamagedInputChangesNoFiles) {
  const auto comm = comm::ConnectAlone();
  Touch(project_.BlocksFile());
  Touch(project_.TrainReport(), "{\"fields\": [");
  Pipeline pipeline{.comm = *comm, .project = project_, .settings = {}};
  EXPECT_THROW(MergeStage(pipeline), base::InputError);
  EXPECT_FALSE(LoadStamp(project_, "merge").has_value());
}

TEST_F(StageFiles, AStageWhoseInputIsMissingNamesFileAndCommand) {
  const auto comm = comm::ConnectAlone();
  Pipeline pipeline{.comm = *comm, .project = project_, .settings = {}};
  const auto error = Caught<base::InputError>([&] { MergeStage(pipeline); });
  ASSERT_TRUE(error) << "nothing thrown";
  EXPECT_EQ(error->file(), project_.BlocksFile());
  EXPECT_NE(std::string(error->what()).find("skyquilt partition"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::coordinator
