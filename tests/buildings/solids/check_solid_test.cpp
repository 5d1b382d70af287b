#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "buildings/solids/build_solids.h"
#include "tests/buildings/solids/made_solids.h"

namespace skyquilt::buildings {
namespace {

using Codes = std::set<int>;

Codes CodesOf(const Solid& solid) {
  Codes codes;
  for (const SolidProblem& problem : CheckSolid(solid)) {
    codes.insert(problem.code);
    EXPECT_EQ(problem.text.back(), '.') << problem.text;
  }
  return codes;
}

Solid Box() {
  return MakeBox({1.0, 2.0, 3.0}, {10.0, 8.0, 5.0});
}

TEST(CheckSolid, AcceptsGoodSolids) {
  EXPECT_EQ(CodesOf(Box()), Codes{}) << TextOf(CheckSolid(Box()));
  EXPECT_EQ(CodesOf(MakePodium()), Codes{}) << TextOf(CheckSolid(MakePodium()));
  // Far from the origin, with sizes of millimetres' resolution.
  EXPECT_EQ(CodesOf(MakeBox({12345.678, -9876.543, 321.098}, {0.012, 0.013, 0.014})), Codes{});
}

TEST(CheckSolid, FindsNoSolid) {
  EXPECT_EQ(CodesOf(Solid{}), Codes{301});
}

struct Fault {
  const char* what;
  void (*make)(Solid& box);
  Codes codes;
};

TEST(CheckSolid, FindsFaultsOfABox) {
  const Fault faults[] = {
      {"too few points",
       [](Solid& box) {
         box.face[0].outer = {3, 2};
       },
       {101}},
      {"a point twice in a row",
       [](Solid& box) {
         box.face[0].outer = {3, 2, 2, 1, 0};
       },
       {102}},
      {"a bow tie",
       [](Solid& box) {
         box.face[1].outer = {4, 5, 7, 6};
       },
       {104}},
      {"a ring that runs out along an edge and back",
       [](Solid& box) {
         box.vertex.emplace_back(5.0, 2.0, 8.0);
         box.face[1].outer = {4, 5, 8, 6, 7};
       },
       {104}},
      {"a face that is not planar: a quarter of this off the mean plane", [](Solid& box) { box.vertex[6].z() += 0.044; }, {203}},
      {"a face that is planar enough", [](Solid& box) { box.vertex[6].z() += 0.036; }, {}},
      {"an open shell", [](Solid& box) { box.face.pop_back(); }, {302}},
      {"hardly a shell", [](Solid& box) { box.face.resize(3); }, {301}},
      {"a turned face", [](Solid& box) { std::reverse(box.face[3].outer.begin(), box.face[3].outer.end()); }, {307}},
      {"all faces turned",
       [](Solid& box) {
         for (Face& face : box.face) std::reverse(face.outer.begin(), face.outer.end());
       },
       {405}},
      {"an unused vertex", [](Solid& box) { box.vertex.emplace_back(50.0, 0.0, 0.0); }, {309}},
      {"a number that is none", [](Solid& box) { box.vertex[2].y() = std::numeric_limits<double>::quiet_NaN(); }, {902}},
      {"a vertex that is not there", [](Solid& box) { box.face[2].outer[1] = 8; }, {902}},
  };
  for (const Fault& fault : faults) {
    Solid solid = Box();
    fault.make(solid);
    EXPECT_EQ(CodesOf(solid), fault.codes) << fault.what;
  }
}

TEST(CheckSolid, FindsVerticesNearerThanAMillimetre) {
  Solid solid = Box();
  solid.vertex.emplace_back(solid.vertex[5] + Eigen::Vector3d(0.0005, 0.0, 0.0));
  std::replace(solid.face[1].outer.begin(), solid.face[1].outer.end(), 5U, 8U);
  EXPECT_EQ(CodesOf(solid), Codes{kNearVertices});
  solid.face[1].outer = {4, 5, 8, 6, 7};
  EXPECT_EQ(CodesOf(solid), (Codes{kNearVertices, 102}));
}

TEST(CheckSolid, FindsRingsThatCrossThemselves) {
  Solid solid = MakePodium();
  solid.face[1] = {FaceKind::kRoof, {4, 5, 6, 7, 4, 8, 11, 10, 9, 8}, {}};  // passes vertices twice
  EXPECT_EQ(CodesOf(solid), Codes{104});
}

TEST(CheckSolid, FindsRingsThatCrossEachOther) {
  Solid solid = MakePodium();
  for (const uint32_t v : {8U, 11U, 12U, 15U}) solid.vertex[v].x() = -1.0;
  EXPECT_TRUE(CodesOf(solid).contains(201));
}

TEST(CheckSolid, FindsFoldsTooSmallForThePlane) {
  // A step of 8 mm across the roof within 4 mm.
  Solid solid = Box();
  solid.vertex = {{0, 0, 0},      {10, 0, 0}, {10, 8, 0}, {0, 8, 0},         {0, 0, 5},         {10, 0, 5.008},
                  {10, 8, 5.008}, {0, 8, 5},  {5, 0, 5},  {5.004, 0, 5.008}, {5.004, 8, 5.008}, {5, 8, 5}};
  solid.face[1].outer = {4, 8, 9, 5, 6, 10, 11, 7};
  solid.face[2].outer = {0, 1, 5, 9, 8, 4};
  solid.face[4].outer = {2, 3, 7, 11, 10, 6};
  EXPECT_EQ(CodesOf(solid), Codes{204});
}

TEST(CheckSolid, FindsWrongHoles) {
  Solid outside = MakePodium();
  for (uint32_t v = 8; v < 16; ++v) outside.vertex[v].x() += 20.0;
  EXPECT_EQ(CodesOf(outside), Codes{206});
  Solid nested = MakePodium();
  nested.vertex.insert(nested.vertex.end(), {{4.5, 4.5, 4}, {5.5, 4.5, 4}, {5.5, 5.5, 4}, {4.5, 5.5, 4}});
  nested.face[1].holes.push_back({19, 18, 17, 16});
  EXPECT_EQ(CodesOf(nested), Codes{207});
  Solid turned = MakePodium();
  std::reverse(turned.face[1].holes[0].begin(), turned.face[1].holes[0].end());
  EXPECT_EQ(CodesOf(turned), Codes{208});
}

TEST(CheckSolid, FindsOpenShells) {
  Solid solid = MakePodium();
  solid.face[1].holes.clear();
  EXPECT_TRUE(CodesOf(solid).contains(302));
}

TEST(CheckSolid, FindsShellsThatTouchInAPointOrEdge) {
  const Solid box = Box();
  const Solid corner = Together(box, MakeBox({11.0, 10.0, 8.0}, {2.0, 2.0, 2.0}));
  EXPECT_EQ(CodesOf(corner), (Codes{303, 305}));
  const Solid edge = Together(box, MakeBox({11.0, 10.0, 3.0}, {2.0, 2.0, 5.0}));
  EXPECT_EQ(CodesOf(edge), Codes{304});
}

TEST(CheckSolid, FindsComponents) {
  EXPECT_EQ(CodesOf(Together(Box(), MakeBox({30.0, 0.0, 0.0}, {1.0, 1.0, 1.0}))), Codes{305});
}

TEST(CheckSolid, FindsFacesThatCross) {
  Solid solid = MakePodium();
  for (uint32_t v = 12; v < 16; ++v) solid.vertex[v].z() = -3.0;  // the tower grows down through the ground
  EXPECT_TRUE(CodesOf(solid).contains(306)) << TextOf(CheckSolid(solid));
  // A shaft that ends exactly on the ground face touches it.
  for (uint32_t v = 12; v < 16; ++v) solid.vertex[v].z() = 0.0;
  EXPECT_EQ(CodesOf(solid), Codes{306});
  for (uint32_t v = 12; v < 16; ++v) solid.vertex[v].z() = 0.1;
  EXPECT_EQ(CodesOf(solid), Codes{}) << TextOf(CheckSolid(solid));
}

TEST(CheckSolid, FindsFacesFoldedOntoTheirNeighbours) {
  // The middle of the eastern wall is pulled into the roof's plane: its upper part lies below the roof.
  Solid solid = Box();
  solid.vertex.emplace_back(9.0, 6.0, 8.0);
  solid.face[3].outer = {1, 2, 8};
  for (const std::vector<uint32_t>& ring : {std::vector<uint32_t>{2, 6, 8}, {6, 5, 8}, {5, 1, 8}}) solid.face.push_back({FaceKind::kWall, ring, {}});
  EXPECT_EQ(CodesOf(solid), Codes{306});
  EXPECT_NE(TextOf(CheckSolid(solid)).find("Faces 1 and 7 "), std::string::npos);
  solid.vertex[8].z() = 7.0;
  EXPECT_EQ(CodesOf(solid), Codes{}) << TextOf(CheckSolid(solid));
}

}  // namespace
}  // namespace skyquilt::buildings
