#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "odm/ept/octree.h"
#include "odm/ept/write_ept.h"
#include "surface/files/surface_files.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/surface/files/sample_surface.h"

namespace skyquilt::odm::ept {
namespace {

namespace fs = std::filesystem;

std::vector<Point> RandomPoints(uint32_t seed, size_t count, int64_t size) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int32_t> at(0, static_cast<int32_t>(size) - 1);
  std::vector<Point> points(count);
  for (size_t i = 0; i < count; ++i) {
    for (int32_t& value : points[i].xyz) value = at(random);
    points[i].rgb[0] = static_cast<uint16_t>(i % 65536);
    points[i].rgb[1] = static_cast<uint16_t>(i / 65536);
  }
  return points;
}

using Nodes = std::map<NodeKey, std::vector<Point>>;

NodeSink Into(Nodes* nodes) {
  return [nodes](const NodeKey& key, std::span<const Point> points) {
    EXPECT_FALSE(nodes->contains(key)) << key.Name();
    EXPECT_FALSE(points.empty()) << key.Name();
    (*nodes)[key].assign(points.begin(), points.end());
  };
}

// What every tree must be: each point once, in the cube of its node, and no node without its parent.
void ExpectTree(const Nodes& nodes, const Cube& cube, size_t count) {
  std::set<std::pair<uint16_t, uint16_t>> seen;
  size_t n = 0;
  for (const auto& [key, points] : nodes) {
    if (key.depth > 0) EXPECT_TRUE(nodes.contains({key.depth - 1, {key.cell[0] / 2, key.cell[1] / 2, key.cell[2] / 2}})) << key.Name();
    for (const Point& point : points) {
      EXPECT_EQ(cube.CellOf(point, key.depth), key.cell) << key.Name();
      seen.insert({point.rgb[0], point.rgb[1]});
      ++n;
    }
  }
  EXPECT_EQ(n, count);
  EXPECT_EQ(seen.size(), count) << "a point is there twice";
}

TEST(EptOctree, HasEachPointOnceInTheCubeOfItsNode) {
  const Cube cube{.low = {0, 0, 0}, .size = 1 << 16};
  Nodes nodes;
  BuildSubtree(cube, {}, RandomPoints(1, 60'000, cube.size), Into(&nodes));
  ExpectTree(nodes, cube, 60'000);
  EXPECT_GT(nodes.size(), 1U);
}

TEST(EptOctree, UpperNodesAndSubtreesAreOneTree) {
  const Cube cube{.low = {0, 0, 0}, .size = 1 << 12};
  UpperNodes upper(cube, 2);
  std::map<NodeKey, std::vector<Point>> chunks;
  for (const Point& point : RandomPoints(2, 50'000, 64)) {  // in one corner, so that cells are full
    if (!upper.Take(point)) chunks[{2, cube.CellOf(point, 2)}].push_back(point);
  }
  EXPECT_FALSE(chunks.empty());
  Nodes nodes;
  upper.Finish(Into(&nodes));
  for (auto& [key, points] : chunks) BuildSubtree(cube, key, points, Into(&nodes));
  ExpectTree(nodes, cube, 50'000);
}

TEST(EptOctree, ANodeThinsWhatIsBelow) {
  const Cube cube{.low = {0, 0, 0}, .size = 1 << 10};
  Nodes nodes;
  BuildSubtree(cube, {}, RandomPoints(3, 300'000, 128), Into(&nodes));
  std::set<std::array<int32_t, 3>> cells;
  for (const Point& point : nodes.at({})) EXPECT_TRUE(cells.insert(cube.CellOf(point, kSpanLog2)).second) << "two points in a cell";
  EXPECT_EQ(cells.size(), 16U * 16U * 16U) << "a cell with points has none in the root";
}

TEST(EptOctree, PointsInOnePlaceEndTheDivision) {
  const Cube cube{.low = {0, 0, 0}, .size = 1 << 9};
  std::vector<Point> points(3 * kLeafPoints);
  for (size_t i = 0; i < points.size(); ++i) {
    points[i].xyz = {7, 7, 7};
    points[i].rgb = {static_cast<uint16_t>(i % 65536), static_cast<uint16_t>(i / 65536), 0};
  }
  Nodes nodes;
  const size_t count = points.size();
  BuildSubtree(cube, {}, std::move(points), Into(&nodes));
  ExpectTree(nodes, cube, count);
}

// An EPT dataset read as its specification says.
struct Dataset {
  nlohmann::json ept, hierarchy;
  std::vector<Eigen::Vector3d> positions;
  std::vector<std::array<int, 4>> values;  // red, green, blue, class

  explicit Dataset(const fs::path& folder) {
    ept = base::ParseJson(base::ReadFile(folder / "ept.json"));
    hierarchy = base::ParseJson(base::ReadFile(folder / "ept-hierarchy" / "0-0-0-0.json"));
    size_t record = 0;
    std::map<std::string, size_t> at;
    for (const nlohmann::json& dimension : ept.at("schema")) {
      at[dimension.at("name").get<std::string>()] = record;
      record += dimension.at("size").get<size_t>();
    }
    for (const auto& [name, count] : hierarchy.items()) {
      const std::string bytes = base::ReadFile(folder / "ept-data" / (name + ".bin"));
      EXPECT_EQ(bytes.size(), count.get<size_t>() * record) << name;
      for (size_t begin = 0; begin + record <= bytes.size(); begin += record) {
        Eigen::Vector3d position;
        for (int axis = 0; axis < 3; ++axis) {
          const nlohmann::json& dimension = ept.at("schema").at(static_cast<size_t>(axis));
          const auto whole = surface::ReadAs<int32_t>(bytes, begin + at.at(dimension.at("name").get<std::string>()));
          position[axis] = whole * dimension.at("scale").get<double>() + dimension.at("offset").get<double>();
        }
        positions.push_back(position);
        values.push_back({surface::ReadAs<uint16_t>(bytes, begin + at.at("Red")), surface::ReadAs<uint16_t>(bytes, begin + at.at("Green")),
                          surface::ReadAs<uint16_t>(bytes, begin + at.at("Blue")), surface::ReadAs<uint8_t>(bytes, begin + at.at("Classification"))});
      }
    }
  }
};

class EptFiles : public testing::Test {
 protected:
  // Parts of a cloud with that many points each.
  std::vector<fs::path> Write(int count, int64_t per_part) {
    points_ = surface::SamplePoints(count);
    surface::SurfaceFiles files(frame_, {.glb = false, .obj = false, .ply = false, .cloud = true, .tiles = false}, surface::kSampleTile_m,
                                folder_.path(), per_part);
    files.AddPoints(points_);
    files.Close();
    std::vector<fs::path> found;
    for (const std::string& name : surface::NamesIn(folder_.path())) {
      if (name.ends_with(".las")) found.push_back(folder_ / name);
    }
    return found;
  }

  TemporaryFolder folder_;
  const surface::MapFrame frame_ = surface::TorontoFrame();
  std::vector<surface::CloudPoint> points_;
};

TEST_F(EptFiles, HoldEachPointAtItsPlace) {
  for (const int64_t per_part : {100'000, 40}) {
    SCOPED_TRACE(per_part);
    const std::vector<fs::path> files = Write(150, per_part);
    EXPECT_EQ(files.size(), per_part == 40 ? 4U : 1U);
    for (const size_t chunk : {size_t{1'000'000}, size_t{20}}) {
      EXPECT_EQ(WriteEpt(files, {.epsg = 32617, .wkt = "PROJCS[]"}, folder_ / "ept", chunk), 150);
      const Dataset dataset(folder_ / "ept");
      ASSERT_EQ(dataset.positions.size(), 150U);
      std::vector<char> found(points_.size());
      for (size_t i = 0; i < dataset.positions.size(); ++i) {
        const auto same = std::find_if(points_.begin(), points_.end(), [&](const surface::CloudPoint& point) {
          return (frame_.MapFromEnu(point.position) - dataset.positions[i]).norm() < 0.002 && point.rgb[0] * 257 == dataset.values[i][0] &&
                 point.rgb[2] * 257 == dataset.values[i][2] && point.las_class == dataset.values[i][3];
        });
        ASSERT_NE(same, points_.end()) << dataset.positions[i].transpose();
        found[static_cast<size_t>(same - points_.begin())] = 1;
      }
      EXPECT_EQ(std::count(found.begin(), found.end(), 1), 150);
      EXPECT_EQ(dataset.ept.at("points"), 150);
      EXPECT_EQ(dataset.ept.at("dataType"), "binary");
      EXPECT_EQ(dataset.ept.at("srs").at("horizontal"), "32617");
      for (size_t axis = 0; axis < 3; ++axis) {
        const auto& bounds = dataset.ept.at("bounds");
        const auto& conforming = dataset.ept.at("boundsConforming");
        EXPECT_LE(bounds[axis].get<double>(), conforming[axis].get<double>());
        EXPECT_GE(bounds[axis + 3].get<double>(), conforming[axis + 3].get<double>());
        EXPECT_NEAR(bounds[axis + 3].get<double>() - bounds[axis].get<double>(), bounds[3].get<double>() - bounds[0].get<double>(), 1e-6) << "a cube";
      }
      EXPECT_FALSE(fs::exists(folder_ / "ept" / "waiting"));
    }
  }
}

TEST_F(EptFiles, AreReplacedAsAWhole) {
  const std::vector<fs::path> files = Write(50, 1000);
  fs::create_directories(folder_ / "ept" / "ept-data");
  base::WriteFileAtomically(folder_ / "ept" / "ept-data" / "9-9-9-9.bin", "old");
  WriteEpt(files, {}, folder_ / "ept");
  EXPECT_FALSE(fs::exists(folder_ / "ept" / "ept-data" / "9-9-9-9.bin"));
  EXPECT_TRUE(base::ParseJson(base::ReadFile(folder_ / "ept" / "ept.json")).at("srs").empty()) << "a local frame has no CRS";
  const std::string before = base::ReadFile(folder_ / "ept" / "ept.json");
  ExpectStopsWhenAsked([&] { WriteEpt(files, {.epsg = 32617}, folder_ / "ept"); });
  EXPECT_EQ(base::ReadFile(folder_ / "ept" / "ept.json"), before);
  EXPECT_FALSE(fs::exists(folder_ / "ept.partial"));
  EXPECT_EQ(WriteEpt({}, {}, folder_ / "none"), 0);
  EXPECT_FALSE(fs::exists(folder_ / "none"));
  base::WriteFileAtomically(folder_ / "bad.las", "LASF");
  EXPECT_NE(InputErrorOf([&] { WriteEpt({folder_ / "bad.las"}, {}, folder_ / "ept"); }).find("bad.las"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::odm::ept
