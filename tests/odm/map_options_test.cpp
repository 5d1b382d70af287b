#include "odm/map_options.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "odm/run_odm.h"
#include "odm/stage_names.h"
#include "tests/support/error_of.h"

namespace skyquilt::odm {
namespace {

Request RequestOf(std::vector<std::string> words) {
  words.insert(words.begin(), {"--project-path", "/data"});
  return Request::Parse(words);
}

coordinator::Settings SettingsFor(const std::vector<std::string>& words, double training_s = 100.0) {
  coordinator::Settings settings;
  const Request request = RequestOf(words);
  const Effort effort = EffortOf(request.Text("--pc-quality"), request.Text("--feature-quality"), false, {.photos = 10});
  ApplyRequest(request, {}, effort, training_s, "", &settings);
  settings.Check();
  return settings;
}

TEST(MapOptions, ProductsAreMadeWhenAskedFor) {
  const coordinator::Settings plain = SettingsFor({});
  EXPECT_TRUE(plain.products.ortho && plain.surface.enabled && plain.surface.obj && plain.surface.cloud);
  EXPECT_FALSE(plain.products.dsm || plain.surface.maps || plain.surface.glb || plain.surface.tiles || plain.buildings.enabled);
  EXPECT_EQ(plain.products.video_seconds, 0.0);
  EXPECT_EQ(plain.products.crop_m, 3.0) << "OpenDroneMap's default";
  EXPECT_EQ(plain.run.time_budget_s, 100.0);
  const coordinator::Settings all = SettingsFor({"--dsm", "--dtm", "--gltf", "--3d-tiles", "--pc-classify", "--crop", "0"});
  EXPECT_TRUE(all.products.dsm && all.surface.maps && all.surface.glb && all.surface.tiles && all.buildings.enabled && all.buildings.classify_cloud);
  EXPECT_EQ(all.products.crop_m, 0.0);
  const coordinator::Settings flat = SettingsFor({"--skip-3dmodel", "--skip-orthophoto", "--gltf", "--3d-tiles"});
  EXPECT_FALSE(flat.products.ortho || flat.surface.obj || flat.surface.glb || flat.surface.tiles);
  EXPECT_TRUE(flat.surface.cloud) << "--skip-3dmodel leaves the point cloud";
}

TEST(MapOptions, FramesOfVideosAreAsManyAndAsLargeAsAskedFor) {
  EXPECT_EQ(SettingsFor({}).prepare.video_limit, 500) << "OpenDroneMap's default";
  EXPECT_EQ(SettingsFor({}).prepare.video_size, 4000);
  const coordinator::Settings settings = SettingsFor({"--video-limit", "120", "--video-resolution", "1920"});
  EXPECT_EQ(settings.prepare.video_limit, 120);
  EXPECT_EQ(settings.prepare.video_size, 1920);
}

TEST(MapOptions, AFastOrthophotoHasASurfaceOnlyWhereOneIsNeeded) {
  EXPECT_FALSE(WishesOf(RequestOf({"--fast-orthophoto", "--pc-ept", "--gltf", "--cog"})).Surface()) << "NodeODM adds these to every task";
  EXPECT_TRUE(WishesOf(RequestOf({"--fast-orthophoto", "--dtm"})).Surface());
  EXPECT_TRUE(WishesOf(RequestOf({"--fast-orthophoto", "--pc-classify"})).cloud);
}

TEST(MapOptions, PosesFollowTheirOptions) {
  const coordinator::Settings settings =
      SettingsFor({"--min-num-features", "5000", "--gps-accuracy", "0.3", "--camera-lens", "fisheye", "--feature-quality", "ultra"});
  EXPECT_EQ(settings.prepare.max_features, 5000);
  EXPECT_NEAR(settings.prepare.ransac_threshold_m, 1.0, 1e-12);
  EXPECT_EQ(settings.prepare.camera_model, "RADIAL_FISHEYE");
  EXPECT_EQ(settings.prepare.max_image_size, 3200);
  EXPECT_EQ(SettingsFor({}).prepare.ransac_threshold_m, coordinator::Settings().prepare.ransac_threshold_m);
  EXPECT_EQ(SettingsFor({"--gps-accuracy", "3"}).prepare.ransac_threshold_m, coordinator::Settings().prepare.ransac_threshold_m)
      << "OpenDroneMap's default is ours";
  EXPECT_NE(UsageErrorOf([] { SettingsFor({"--camera-lens", "spherical"}); }).find("spherical"), std::string::npos);
}

TEST(MapOptions, SmallerPhotosAreAnUpperLimit) {
  EXPECT_EQ(SettingsFor({"--resize-to", "500"}).run.image_width, 500);
  EXPECT_EQ(SettingsFor({"--resize-to", "500"}).prepare.max_image_size, 500);
  EXPECT_EQ(SettingsFor({"--resize-to", "9000"}).run.image_width, coordinator::kLeastAutoWidth) << "not wider than allowed, by the time either";
  EXPECT_EQ(SettingsFor({"--resize-to", "-1"}).run.image_width, coordinator::Settings().run.image_width);
  EXPECT_NE(UsageErrorOf([] { SettingsFor({"--resize-to", "50"}); }).find("--resize-to"), std::string::npos);
}

TEST(MapOptions, TheGroundFilterFollowsItsOptions) {
  const coordinator::Settings settings = SettingsFor({"--smrf-slope", "0.4", "--smrf-window", "10", "--smrf-threshold", "5"});
  EXPECT_EQ(settings.surface.terrain_slope, 0.4);
  EXPECT_EQ(settings.surface.terrain_window_m, 20.0) << "a radius becomes a size";
  EXPECT_EQ(settings.surface.terrain_low_m, 5.0);
  EXPECT_EQ(settings.surface.terrain_high_m, 5.0) << "never below the other";
}

TEST(Effort, FollowsTheQualities) {
  const Workload work{.photos = 100, .megapixels = 12.0, .cores = 4};
  EXPECT_EQ(EffortOf("medium", "high", false, work).training_s, 1000.0);
  EXPECT_EQ(EffortOf("medium", "high", false, work).preset, "default");
  EXPECT_EQ(EffortOf("high", "high", false, work).preset, "quality");
  EXPECT_EQ(EffortOf("lowest", "high", false, work).preset, "fast");
  EXPECT_EQ(EffortOf("ultra", "high", true, work).preset, "fast") << "--fast-orthophoto wins";
  EXPECT_EQ(EffortOf("ultra", "high", true, work).training_s, 250.0);
  EXPECT_EQ(EffortOf("medium", "lowest", false, work).feature_size, 600);
  EXPECT_EQ(EffortOf("medium", "high", false, {.photos = 100, .megapixels = 0.0, .cores = 4}).training_s, 1000.0) << "unknown sizes are usual ones";
}

RC_GTEST_PROP(Effort, MoreWorkNeverGetsLessTime, ()) {
  const std::vector<std::string> qualities = {"lowest", "low", "medium", "high", "ultra"};
  const auto level = *rc::gen::inRange<size_t>(0, 4);
  const int photos = *rc::gen::inRange(1, 20000), cores = *rc::gen::inRange(1, 128);
  const double megapixels = *rc::gen::inRange(1, 200);
  const Workload work{.photos = photos, .megapixels = megapixels, .cores = cores};
  Workload more = work;
  more.photos += 50;
  const auto seconds = [&](size_t quality, const Workload& of) { return EffortOf(qualities[quality], "high", false, of).training_s; };
  RC_ASSERT(seconds(level, work) <= seconds(level + 1, work));
  RC_ASSERT(seconds(level, work) <= seconds(level, more));
  RC_ASSERT(seconds(level, work) >= 60.0 && seconds(level, work) <= 86400.0);
}

TEST(OdmStages, EachStageOfTheirsIsBehindOneOfOurs) {
  for (const std::string& name : OdmStages()) {
    if (name != "odm_postprocess") EXPECT_FALSE(StageBehind(name).empty()) << name;
  }
  EXPECT_EQ(StageBehind("dataset"), "prepare");
  EXPECT_EQ(StageBehind("openmvs"), "train");
  EXPECT_EQ(StageBehind("odm_georeferencing"), "surface");
  EXPECT_EQ(StageBehind("odm_orthophoto"), "products");
  EXPECT_EQ(StageBehind("odm_postprocess"), "");
}

TEST(OdmStages, ProgressGrowsFromStepToStep) {
  double before = 0.0;
  for (const Step& step : Steps()) {
    EXPECT_GE(step.progress_from, before) << step.stage;
    EXPECT_GT(step.progress_to, step.progress_from) << step.stage;
    before = step.progress_to;
  }
  EXPECT_EQ(before, 100.0);
}

TEST(OdmStages, TheLastStageThatIsAskedForIsTheLastThatRuns) {
  const auto run = [](const std::string& end_with) {
    std::vector<std::string> stages;
    for (const Step& step : Steps()) {
      if (RunsUntil(step, end_with)) stages.push_back(step.stage);
    }
    return stages;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(run("dataset"), Names({"odm"}));
  EXPECT_EQ(run("opensfm"), Names({"prepare", "partition", "odm"}));
  EXPECT_EQ(run("openmvs"), Names({"prepare", "partition", "train", "odm"}));
  EXPECT_EQ(run("odm_georeferencing"), Names({"prepare", "partition", "train", "merge", "surface", "buildings", "odm"}));
  EXPECT_EQ(run("odm_postprocess").size(), Steps().size());
}

TEST(OdmStatus, NodeOdmUnderstandsIt) {
  EXPECT_EQ(StatusForCaller(0), 0);
  EXPECT_EQ(StatusForCaller(3), 1) << "3 is a fault of the installation there";
  EXPECT_EQ(StatusForCaller(4), 1);
  EXPECT_EQ(StatusForCaller(2), 2);
  EXPECT_EQ(StatusForCaller(130), 130);
}

}  // namespace
}  // namespace skyquilt::odm
