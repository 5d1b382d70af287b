#include "simulate/model_frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/progress.h"
#include "core/base/random.h"
#include "simulate/flight.h"
#include "simulate/survey_writer.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::simulate {
namespace {

survey::ColmapModel TownModel() {
  const PlaceSpec place = ResolvePlace({});
  std::vector<survey::ColmapPoint> points(200);
  base::Random random(3);
  for (size_t i = 0; i < points.size(); ++i) {
    points[i].id = i + 1;
    points[i].x_in_world = {random.Uniform(-100.0, 100.0), random.Uniform(-100.0, 100.0), random.Uniform(0.0, 20.0)};
  }
  return MakeModel(place.camera, PlanFlight(place, 0.0), points);
}

TEST(ModelFrame, ReprojectionsStayTheSame) {
  const survey::ColmapModel exact = TownModel();
  for (uint32_t seed = 0; seed < 20; ++seed) {
    survey::ColmapModel moved = exact;
    const geo::Similarity3d model_from_enu = RandomModelFrame(seed);
    MoveModel(model_from_enu, moved);
    int n_seen = 0;
    for (size_t i = 0; i < exact.images.size(); ++i) {
      const Eigen::Vector3d centre = model_from_enu * exact.images[i].cam_from_world.OriginInSource();
      EXPECT_LT((moved.images[i].cam_from_world.OriginInSource() - centre).norm(), 1e-9 * model_from_enu.scale * 100.0);
      for (size_t j = 0; j < exact.points.size(); ++j) {
        const auto before = exact.cameras.at(1).ImgFromCam(exact.images[i].cam_from_world * exact.points[j].x_in_world);
        const auto after = moved.cameras.at(1).ImgFromCam(moved.images[i].cam_from_world * moved.points[j].x_in_world);
        ASSERT_EQ(before.has_value(), after.has_value());
        if (!before) continue;
        // Far outside the photo the projection magnifies rounding errors.
        EXPECT_LT((*before - *after).norm(), 1e-6 * (1.0 + before->norm()));
        ++n_seen;
      }
    }
    EXPECT_GT(n_seen, 1000);
  }
}

// With all digits: what is trained from a simulated survey does not depend on how its model is written.
TEST(WriteModel, TheModelIsReadBackUnchanged) {
  base::Progress::SetQuiet(true);
  survey::ColmapModel model = TownModel();
  base::Random random(8);
  for (survey::ColmapPoint& point : model.points) {
    for (const survey::ColmapImage& image : model.images) {
      if (random.Below(10) == 0) point.image_ids.push_back(image.id);
    }
    point.error_px = random.Uniform(0.2, 0.9);
  }
  for (const bool exact : {true, false}) {
    if (!exact) MoveModel(RandomModelFrame(4), model);
    const TemporaryFolder folder;
    WriteModel(folder.path(), model);
    const survey::ColmapModel read = survey::ReadColmapModel(folder / "sparse/0");
    ASSERT_EQ(read.images.size(), model.images.size());
    for (size_t i = 0; i < read.images.size(); ++i) {
      EXPECT_EQ(read.images[i].name, model.images[i].name);
      EXPECT_TRUE(read.images[i].cam_from_world.translation == model.images[i].cam_from_world.translation);
      EXPECT_LT((read.images[i].cam_from_world.rotation.coeffs() - model.images[i].cam_from_world.rotation.coeffs()).norm(), 1e-15);
    }
    ASSERT_EQ(read.points.size(), model.points.size());
    for (size_t i = 0; i < read.points.size(); ++i) {
      EXPECT_TRUE(read.points[i].x_in_world == model.points[i].x_in_world);
      EXPECT_EQ(read.points[i].error_px, model.points[i].error_px);
      EXPECT_EQ(read.points[i].image_ids, model.points[i].image_ids);
    }
  }
}

TEST(ModelFrame, TheInverseLeadsBack) {
  for (uint32_t seed = 0; seed < 20; ++seed) {
    const geo::Similarity3d model_from_enu = RandomModelFrame(seed);
    const Eigen::Vector3d x(12.0, -70.0, 33.0);
    EXPECT_LT((Inverse(model_from_enu) * (model_from_enu * x) - x).norm(), 1e-9);
  }
}

TEST(ModelFrame, FramesAreFarApartButReproducible) {
  double smallest = 1e9;
  double largest = 0.0;
  double farthest = 0.0;
  Eigen::Vector3d up_sum = Eigen::Vector3d::Zero();
  constexpr int kSeeds = 300;
  for (uint32_t seed = 0; seed < kSeeds; ++seed) {
    const geo::Similarity3d frame = RandomModelFrame(seed);
    const geo::Similarity3d again = RandomModelFrame(seed);
    EXPECT_EQ(frame.scale, again.scale);
    EXPECT_TRUE(frame.rotation.coeffs() == again.rotation.coeffs());
    EXPECT_TRUE(frame.translation == again.translation);
    smallest = std::min(smallest, frame.scale);
    largest = std::max(largest, frame.scale);
    farthest = std::max(farthest, frame.translation.norm());
    up_sum += frame.rotation * Eigen::Vector3d::UnitZ();
  }
  EXPECT_GE(smallest, 0.02);
  EXPECT_LT(smallest, 0.04);
  EXPECT_LE(largest, 50.0);
  EXPECT_GT(largest, 25.0);
  EXPECT_LE(farthest, 10.0);
  EXPECT_GT(farthest, 8.0);
  // Up has no preferred direction: the mean of 300 is about 0.06 long.
  EXPECT_LT(up_sum.norm() / kSeeds, 0.2);
}

}  // namespace
}  // namespace skyquilt::simulate
