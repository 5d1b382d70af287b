#include "core/scene/scene_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/errors.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::scene {
namespace {

using SceneFileTest = InTemporaryFolder;

checkpoint::ArchiveReader Stored(const geo::PlaceAccuracy& accuracy, const std::filesystem::path& file) {
  checkpoint::ArchiveWriter writer(kSceneKind, kSceneVersion);
  PutAccuracy(accuracy, writer);
  writer.Commit(file);
  return OpenScene(file);
}

TEST_F(SceneFileTest, KeepsTheAccuracyOfItsPlace) {
  const geo::PlaceAccuracy before = {.scale_percent = 0.1 / 3.0, .tilt_deg = 0.3, .yaw_deg = 0.0, .horizontal_m = 1.5, .vertical_m = 3.0};
  const checkpoint::ArchiveReader reader = Stored(before, folder_ / "scene.h5");
  EXPECT_EQ(reader.DoubleAttribute("accuracy_scale_percent"), before.scale_percent);
  const geo::PlaceAccuracy after = GetAccuracy(reader);
  EXPECT_EQ(after.scale_percent, before.scale_percent);
  EXPECT_EQ(after.tilt_deg, before.tilt_deg);
  EXPECT_EQ(after.yaw_deg, before.yaw_deg);
  EXPECT_EQ(after.horizontal_m, before.horizontal_m);
  EXPECT_EQ(after.vertical_m, before.vertical_m);
}

TEST_F(SceneFileTest, WithoutAccuracyItIsUnknown) {
  const checkpoint::ArchiveReader reader = Stored({.tilt_deg = 2.0}, folder_ / "scene.h5");
  EXPECT_FALSE(reader.HasAttribute("accuracy_scale_percent"));
  const geo::PlaceAccuracy accuracy = GetAccuracy(reader);
  EXPECT_EQ(accuracy.tilt_deg, 2.0);
  EXPECT_TRUE(std::isnan(accuracy.scale_percent));
  EXPECT_TRUE(std::isnan(accuracy.yaw_deg));
  EXPECT_TRUE(std::isnan(accuracy.horizontal_m));
  EXPECT_TRUE(std::isnan(accuracy.vertical_m));
}

TEST_F(SceneFileTest, KeepsWhatItsHeightsAreAbove) {
  EXPECT_EQ(GetHeightReference(Stored({}, folder_ / "old.h5"), folder_ / "old.h5"), geo::HeightReference::kUnknown);
  checkpoint::ArchiveWriter writer(kSceneKind, kSceneVersion);
  PutHeightReference(geo::HeightReference::kEgm96, writer);
  writer.Commit(folder_ / "scene.h5");
  EXPECT_EQ(GetHeightReference(OpenScene(folder_ / "scene.h5"), folder_ / "scene.h5"), geo::HeightReference::kEgm96);
  checkpoint::ArchiveWriter damaged(kSceneKind, kSceneVersion);
  damaged.SetAttribute("height_reference", std::string("sea level"));
  damaged.Commit(folder_ / "damaged.h5");
  EXPECT_THROW(GetHeightReference(OpenScene(folder_ / "damaged.h5"), folder_ / "damaged.h5"), base::InputError);
}

}  // namespace
}  // namespace skyquilt::scene
