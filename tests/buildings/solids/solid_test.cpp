#include "buildings/solids/solid.h"

#include <gtest/gtest.h>

#include "tests/buildings/solids/made_solids.h"

namespace skyquilt::buildings {
namespace {

TEST(Solid, EmptyHasNothing) {
  EXPECT_TRUE(Solid{}.Empty());
  EXPECT_EQ(Volume(Solid{}), 0.0);
  EXPECT_EQ(Area(Solid{}, FaceKind::kWall), 0.0);
  EXPECT_TRUE(Triangulate(Solid{}).triangle.empty());
}

TEST(Solid, BoxHasVolumeAndAreasFarFromTheOrigin) {
  Solid box = MakeBox({5e5, -5e6, 300.0}, {4.0, 3.0, 2.0});
  EXPECT_NEAR(Volume(box), 24.0, 1e-6);
  EXPECT_NEAR(Area(box, FaceKind::kGround), 12.0, 1e-6);
  EXPECT_NEAR(Area(box, FaceKind::kRoof), 12.0, 1e-6);
  EXPECT_NEAR(Area(box, FaceKind::kWall), 28.0, 1e-6);
  for (Face& face : box.face) std::reverse(face.outer.begin(), face.outer.end());
  EXPECT_NEAR(Volume(box), -24.0, 1e-6);
}

TEST(Solid, HolesOfFacesCount) {
  const Solid podium = MakePodium();
  EXPECT_NEAR(Volume(podium), 400.0 + 24.0, 1e-9);
  EXPECT_NEAR(Area(podium, FaceKind::kRoof), 100.0, 1e-9);
  EXPECT_NEAR(Area(podium, FaceKind::kWall), 160.0 + 48.0, 1e-9);
}

TEST(Triangulate, NamesTheFaceOfEachTriangle) {
  const Solid podium = MakePodium();
  const SolidTriangles triangles = Triangulate(podium);
  ASSERT_EQ(triangles.triangle.size(), triangles.face.size());
  std::vector<int> n(podium.face.size(), 0);
  for (const uint32_t f : triangles.face) ++n[f];
  for (size_t f = 0; f < n.size(); ++f) EXPECT_EQ(n[f], f == 1 ? 8 : 2) << f;
}

TEST(Triangulate, LeavesOutFacesWithoutArea) {
  Solid box = MakeBox({0.0, 0.0, 0.0}, {4.0, 3.0, 2.0});
  box.face[0].outer = {3, 2};
  box.face[1].outer = {4, 6, 5, 7};  // bow tie
  const SolidTriangles triangles = Triangulate(box);
  for (const uint32_t f : triangles.face) EXPECT_GE(f, 2U);
  EXPECT_EQ(triangles.face.size(), 8U);
}

}  // namespace
}  // namespace skyquilt::buildings
