#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "buildings/files/building_files.h"
#include "core/base/file.h"
#include "tests/buildings/files/sample_set.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::buildings {
namespace {

using Groups = std::vector<std::pair<int, std::string>>;

Groups ReadGroups(const std::string& text) {
  Groups groups;
  std::istringstream lines(text);
  for (std::string code, value; std::getline(lines, code) && std::getline(lines, value);) {
    EXPECT_TRUE(code.ends_with('\r') && value.ends_with('\r'));
    value.pop_back();
    groups.emplace_back(std::stoi(code), value);
  }
  return groups;
}

struct Entity {
  std::string type;
  std::multimap<int, std::string> value;
  std::string Text(int code) const {
    EXPECT_EQ(value.count(code), 1U) << type << " " << code;
    return value.contains(code) ? value.find(code)->second : "";
  }
  Eigen::Vector3d Point(int first) const { return {std::stod(Text(first)), std::stod(Text(first + 10)), std::stod(Text(first + 20))}; }
};

// A reader of R12, written from Autodesk's reference.
struct Dxf {
  std::map<std::string, std::vector<Entity>> section;
  std::map<std::string, Groups> header;
  std::set<std::string> layers;

  explicit Dxf(const std::string& text) {
    const Groups groups = ReadGroups(text);
    EXPECT_EQ(groups.back(), std::pair(0, std::string("EOF")));
    std::string name, variable;
    for (size_t i = 0; i + 1 < groups.size(); ++i) {
      const auto& [code, value] = groups[i];
      if (code == 0 && value == "SECTION") {
        EXPECT_EQ(name, "") << "a section in a section";
        name = groups[++i].second;
        section[name];
      } else if (code == 0 && value == "ENDSEC") {
        EXPECT_NE(name, "");
        name = "";
      } else if (code == 0) {
        section[name].push_back({value, {}});
      } else if (name == "HEADER" && code == 9) {
        variable = value;
      } else if (name == "HEADER") {
        header[variable].emplace_back(code, value);
      } else {
        section[name].back().value.emplace(code, value);
      }
    }
    EXPECT_EQ(name, "") << "a section without an end";
    for (const Entity& entry : section["TABLES"]) {
      if (entry.type == "LAYER") layers.insert(entry.Text(2));
    }
  }
};

Dxf WrittenDxf(const BuildingSet& set, const surface::MapFrame& frame) {
  const TemporaryFolder folder;
  WriteDxf(set, frame, folder / "buildings.dxf");
  return Dxf(base::ReadFile(folder / "buildings.dxf"));
}

TEST(Dxf, HasEveryEdgeOnceOnItsLayer) {
  const BuildingSet set = SampleSet();
  const surface::MapFrame frame = SampleFrame();
  Dxf dxf = WrittenDxf(set, frame);
  EXPECT_EQ(dxf.header["$ACADVER"], (Groups{{1, "AC1009"}}));
  EXPECT_EQ(dxf.layers, (std::set<std::string>{"FOOTPRINTS", "GROUND", "ROOFS", "WALLS"}));
  Eigen::Vector3d min = Eigen::Vector3d::Constant(HUGE_VAL), max = -min;
  std::map<std::string, int> lines;
  std::set<std::vector<double>> drawn;
  for (const Entity& entity : dxf.section["ENTITIES"]) {
    if (entity.type != "LINE") continue;
    EXPECT_TRUE(dxf.layers.contains(entity.Text(8)));
    ++lines[entity.Text(8)];
    const Eigen::Vector3d a = entity.Point(10), b = entity.Point(11);
    EXPECT_GT((a - b).norm(), 0.001);
    EXPECT_TRUE(drawn.insert({a.x(), a.y(), a.z(), b.x(), b.y(), b.z()}).second);
    EXPECT_FALSE(drawn.contains({b.x(), b.y(), b.z(), a.x(), a.y(), a.z()}));
    min = min.cwiseMin(a).cwiseMin(b);
    max = max.cwiseMax(a).cwiseMax(b);
  }
  size_t edges = 0, ground = 0;
  for (const Building& building : set.buildings) {
    size_t half_edges = 0;
    for (const Face& face : building.lod22.face) {
      size_t corners = face.outer.size();
      for (const auto& hole : face.holes) corners += hole.size();
      half_edges += corners;
      if (face.kind == FaceKind::kGround) ground += corners;
    }
    edges += half_edges / 2;
  }
  EXPECT_EQ(drawn.size(), edges);
  EXPECT_EQ(static_cast<size_t>(lines["GROUND"]), ground);
  EXPECT_GT(lines["WALLS"], 10);
  EXPECT_GT(lines["ROOFS"], 10);
  for (const auto& [name, corner] : {std::pair("$EXTMIN", min), std::pair("$EXTMAX", max)}) {
    const Groups& groups = dxf.header[name];
    ASSERT_EQ(groups.size(), 3U);
    for (size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(std::stod(groups[axis].second), corner[static_cast<Eigen::Index>(axis)], 0.003);
  }
  const Eigen::Vector3d corner = frame.MapFromEnu(set.buildings[0].lod22.vertex[0]);
  bool found = false;
  for (const Entity& entity : dxf.section["ENTITIES"]) {
    if (entity.type == "LINE") found = found || (entity.Point(10) - corner).norm() < 1e-3 || (entity.Point(11) - corner).norm() < 1e-3;
  }
  EXPECT_TRUE(found) << "coordinates of the maps";
}

TEST(Dxf, FootprintsAreClosedPolylines) {
  const BuildingSet set = SampleSet();
  Dxf dxf = WrittenDxf(set, SampleFrame());
  std::vector<double> areas;
  const std::vector<Entity>& entities = dxf.section["ENTITIES"];
  for (size_t i = 0; i < entities.size(); ++i) {
    if (entities[i].type != "POLYLINE") continue;
    EXPECT_EQ(entities[i].Text(8), "FOOTPRINTS");
    EXPECT_EQ(entities[i].Text(66), "1");
    EXPECT_EQ(entities[i].Text(70), "1") << "closed";
    std::vector<Eigen::Vector3d> points;
    for (++i; i < entities.size() && entities[i].type == "VERTEX"; ++i) points.push_back(entities[i].Point(10));
    ASSERT_LT(i, entities.size());
    EXPECT_EQ(entities[i].type, "SEQEND");
    double twice = 0.0;
    for (size_t k = 0; k < points.size(); ++k) {
      const Eigen::Vector3d a = points[k] - points[0], b = points[(k + 1) % points.size()] - points[0];
      twice += a.x() * b.y() - a.y() * b.x();
      EXPECT_EQ(points[k].z(), points[0].z());
    }
    areas.push_back(0.5 * twice);
  }
  ASSERT_EQ(areas.size(), 5U) << "four footprints and a courtyard";
  EXPECT_NEAR(areas[0], Area(set.buildings[0].footprint), 0.1);
  EXPECT_NEAR(areas[2] + areas[3], Area(set.buildings[2].footprint), 1.0);
  EXPECT_LT(areas[3], 0.0);
}

TEST(Dxf, OfNoBuildingsIsComplete) {
  Dxf dxf = WrittenDxf({}, SampleFrame());
  EXPECT_TRUE(dxf.section.contains("ENTITIES"));
  EXPECT_TRUE(dxf.section["ENTITIES"].empty());
  EXPECT_FALSE(dxf.header.contains("$EXTMIN"));
}

}  // namespace
}  // namespace skyquilt::buildings
