#include "surface/texture/view_choice.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>

#include "surface/texture/texel_colors.h"
#include "texture_meshes.h"

namespace skyquilt::surface {
namespace {

using testing::FilledView;
using testing::HeightField;
using testing::PoseAt;
using testing::ViewOf;

// The best view of each texel of a level square of 4 x 4 m.
class PlaneViews {
 public:
  PlaneViews()
      : mesh_(HeightField(4, 1.0, [](double, double) { return 0.0; })), geometry_(GeometryOf(mesh_)), layout_(LayOutAtlas(geometry_, 0.1, 512)) {}

  std::vector<int32_t> Choose(const std::vector<FilledView>& filled, int n_threads = 1) const {
    std::vector<DepthView> views;
    for (const FilledView& view : filled) views.push_back(view.Get());
    base::ThreadPool threads(n_threads);
    const AtlasTexels texels = FindTexels(geometry_, layout_, threads);
    std::vector<int32_t> best(texels.texel.size(), -2);
    for (const TexelBlock& block : ChooseViews(geometry_, layout_, texels, views, 0.3, threads)) {
      for (const uint32_t i : block.texel) best[i] = block.view[0];
    }
    EXPECT_EQ(std::count(best.begin(), best.end(), -2), 0);
    return best;
  }

 private:
  Mesh mesh_;
  TileGeometry geometry_;
  AtlasLayout layout_;
};

FilledView LookingDown(const Eigen::Vector3d& centre, int photo, const testing::Surface& surface = testing::PlaneAtZero) {
  return ViewOf(PoseAt(centre, -Eigen::Vector3d::UnitZ(), 64, 60.0, photo), surface);
}

int CountOf(const std::vector<int32_t>& chosen, int32_t view) {
  return static_cast<int>(std::count(chosen.begin(), chosen.end(), view));
}

TEST(ViewChoice, TakesTheNearestOfPhotosThatLookAtTheSameAngle) {
  const std::vector<int32_t> chosen = PlaneViews().Choose({LookingDown({2, 2, 20}, 0), LookingDown({2, 2, 10}, 1), LookingDown({2, 2, 15}, 2)});
  EXPECT_EQ(CountOf(chosen, 1), static_cast<int>(chosen.size()));
}

TEST(ViewChoice, TakesTheSquarestOfPhotosAtTheSameDistance) {
  const FilledView oblique = ViewOf(PoseAt({12, 2, 10}, {-1, 0, -1}, 64, 60.0, 0), testing::PlaneAtZero);
  const std::vector<int32_t> chosen = PlaneViews().Choose({oblique, LookingDown({2, 2, 14}, 1)});
  EXPECT_EQ(CountOf(chosen, 1), static_cast<int>(chosen.size()));
}

TEST(ViewChoice, DoesNotTakeAPhotoThatIsBlocked) {
  // A box hangs between the near photo and the ground.
  const testing::Surface box = testing::BoxSurface({-50, -50, 5}, {50, 50, 6});
  const std::vector<FilledView> views = {LookingDown({2, 2, 10}, 0, box), LookingDown({2, 2, 20}, 1)};
  const std::vector<int32_t> chosen = PlaneViews().Choose(views);
  EXPECT_EQ(CountOf(chosen, 1), static_cast<int>(chosen.size()));
}

TEST(ViewChoice, TakesVirtualViewsOnlyWhereNoPhotoSees) {
  FilledView photo = LookingDown({2, 2, 20}, 5);
  const FilledView virtual_view = LookingDown({2, 2, 10}, -1);
  const PlaneViews plane;
  EXPECT_EQ(CountOf(plane.Choose({virtual_view, photo}), 0), 0);
  std::fill(photo.depth_m.begin(), photo.depth_m.end(), std::nanf(""));
  const std::vector<int32_t> chosen = plane.Choose({virtual_view, photo});
  EXPECT_EQ(CountOf(chosen, 0), static_cast<int>(chosen.size()));
}

TEST(ViewChoice, NoViewIsTakenFromBehindOrWithoutDepths) {
  const FilledView below = ViewOf(PoseAt({2, 2, -10}, Eigen::Vector3d::UnitZ(), 64, 60.0, 0), testing::PlaneAtZero);
  FilledView empty = LookingDown({2, 2, 10}, 1);
  empty.depth_m.clear();
  const std::vector<int32_t> chosen = PlaneViews().Choose({below, empty});
  EXPECT_FALSE(chosen.empty());
  EXPECT_EQ(CountOf(chosen, -1), static_cast<int>(chosen.size()));
}

// Each photo shows one half only; the choice may differ by a block of texels at the border between them.
TEST(ViewChoice, DiffersFromPlaceToPlaceAndNotFromThreadToThread) {
  FilledView left = LookingDown({2, 2, 10}, 0);
  FilledView right = left;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const bool is_left = left.pose.Centre().x() + left.pose.DirectionAt(x + 0.5, y + 0.5).x() * 10.0 < 2.0;
      (is_left ? right : left).depth_m[static_cast<size_t>(y * 64 + x)] = std::nanf("");
    }
  }
  const PlaneViews plane;
  const std::vector<int32_t> chosen = plane.Choose({left, right});
  EXPECT_GT(CountOf(chosen, 0), static_cast<int>(chosen.size()) / 3);
  EXPECT_GT(CountOf(chosen, 1), static_cast<int>(chosen.size()) / 3);
  EXPECT_EQ(CountOf(chosen, -1), 0);
  EXPECT_EQ(plane.Choose({left, right}, 4), chosen);
}

RC_GTEST_PROP(ViewChoice, ABallIsNeverLeftOutOfAPictureThatShowsPartOfIt, ()) {
  base::Random random(*rc::gen::arbitrary<uint64_t>());
  const auto place = [&random] { return Eigen::Vector3d{random.Uniform(-9.0, 9.0), random.Uniform(-9.0, 9.0), random.Uniform(-9.0, 9.0)}; };
  ViewPose pose = PoseAt(place(), place(), 64, 50.0, 0);
  pose.cx = random.Uniform(10.0, 50.0);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d centre = place();
    const double radius = random.Uniform(0.1, 4.0);
    for (int k = 0; k < 20; ++k) {
      const Eigen::Vector3d inside = centre + place().normalized() * (radius * random.UniformDouble());
      if (pose.Project(inside)) RC_ASSERT(MayShow(pose, centre, radius));
    }
  }
}

TEST(ViewChoice, BallsBehindTheCameraOrBesideThePictureAreLeftOut) {
  const ViewPose pose = PoseAt({0, 0, 10}, -Eigen::Vector3d::UnitZ(), 64, 60.0, 0);
  EXPECT_TRUE(MayShow(pose, {0, 0, 0}, 1.0));
  EXPECT_FALSE(MayShow(pose, {0, 0, 20}, 1.0));
  EXPECT_FALSE(MayShow(pose, {20, 0, 0}, 1.0));
  EXPECT_FALSE(MayShow(pose, {0, -20, 0}, 1.0));
}

TEST(TexelRay, StartsAtTheCameraAndEndsBehindTheMesh) {
  const Eigen::Vector3d camera(3, 0, 4);
  const render::Ray ray = RayToTexel({0, 0, 0}, Eigen::Vector3d::UnitZ(), &camera, {0.4, 0.6}, 0.1F);
  EXPECT_EQ(ray.origin_enu, camera);
  EXPECT_LT((ray.direction_enu - Eigen::Vector3d(-0.6, 0, -0.8)).norm(), 1e-12);
  EXPECT_NEAR(ray.t_near, 4.6, 1e-12);
  EXPECT_NEAR(ray.t_far, 5.6, 1e-12);
  EXPECT_FLOAT_EQ(static_cast<float>(ray.Footprint(5.0)), 0.1F);
  const Eigen::Vector3d close(0, 0, 0.1);
  EXPECT_EQ(RayToTexel({0, 0, 0}, Eigen::Vector3d::UnitZ(), &close, {0.4, 0.6}, 0.1F).t_near, 0.0);
}

TEST(TexelRay, FollowsTheNormalWithoutACameraOrAtTooFlatAnAngle) {
  const Eigen::Vector3d flat(10, 0, 0.5);
  const Eigen::Vector3d behind(0, 0, -5);
  const Eigen::Vector3d same(1, 2, 3);
  for (const Eigen::Vector3d* camera : {static_cast<const Eigen::Vector3d*>(nullptr), &flat, &behind, &same}) {
    const render::Ray ray = RayToTexel(same, Eigen::Vector3d::UnitZ(), camera, {0.4, 0.6}, 0.1F);
    EXPECT_LT((ray.origin_enu - Eigen::Vector3d(1, 2, 3.4)).norm(), 1e-12);
    EXPECT_EQ(ray.direction_enu, Eigen::Vector3d(0, 0, -1));
    EXPECT_EQ(ray.t_near, 0.0);
    EXPECT_NEAR(ray.t_far, 1.0, 1e-12);
  }
}

}  // namespace
}  // namespace skyquilt::surface
