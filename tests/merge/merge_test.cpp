#include "merge/merge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "core/base/errors.h"
#include "core/brightness/luminance.h"
#include "core/brightness/response.h"
#include "core/scene/background.h"
#include "core/scene/field_file.h"
#include "tests/support/random_field.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::merge {
namespace {

constexpr geo::Geodetic kOrigin = {41.0, 2.0, 100.0};

// A project's finished checkpoints: one block of random parameters, and a context.
class Merge : public testing::Test {
 protected:
  Merge() {
    Write("block", "r0c0", {});
    Write("context", "context", {});
  }
  // Widths of a field's footprints, metres; both 0: a field of points.
  struct Footprints {
    double min_m = 0.0, max_m = 0.0;
  };
  void Write(const std::string& kind, const std::string& name, const Footprints& footprints, encoding::Kind encoding = encoding::Kind::kHash) const {
    const Eigen::Vector3d low(name == "r0c1" ? 5.0 : 0.0, 0.0, 0.0);
    render::TrainedField field = render::RandomField(3, low, low + Eigen::Vector3d(5.0, 5.0, 4.0), 0.8, -1.0, kind == "context", encoding);
    field.name = name;
    field.config.multisample = footprints.max_m > 0.0 ? 1 : 0;
    field.footprint_min_m = footprints.min_m;
    field.footprint_max_m = footprints.max_m;
    const brightness::Response response = brightness::Response::Neutral(2, 1);
    const scene::Background background;
    checkpoint::ArchiveWriter writer(kind, scene::kCheckpointVersion);
    scene::PutField(field, "", writer);
    writer.SetAttribute("complete", 1);
    writer.SetAttribute("origin_latitude_deg", kOrigin.latitude_deg);
    writer.SetAttribute("origin_longitude_deg", kOrigin.longitude_deg);
    writer.SetAttribute("origin_height_m", kOrigin.height_m);
    brightness::PutResponse(response, writer);
    brightness::PutLuminance({}, {}, writer);
    scene::PutBackground(background, writer);
    writer.Commit(folder_ / (name + ".h5"));
  }
  MergeInput Input() const {
    MergeInput input;
    input.context = folder_ / "context.h5";
    input.blocks = {{.checkpoint = folder_ / "r0c0.h5", .gsd_m = 0.05}};
    if (std::filesystem::exists(folder_ / "r0c1.h5")) input.blocks.push_back({.checkpoint = folder_ / "r0c1.h5", .gsd_m = 0.05});
    input.origin = kOrigin;
    input.georeferenced = true;
    input.scene = folder_ / "scene.h5";
    return input;
  }
  scene::SceneInfo Merged(const geo::PlaceAccuracy& accuracy) const {
    MergeInput input = Input();
    input.accuracy = accuracy;
    MergeScene(input);
    return scene::Scene::Load(input.scene).info();
  }

  TemporaryFolder folder_;
};

TEST_F(Merge, TheSceneKeepsPlaceAndAccuracyOfTheSurvey) {
  const scene::SceneInfo info = Merged({.scale_percent = 0.4, .tilt_deg = 0.3, .yaw_deg = 0.0, .horizontal_m = 1.5});
  EXPECT_TRUE(info.georeferenced);
  EXPECT_EQ(info.origin.latitude_deg, kOrigin.latitude_deg);
  ASSERT_EQ(info.blocks.size(), 1U);
  EXPECT_EQ(info.blocks[0].name, "r0c0");
  EXPECT_EQ(info.gsd_m, 0.05);
  EXPECT_EQ(info.accuracy.scale_percent, 0.4);
  EXPECT_EQ(info.accuracy.tilt_deg, 0.3);
  EXPECT_EQ(info.accuracy.yaw_deg, 0.0);
  EXPECT_EQ(info.accuracy.horizontal_m, 1.5);
  EXPECT_TRUE(std::isnan(info.accuracy.vertical_m));
}

TEST_F(Merge, UnknownAccuracyIsNotStored) {
  const scene::SceneInfo info = Merged({});
  for (const std::string& name : checkpoint::ArchiveReader(folder_ / "scene.h5").AttributeNames()) {
    EXPECT_FALSE(name.starts_with("accuracy")) << name;
  }
  EXPECT_TRUE(std::isnan(info.accuracy.tilt_deg));
}

TEST_F(Merge, TheSceneKnowsTheFootprintsOfAllBlocks) {
  EXPECT_FALSE(Merged({}).scales.Cones());
  Write("context", "context", {0.3, 40.0});
  Write("block", "r0c0", {0.1, 0.5});
  Write("block", "r0c1", {0.05, 0.3});
  const scene::SceneInfo info = Merged({});
  ASSERT_EQ(info.blocks.size(), 2U);
  EXPECT_TRUE(info.scales.Cones());
  EXPECT_EQ(info.scales.footprint_min_m, 0.05);
  EXPECT_EQ(info.scales.footprint_max_m, 0.5);
}

// The place of a block that is worse than the context stays in the scene, but its field does not.
TEST_F(Merge, TheContextIsShownInThePlaceOfABlock) {
  Write("block", "r0c1", {});
  const double wide = Merged({}).max_enu.x();
  const std::vector<render::Ray> rays = {{{2.0, 2.0, 30.0}, {0.0, 0.0, -1.0}}, {{7.0, 2.0, 30.0}, {0.0, 0.0, -1.0}}};
  base::ThreadPool threads(1);
  const auto rendered = [&](const scene::Scene& scene) {
    std::vector<render::RayColor> out(rays.size());
    scene.RenderRays(rays, out, {}, threads);
    return std::pair(out[0].rgb_srgb[0], out[1].rgb_srgb[0]);
  };
  MergeInput input = Input();
  const auto all_blocks = rendered(scene::Scene::Load(input.scene));
  input.blocks[1].shows_context = true;
  MergeScene(input);
  const scene::Scene one = scene::Scene::Load(input.scene);
  ASSERT_EQ(one.info().blocks.size(), 2U);
  EXPECT_FALSE(one.info().blocks[0].shows_context);
  EXPECT_TRUE(one.info().blocks[1].shows_context);
  EXPECT_EQ(one.info().blocks[1].name, "r0c1");
  EXPECT_EQ(one.info().blocks[1].parameters, 0);
  EXPECT_EQ(one.info().max_enu.x(), wide);
  EXPECT_EQ(rendered(one).first, all_blocks.first);
  EXPECT_NE(rendered(one).second, all_blocks.second);
  // All of them: the scene is the context, with the same extent.
  input.blocks[0].shows_context = true;
  MergeScene(input);
  const scene::Scene none = scene::Scene::Load(input.scene);
  EXPECT_EQ(none.info().blocks.size(), 2U);
  EXPECT_EQ(none.info().max_enu.x(), wide);
  EXPECT_EQ(rendered(none).second, rendered(one).second);
  // Without the context nothing would be left to show.
  input.use_context = false;
  EXPECT_THROW(MergeScene(input), base::InputError);
}

// A single field without them is enough, the context included.
TEST_F(Merge, TheSceneKnowsWhetherAllFieldsHaveNormalsOfTheDensity) {
  EXPECT_TRUE(Merged({}).density_normals);
  Write("block", "r0c1", {}, encoding::Kind::kFrequency);
  EXPECT_FALSE(Merged({}).density_normals);
  Write("block", "r0c1", {}, encoding::Kind::kVoxels);
  EXPECT_TRUE(Merged({}).density_normals);
  Write("context", "context", {}, encoding::Kind::kPlanes);
  EXPECT_FALSE(Merged({}).density_normals);
}

}  // namespace
}  // namespace skyquilt::merge
