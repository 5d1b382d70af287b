#include "coordinator/scheduler/kept_blocks.h"

#include <gtest/gtest.h>

#include <functional>

#include "tests/support/nadir_photo.h"

namespace skyquilt::coordinator {
namespace {

struct Made {
  survey::Survey survey;
  partition::Block block;
};

Made MakeBlock() {
  Made made;
  made.survey.cameras = {{camera::CameraModel::kPinhole, 800, 600, {700.0, 700.0, 400.0, 300.0}}};
  for (int i = 0; i < 3; ++i) made.survey.photos.push_back(NadirPhoto({10.0 * i, 0.0, 50.0}, "photo_" + std::to_string(i) + ".jpg"));
  made.block.name = "r0c0";
  made.block.max_enu = {20.0, 20.0, 10.0};
  made.block.margin_m = 2.0;
  made.block.gsd_m = 0.1;
  made.block.finest_voxel_m = 0.15;
  made.block.log2_table_size = 17;
  made.block.photos = {0, 1};
  return made;
}

TEST(KeptBlocks, AnythingThatTrainingDependsOnChangesTheIdentity) {
  const Made made = MakeBlock();
  const std::string identity = TrainingIdentity(made.survey, made.block);
  const std::function<void(Made&)> changes[] = {
      [](Made& m) { m.block.max_enu.x() = std::nextafter(20.0, 21.0); },
      [](Made& m) { m.block.min_enu.z() = -1.0; },
      [](Made& m) { m.block.margin_m = 3.0; },
      [](Made& m) { m.block.gsd_m = 0.2; },
      [](Made& m) { m.block.finest_voxel_m = 0.2; },
      [](Made& m) { m.block.log2_table_size = 16; },
      [](Made& m) {
        m.block.photos = {0, 1, 2};
      },
      [](Made& m) {
        m.block.photos = {0, 2};
      },
      [](Made& m) { m.survey.photos[1].is_test = true; },
      [](Made& m) { m.survey.photos[0].cam_from_enu.translation.y() += 1e-12; },
      [](Made& m) { m.survey.cameras[0].params[0] = 701.0; },
  };
  for (size_t i = 0; i < std::size(changes); ++i) {
    Made changed = made;
    changes[i](changed);
    EXPECT_NE(TrainingIdentity(changed.survey, changed.block), identity) << "change " << i;
  }
}

TEST(KeptBlocks, OtherPhotosNamesAndIdsDoNotChangeTheIdentity) {
  const Made made = MakeBlock();
  Made other = made;
  other.survey.photos[2].cam_from_enu.translation.x() = 5.0;
  other.survey.photos.push_back(other.survey.photos[2]);
  for (survey::Photo& photo : other.survey.photos) photo.name = "zone1/" + photo.name;
  other.block.id = 7;
  other.block.cost = 0.5;
  EXPECT_EQ(TrainingIdentity(other.survey, other.block), TrainingIdentity(made.survey, made.block));
}

TEST(KeptBlocks, AProjectToWhichNothingWasAddedKeepsNone) {
  EXPECT_TRUE(KeptBlocks(Project{"/does/not/exist"}, {}, {}, false).empty());
}

}  // namespace
}  // namespace skyquilt::coordinator
