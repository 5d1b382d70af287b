#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "buildings/files/building_files.h"
#include "core/base/file.h"
#include "tests/buildings/files/sample_set.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::buildings {
namespace {

using Rows = std::vector<std::vector<std::string>>;

// A reader of RFC 4180, written from it.
Rows ReadCsv(const std::string& text) {
  Rows rows(1, {""});
  bool quoted = false;
  for (size_t i = 0; i < text.size(); ++i) {
    std::string& cell = rows.back().back();
    if (quoted && text[i] == '"' && i + 1 < text.size() && text[i + 1] == '"') {
      cell += text[i++];
    } else if (text[i] == '"') {
      quoted = !quoted;
    } else if (!quoted && text[i] == ',') {
      rows.back().emplace_back();
    } else if (!quoted && text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n') {
      ++i;
      rows.push_back({""});
    } else {
      cell += text[i];
    }
  }
  EXPECT_FALSE(quoted);
  EXPECT_EQ(rows.back(), std::vector<std::string>{""}) << "the last line ends too";
  rows.pop_back();
  return rows;
}

std::vector<std::map<std::string, std::string>> Table(const BuildingSet& set, bool georeferenced, std::vector<std::string>* names) {
  const TemporaryFolder folder;
  WriteCsv(set, SampleFrame(georeferenced), folder / "buildings.csv");
  const Rows rows = ReadCsv(base::ReadFile(folder / "buildings.csv"));
  *names = rows.front();
  std::vector<std::map<std::string, std::string>> table;
  for (size_t i = 1; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].size(), names->size());
    auto& row = table.emplace_back();
    for (size_t column = 0; column < rows[i].size(); ++column) row[(*names)[column]] = rows[i][column];
  }
  EXPECT_EQ(table.size(), set.buildings.size());
  return table;
}

TEST(Csv, HasTheColumnsThatAreDocumented) {
  std::vector<std::string> names;
  Table(SampleSet(), true, &names);
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " ") + name;
  EXPECT_EQ(
      text,
      "id longitude latitude easting northing ground_m ground_m_sigma eave_m eave_m_sigma ridge_m ridge_m_sigma height_m height_m_sigma length_m "
      "length_m_sigma width_m width_m_sigma yaw_deg yaw_deg_sigma area_m2 area_m2_sigma volume_m3 volume_m3_sigma roof_area_m2 "
      "roof_area_m2_sigma pitch_deg pitch_deg_sigma wall_seen roof accepted note outline_id");
}

TEST(Csv, HeightsAndPlacesAreThoseOfTheMaps) {
  const BuildingSet set = SampleSet();
  const surface::MapFrame frame = SampleFrame();
  std::vector<std::string> names;
  const auto table = Table(set, true, &names);
  for (size_t i = 0; i < table.size(); ++i) {
    const Building& building = set.buildings[i];
    const Eigen::Vector2d middle = Centroid(building.footprint);
    const Eigen::Vector3d ground = frame.MapFromEnu({middle.x(), middle.y(), building.measures.ground_m.value});
    const auto number = [&, row = table[i]](const std::string& name) { return std::stod(row.at(name)); };
    EXPECT_EQ(table[i].at("id"), std::to_string(building.id));
    EXPECT_NEAR(number("easting"), ground.x(), 1e-3);
    EXPECT_NEAR(number("northing"), ground.y(), 1e-3);
    EXPECT_NEAR(number("ground_m"), ground.z(), 1e-3);
    EXPECT_NEAR(number("ground_m"), 520.0 + building.measures.ground_m.value, 0.01);
    EXPECT_NEAR(number("eave_m") - number("ground_m"), building.measures.eave_m.value - building.measures.ground_m.value, 2e-4);
    EXPECT_NEAR(number("ridge_m") - number("ground_m"), number("height_m"), 3e-4);
    EXPECT_NEAR(number("length_m"), building.measures.length_m.value, 1e-4);
    EXPECT_NEAR(number("yaw_deg"), building.measures.yaw_deg.value, 1e-4);
    EXPECT_NEAR(number("yaw_deg_sigma"), building.measures.yaw_deg.sigma, 1e-4);
    EXPECT_NEAR(number("area_m2"), building.measures.footprint_m2.value, 1e-4);
    EXPECT_NEAR(number("longitude"), 9.99 + middle.x() / (111320.0 * std::cos(48.4 * 3.14159265 / 180.0)), 1e-5);
    EXPECT_NEAR(number("latitude"), 48.4 + middle.y() / 111200.0, 1e-5);
    EXPECT_EQ(table[i].at("roof"), NameOf(building.roof));
    EXPECT_EQ(table[i].at("accepted"), building.accepted ? "1" : "0");
    EXPECT_EQ(table[i].at("note"), building.note);
    EXPECT_EQ(table[i].at("outline_id"), building.given_id);
    for (const auto& [name, cell] : table[i]) {
      if (name == "roof" || name == "note" || name == "outline_id") continue;
      EXPECT_EQ(cell.find_first_not_of("-.0123456789"), std::string::npos) << name << " is " << cell;
    }
  }
  EXPECT_EQ(table[3].at("pitch_deg"), "");
  EXPECT_EQ(table[3].at("pitch_deg_sigma"), "");
  EXPECT_EQ(table[3].at("volume_m3"), "");
  EXPECT_NE(table[3].at("volume_m3_sigma"), "");
  EXPECT_EQ(table[3].at("ridge_m_sigma"), "");
}

TEST(Csv, WithoutScaleNoColumnHasAUnitOfLength) {
  BuildingSet set = SampleSet();
  set.metric = false;
  std::vector<std::string> names;
  const auto table = Table(set, false, &names);
  for (const std::string& name : names) {
    EXPECT_EQ(name.find("_m"), std::string::npos) << name;
  }
  for (const char* name : {"ground", "eave", "ridge", "height", "length", "width", "area", "volume", "roof_area", "yaw_deg", "pitch_deg"}) {
    EXPECT_TRUE(table[0].contains(name) && table[0].contains(name + std::string("_sigma"))) << name;
  }
  EXPECT_EQ(table[0].at("longitude"), "");
  EXPECT_EQ(table[0].at("latitude"), "");
  EXPECT_NEAR(std::stod(table[0].at("ground")), set.buildings[0].measures.ground_m.value, 1e-4);
}

TEST(Csv, AScaleBarMakesPlacesMetresToo) {
  BuildingSet set = SampleSet();
  const double ground = set.buildings[0].measures.ground_m.value;
  const Eigen::Vector2d middle = Centroid(set.buildings[0].footprint);
  set.scale = 2.5;
  set.scale_source = "scale bar";
  // As MakeBuildings does.
  for (Measure* measure : {&set.buildings[0].measures.ground_m, &set.buildings[0].measures.ridge_m}) measure->value *= set.scale;
  std::vector<std::string> names;
  const auto table = Table(set, false, &names);
  EXPECT_NEAR(std::stod(table[0].at("easting")), 2.5 * middle.x(), 1e-3);
  EXPECT_NEAR(std::stod(table[0].at("ground_m")), 2.5 * ground, 1e-3);
  EXPECT_NEAR(std::stod(table[0].at("ridge_m")), set.buildings[0].measures.ridge_m.value, 1e-3);
  EXPECT_EQ(table[0].at("longitude"), "");
}

TEST(Csv, OfNoBuildingsIsItsHeader) {
  const TemporaryFolder folder;
  WriteCsv({}, SampleFrame(), folder / "buildings.csv");
  const Rows rows = ReadCsv(base::ReadFile(folder / "buildings.csv"));
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].size(), 31U);
}

}  // namespace
}  // namespace skyquilt::buildings
