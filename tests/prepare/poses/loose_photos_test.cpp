#include "prepare/poses/loose_photos.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace skyquilt::prepare::poses {
namespace {

// A model that is filled by points.
struct Made {
  survey::ColmapModel model;
  survey::ColmapObservations observations;

  explicit Made(uint32_t n_photos) {
    model.cameras[1] = {camera::CameraModel::kPinhole, 64, 48, {60.0, 60.0, 32.0, 24.0}};
    for (uint32_t id = 1; id <= n_photos; ++id) {
      model.images.push_back({id, 1, "photo_" + std::to_string(id), {}});
      observations[id];
    }
  }
  void Add(const std::vector<uint32_t>& track, size_t n) {
    for (size_t i = 0; i < n; ++i) {
      survey::ColmapPoint point;
      point.id = model.points.size() + 1;
      point.image_ids = track;
      for (const uint32_t id : track) observations[id].push_back({point.id, {1.0, 2.0}});
      model.points.push_back(point);
    }
  }
  std::vector<std::string> Remove() { return RemoveLoosePhotos(model, observations); }
};

// Photos 1 to 4 are a flight; 5 and 6 are of another place, like the flight in a few points of many photos.
Made WithStrangers() {
  Made made(6);
  for (uint32_t id = 1; id < 4; ++id) made.Add({id, id + 1}, 50);
  made.Add({6, 5}, 300);
  for (uint32_t id = 1; id <= 4; ++id) made.Add({5, id}, 9);
  made.Add({6, 2, 1}, 5);
  return made;
}

TEST(LoosePhotos, StrangersLoseTheirPoses) {
  Made made = WithStrangers();
  EXPECT_EQ(made.Remove(), (std::vector<std::string>{"photo_5", "photo_6"}));
  ASSERT_EQ(made.model.images.size(), 4U);
  // Own points, and those that two of the flight still see.
  EXPECT_EQ(made.model.points.size(), 155U);
  EXPECT_FALSE(made.observations.contains(5) || made.observations.contains(6));
  EXPECT_EQ(made.observations[1].size(), 55U);
  EXPECT_EQ(made.observations[3].size(), 100U);
  EXPECT_EQ(made.Remove(), std::vector<std::string>());
  // Every track entry has its observation.
  const TemporaryFolder folder;
  survey::WriteColmapBinary(made.model, made.observations, folder / "model");
  EXPECT_EQ(survey::ReadColmapModel(folder / "model").points.size(), 155U);
}

TEST(LoosePhotos, TenCommonPointsTie) {
  Made made = WithStrangers();
  made.Add({5, 3}, 1);
  EXPECT_EQ(made.Remove(), std::vector<std::string>());
  EXPECT_EQ(made.model.images.size(), 6U);
  // A point counts once, however often a photo sees it.
  Made twice(3);
  twice.Add({1, 2}, 20);
  twice.Add({3, 1, 3}, 9);
  EXPECT_EQ(twice.Remove(), std::vector<std::string>{"photo_3"});
}

// Long tracks tie all their photos, one with the next.
TEST(LoosePhotos, LongTracksTie) {
  Made made(60);
  std::vector<uint32_t> track;
  for (uint32_t id = 60; id > 0; --id) track.push_back(id);
  made.Add(track, 10);
  EXPECT_EQ(made.Remove(), std::vector<std::string>());
}

TEST(LoosePhotos, OfAModelWithoutPointsNothingIsKnown) {
  Made made(3);
  EXPECT_EQ(made.Remove(), std::vector<std::string>());
  EXPECT_EQ(made.model.images.size(), 3U);
}

}  // namespace
}  // namespace skyquilt::prepare::poses
