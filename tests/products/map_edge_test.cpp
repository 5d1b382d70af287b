#include "products/photo_map/map_edge.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "core/base/file.h"
#include "tests/core/gis/open_dataset.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::products {
namespace {

using MapEdge = InTemporaryFolder;
using Rings = std::vector<std::vector<Eigen::Vector2d>>;

constexpr double kCell_m = 0.4;
constexpr int kColumns = 300, kRows = 240;

// Places are in metres from the south-western corner of the lattice, 120 m by 96 m.
SeenLattice Seen(const std::function<int(const Eigen::Vector2d&)>& photos_at) {
  SeenLattice seen;
  seen.grid = {
      .georeferenced = true, .zone = {32, true}, .left = 500000.0, .top = 5000000.0, .resolution_m = kCell_m, .width = kColumns, .height = kRows};
  const Eigen::Vector2d corner(500000.0, 5000000.0 - kRows * kCell_m);
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column)
      seen.photos.push_back(static_cast<uint8_t>(photos_at(seen.grid.CellCentre(column, row) - corner)));
  }
  return seen;
}

bool InDisc(const Eigen::Vector2d& p, double x, double y, double radius_m) {
  return (p - Eigen::Vector2d(x, y)).norm() < radius_m;
}

// Counter-clockwise is positive.
double AreaOf(const std::vector<Eigen::Vector2d>& ring) {
  double twice = 0.0;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d a = ring[i] - ring[0], b = ring[(i + 1) % ring.size()] - ring[0];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

// Least and most distance of a ring's points, and of the middles of its edges, from a place.
std::pair<double, double> Reach(const std::vector<Eigen::Vector2d>& ring, double x, double y) {
  const Eigen::Vector2d place(500000.0 + x, 5000000.0 - kRows * kCell_m + y);
  double least = 1e9, most = 0.0;
  for (size_t i = 0; i < ring.size(); ++i) {
    for (const double share : {0.0, 0.5}) {
      const double away = ((1.0 - share) * ring[i] + share * ring[(i + 1) % ring.size()] - place).norm();
      least = std::min(least, away);
      most = std::max(most, away);
    }
  }
  return {least, most};
}

TEST_F(MapEdge, FollowsADiscWithoutStairs) {
  for (const double crop_m : {0.0, 5.0, 7.7}) {
    const Rings rings = CutlineOf(Seen([](const auto& p) { return InDisc(p, 60, 48, 40) ? 2 : 1; }), 2, crop_m);
    ASSERT_EQ(rings.size(), 1U);
    const auto [least, most] = Reach(rings[0], 60, 48);
    EXPECT_NEAR(least, 40 - crop_m, kCell_m);
    EXPECT_NEAR(most, 40 - crop_m, kCell_m);
    EXPECT_NEAR(AreaOf(rings[0]), std::numbers::pi * (40 - crop_m) * (40 - crop_m), 2 * std::numbers::pi * 40 * 0.5 * kCell_m);
    EXPECT_LT(rings[0].size(), 80U) << "simplified";
    for (size_t i = 0; i < rings[0].size(); ++i) {
      const Eigen::Vector2d a = rings[0][i], b = rings[0][(i + 1) % rings[0].size()], c = rings[0][(i + 2) % rings[0].size()];
      EXPECT_GT((b - a).normalized().dot((c - b).normalized()), 0.8) << "a corner in a round outline";
    }
  }
}

TEST_F(MapEdge, CropMovesStraightEdgesInwards) {
  // A square that is turned, so that its edges run along neither rows nor columns.
  const Eigen::Vector2d along(std::cos(0.3), std::sin(0.3)), across(-along.y(), along.x());
  const auto in_square = [&](const Eigen::Vector2d& p) {
    const Eigen::Vector2d from = p - Eigen::Vector2d(60, 48);
    return std::max(std::abs(from.dot(along)), std::abs(from.dot(across))) < 30;
  };
  for (const double crop_m : {0.0, 3.3, 10.0}) {
    const Rings rings = CutlineOf(Seen([&](const auto& p) { return in_square(p) ? 5 : 0; }), 2, crop_m);
    ASSERT_EQ(rings.size(), 1U);
    const double half = 30 - crop_m;
    EXPECT_NEAR(Reach(rings[0], 60, 48).first, half, kCell_m);
    EXPECT_NEAR(Reach(rings[0], 60, 48).second, half * std::sqrt(2.0), 4 * kCell_m) << "corners are a little round";
    EXPECT_NEAR(AreaOf(rings[0]), 4 * half * half, 8 * half * 0.5 * kCell_m + 16 * kCell_m * kCell_m);
    EXPECT_LT(rings[0].size(), 32U);
  }
}

TEST_F(MapEdge, KeepsLargePartsAndLargeHolesOnly) {
  const auto two = [](double radius_m) {
    return CutlineOf(Seen([=](const auto& p) { return InDisc(p, 40, 48, 35) || InDisc(p, 100, 48, radius_m) ? 3 : 0; }), 2, 0.0);
  };
  EXPECT_EQ(two(3.0).size(), 1U);
  EXPECT_EQ(two(10.0).size(), 2U);
  const auto holed = [](double radius_m) {
    return CutlineOf(Seen([=](const auto& p) { return InDisc(p, 60, 48, 40) && !InDisc(p, 70, 50, radius_m) ? 3 : 1; }), 2, 0.0);
  };
  EXPECT_EQ(holed(3.0).size(), 1U);
  const Rings rings = holed(12.0);
  ASSERT_EQ(rings.size(), 2U);
  const std::vector<Eigen::Vector2d>& hole = AreaOf(rings[0]) < 0 ? rings[0] : rings[1];
  EXPECT_NEAR(AreaOf(hole), -std::numbers::pi * 144, 30) << "clockwise";
  EXPECT_NEAR(Reach(hole, 70, 50).first, 12, kCell_m);
}

TEST_F(MapEdge, FillsNarrowNotches) {
  const auto with_notch = [](double width_m) {
    return CutlineOf(Seen([=](const auto& p) { return InDisc(p, 60, 48, 40) && !(p.x() > 80 && std::abs(p.y() - 48) < width_m / 2) ? 2 : 0; }), 2,
                     0.0);
  };
  EXPECT_GT(Reach(with_notch(1.0).at(0), 60, 48).first, 38.0);
  EXPECT_LT(Reach(with_notch(6.0).at(0), 60, 48).first, 22.0);
}

TEST_F(MapEdge, StaysInTheGridAndMayBeEmpty) {
  for (const int least : {1, 2, 200}) {
    const SeenLattice seen = Seen([](const auto& p) { return p.x() + 0.3 * p.y() > 20 ? 255 : 0; });
    const Rings rings = CutlineOf(seen, least, 0.0);
    ASSERT_EQ(rings.size(), 1U);
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector2d& p : rings[0]) box.extend(p);
    EXPECT_NEAR(box.max().x(), 500000.0 + kColumns * kCell_m, 0.01);
    EXPECT_LE(box.max().y(), 5000000.0 + 1e-6);
    EXPECT_GE(box.min().y(), 5000000.0 - kRows * kCell_m - 1e-6);
    EXPECT_GE(box.min().x(), 500000.0 - 1e-6);
  }
  EXPECT_TRUE(CutlineOf(Seen([](const auto&) { return 1; }), 2, 0.0).empty());
  EXPECT_TRUE(CutlineOf(Seen([](const auto&) { return 9; }), 2, 48.5).empty()) << "nothing is that far inside";
  EXPECT_TRUE(CutlineOf(SeenLattice{}, 2, 0.0).empty());
}

// Ragged masks: whatever comes, rings are simple.
TEST_F(MapEdge, RingsNeverCross) {
  for (int seed = 1; seed <= 3; ++seed) {
    const SeenLattice seen = Seen([&](const auto& p) {
      const double wave = std::sin(0.31 * seed * p.x()) + std::sin(0.27 * p.y() + seed) + std::sin(0.11 * p.x() * seed + 0.23 * p.y());
      return wave > -0.4 ? 2 : 0;
    });
    for (const double crop_m : {0.0, 1.0, 3.0}) {
      std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> sides;
      for (const auto& ring : CutlineOf(seen, 2, crop_m)) {
        for (size_t i = 0; i < ring.size(); ++i) sides.emplace_back(ring[i], ring[(i + 1) % ring.size()]);
      }
      const auto side = [](const auto& line, const Eigen::Vector2d& p) {
        const Eigen::Vector2d along = line.second - line.first, to = p - line.first;
        return along.x() * to.y() - along.y() * to.x();
      };
      int crossings = 0;
      for (size_t i = 0; i < sides.size(); ++i) {
        const Eigen::Vector2d low = sides[i].first.cwiseMin(sides[i].second), high = sides[i].first.cwiseMax(sides[i].second);
        for (size_t j = i + 1; j < sides.size(); ++j) {
          if (std::max(sides[j].first.y(), sides[j].second.y()) < low.y() || std::min(sides[j].first.y(), sides[j].second.y()) > high.y()) continue;
          const bool one = side(sides[i], sides[j].first) * side(sides[i], sides[j].second) < 0.0;
          const bool other = side(sides[j], sides[i].first) * side(sides[j], sides[i].second) < 0.0;
          crossings += one && other && sides[i].second != sides[j].first && sides[j].second != sides[i].first ? 1 : 0;
        }
      }
      EXPECT_EQ(crossings, 0) << seed << ", " << crop_m;
    }
  }
}

TEST_F(MapEdge, TheFileHoldsAPolygonForEachPart) {
  const SeenLattice seen = Seen([](const auto& p) { return (InDisc(p, 40, 48, 35) && !InDisc(p, 40, 48, 10)) || InDisc(p, 100, 48, 15) ? 2 : 0; });
  const Rings rings = CutlineOf(seen, 2, 0.0);
  WriteCutline(rings, seen.grid, folder_ / "cutline.gpkg");
  const gis::OpenedDataset file = gis::OpenDataset(folder_ / "cutline.gpkg", GDAL_OF_VECTOR);
  ASSERT_NE(file, nullptr);
  OGRLayer* layer = file->GetLayerByName("cutline");
  ASSERT_NE(layer, nullptr);
  EXPECT_STREQ(layer->GetSpatialRef()->GetAuthorityCode(nullptr), "32632");
  const std::string says = layer->GetMetadataItem("DESCRIPTION");
  EXPECT_NE(says.find("at least two photos see"), std::string::npos) << says;
  ASSERT_EQ(layer->GetFeatureCount(), 2);
  std::vector<double> areas;
  for (const auto& feature : *layer) {
    const OGRPolygon& polygon = *feature->GetGeometryRef()->toPolygon();
    EXPECT_TRUE(polygon.getNumInteriorRings() == (areas.empty() ? 1 : 0));
    EXPECT_NEAR(feature->GetFieldAsDouble("area_m2"), polygon.get_Area(), 1e-6 * polygon.get_Area());
    areas.push_back(polygon.get_Area());
  }
  EXPECT_NEAR(areas[0], std::numbers::pi * (35 * 35 - 10 * 10), 60);
  EXPECT_NEAR(areas[1], std::numbers::pi * 15 * 15, 20);
  WriteCutline(rings, seen.grid, folder_ / "again.gpkg");
  EXPECT_TRUE(base::ReadFile(folder_ / "cutline.gpkg") == base::ReadFile(folder_ / "again.gpkg"));
  WriteCutline({}, seen.grid, folder_ / "empty.gpkg");
  EXPECT_EQ(gis::OpenDataset(folder_ / "empty.gpkg", GDAL_OF_VECTOR)->GetLayerByName("cutline")->GetFeatureCount(), 0);
  EXPECT_NE(InputErrorOf([&] { WriteCutline(rings, seen.grid, folder_ / "no_such_folder/cutline.gpkg"); }), "");
}

}  // namespace
}  // namespace skyquilt::products
