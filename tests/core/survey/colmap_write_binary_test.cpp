#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/base/random.h"
#include "core/survey/colmap_model.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::survey {
namespace {

constexpr const char* kBinaryNames[] = {"cameras.bin", "images.bin", "points3D.bin"};

// Cameras above a plane of points, image ids with gaps and in no order. Some points are observed by none, the first image observes nothing.
ColmapModel FlightOver(uint64_t seed) {
  base::Random random(seed);
  ColmapModel model;
  model.cameras[4] = {camera::CameraModel::kOpencv, 640, 480, {500.0, 501.0, 320.5, 240.25, 0.01, -0.002, 1e-4, -1e-4}};
  model.cameras[9] = {camera::CameraModel::kSimplePinhole, 100, 80, {90.0, 50.0, 40.0}};
  for (const uint32_t id : {7U, 3U, 900U, 12U, 5U, 40000000U}) {
    ColmapImage image;
    image.id = id;
    image.camera_id = id % 2 == 0 ? 4 : 9;
    image.name = id == 12 ? "flight 2/b photo.jpg" : "a" + std::to_string(id) + ".jpg";
    const double x = random.Uniform(-0.1, 0.1), y = random.Uniform(-0.1, 0.1), z = random.Uniform(-3.0, 3.0);
    image.cam_from_world.rotation = Eigen::Quaterniond(x, 1.0, y, z).normalized();
    const double across = random.Uniform(-5.0, 5.0), along = random.Uniform(-5.0, 5.0);
    image.cam_from_world.translation = {across, along, 40.0};
    model.images.push_back(image);
  }
  for (uint64_t i = 0; i < 60; ++i) {
    ColmapPoint point;
    point.id = 1000 + 7 * i;
    const double x = random.Uniform(-20.0, 20.0), y = random.Uniform(-20.0, 20.0);
    point.x_in_world = {x, y, 1.0 / 3.0};
    point.rgb = {static_cast<uint8_t>(i), 255, 0};
    point.error_px = random.Uniform(0.2, 0.9);
    for (size_t k = 1; k < model.images.size(); ++k) {
      if (random.Below(2) == 0) point.image_ids.push_back(model.images[k].id);
    }
    if (i % 10 == 0) point.image_ids.clear();
    model.points.push_back(point);
  }
  return model;
}

void ExpectSameModel(const ColmapModel& a, const ColmapModel& b) {
  ASSERT_EQ(a.images.size(), b.images.size());
  for (size_t i = 0; i < a.images.size(); ++i) {
    EXPECT_EQ(a.images[i].id, b.images[i].id);
    EXPECT_EQ(a.images[i].camera_id, b.images[i].camera_id);
    EXPECT_EQ(a.images[i].name, b.images[i].name);
    EXPECT_TRUE(a.images[i].cam_from_world.rotation.coeffs() == b.images[i].cam_from_world.rotation.coeffs());
    EXPECT_TRUE(a.images[i].cam_from_world.translation == b.images[i].cam_from_world.translation);
    EXPECT_EQ(a.cameras.at(a.images[i].camera_id).params, b.cameras.at(b.images[i].camera_id).params);
  }
  ASSERT_EQ(a.points.size(), b.points.size());
  for (size_t i = 0; i < a.points.size(); ++i) {
    EXPECT_EQ(a.points[i].id, b.points[i].id);
    EXPECT_TRUE(a.points[i].x_in_world == b.points[i].x_in_world);
    EXPECT_EQ(a.points[i].rgb, b.points[i].rgb);
    EXPECT_EQ(a.points[i].error_px, b.points[i].error_px);
    EXPECT_EQ(a.points[i].image_ids, b.points[i].image_ids);
  }
}

void ExpectSameObservations(const ColmapObservations& a, const ColmapObservations& b) {
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [id, list] : a) {
    ASSERT_TRUE(b.contains(id));
    const std::vector<ColmapObservation>& other = b.at(id);
    ASSERT_EQ(list.size(), other.size());
    for (size_t k = 0; k < list.size(); ++k) {
      EXPECT_EQ(list[k].point_id, other[k].point_id);
      EXPECT_TRUE(list[k].pixel == other[k].pixel);
    }
  }
}

class ProjectedColmapBinary : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { base::Progress::SetQuiet(true); }
};

// To the last bit: what is trained from a model does not depend on the format that it was written in.
TEST_F(ProjectedColmapBinary, HoldsExactlyWhatTheTextHolds) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    ColmapModel model = FlightOver(seed);
    // A track may name an image twice, and a point may be where no image shows it.
    model.points[5].image_ids = {900, 12, 900};
    model.points[6].x_in_world = {0.0, 0.0, 1e9};
    model.points[6].image_ids = {3, 900, 12, 5};
    const TemporaryFolder text, binary;
    WriteColmapText(model, text.path());
    WriteProjectedColmapBinary(model, binary.path());
    const ColmapModel read = ReadColmapModel(binary.path());
    ExpectSameModel(read, ReadColmapModel(text.path()));
    EXPECT_EQ(read.points[5].image_ids, model.points[5].image_ids);
    const ColmapObservations observations = ReadColmapObservations(binary.path());
    ExpectSameObservations(observations, ReadColmapObservations(text.path()));
    EXPECT_TRUE(observations.at(7).empty());
  }
}

// Byte for byte the file of measured observations, which looks up where an image lists a point.
TEST_F(ProjectedColmapBinary, TracksPointToTheirObservations) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const ColmapModel model = FlightOver(seed);
    const TemporaryFolder projected, measured;
    WriteProjectedColmapBinary(model, projected.path());
    WriteColmapBinary(model, ReadColmapObservations(projected.path()), measured.path());
    for (const char* name : kBinaryNames) EXPECT_TRUE(base::ReadFile(projected / name) == base::ReadFile(measured / name)) << name;
  }
}

TEST_F(ProjectedColmapBinary, AModelWithoutPointsHasOnlyPoses) {
  ColmapModel model = FlightOver(1);
  model.points.clear();
  const TemporaryFolder folder, text;
  WriteProjectedColmapBinary(model, folder.path());
  WriteColmapText(model, text.path());
  ExpectSameModel(ReadColmapModel(folder.path()), ReadColmapModel(text.path()));
  for (const auto& [id, list] : ReadColmapObservations(folder.path())) EXPECT_TRUE(list.empty()) << id;
}

TEST_F(ProjectedColmapBinary, CancelledItLeavesTheFolderAsItWas) {
  const TemporaryFolder folder;
  WriteProjectedColmapBinary(FlightOver(1), folder.path());
  const std::string before = base::ReadFile(folder / "images.bin");
  ExpectStopsWhenAsked([&] { WriteProjectedColmapBinary(FlightOver(2), folder.path()); });
  EXPECT_TRUE(base::ReadFile(folder / "images.bin") == before);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), std::filesystem::directory_iterator()), 3);
}

TEST_F(ProjectedColmapBinary, ATrackOfAnUnknownImageIsRefused) {
  ColmapModel model = FlightOver(1);
  model.points[3].image_ids.push_back(8);
  const TemporaryFolder folder;
  EXPECT_THROW(WriteProjectedColmapBinary(model, folder.path()), std::logic_error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace skyquilt::survey
