#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "buildings/files/building_files.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "tests/buildings/files/sample_set.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::buildings {
namespace {

using Json = nlohmann::json;

Json WrittenCityJson(const BuildingSet& set, const surface::MapFrame& frame) {
  const TemporaryFolder folder;
  WriteCityJson(set, frame, folder / "buildings.city.json");
  return Json::parse(base::ReadFile(folder / "buildings.city.json"));
}

Eigen::Vector3d VertexOf(const Json& document, size_t index) {
  Eigen::Vector3d vertex;
  for (size_t axis = 0; axis < 3; ++axis) {
    vertex[static_cast<Eigen::Index>(axis)] = document["vertices"][index][axis].get<double>() * document["transform"]["scale"][axis].get<double>() +
                                              document["transform"]["translate"][axis].get<double>();
  }
  return vertex;
}

// Six times the volume below a ring, seen from a point.
double ConeOf(const Json& document, const Json& ring, const Eigen::Vector3d& apex) {
  double sum = 0.0;
  for (size_t i = 2; i < ring.size(); ++i) {
    const Eigen::Vector3d a = VertexOf(document, ring[0]) - apex, b = VertexOf(document, ring[i - 1]) - apex, c = VertexOf(document, ring[i]) - apex;
    Eigen::Matrix3d corners;
    corners << a, b, c;
    sum += corners.determinant();
  }
  return sum;
}

// Nested as the specification wants a Solid, closed, and of this volume.
void ExpectSolid(const Json& document, const Json& geometry, double volume_m3) {
  EXPECT_EQ(geometry["type"], "Solid");
  ASSERT_EQ(geometry["boundaries"].size(), 1U) << "one shell";
  const Json& shell = geometry["boundaries"][0];
  const Json& surfaces = geometry["semantics"]["surfaces"];
  ASSERT_EQ(geometry["semantics"]["values"].size(), 1U);
  ASSERT_EQ(geometry["semantics"]["values"][0].size(), shell.size());
  std::map<std::pair<int, int>, int> edges;
  double six_volumes = 0.0;
  const Eigen::Vector3d apex = VertexOf(document, shell[0][0][0]);
  std::set<std::string> types;
  for (size_t f = 0; f < shell.size(); ++f) {
    const std::string type = surfaces[geometry["semantics"]["values"][0][f].get<size_t>()]["type"];
    types.insert(type);
    double area_above = 0.0;  // twice the signed area seen from above
    for (const Json& ring : shell[f]) {
      ASSERT_GE(ring.size(), 3U);
      for (size_t i = 0; i < ring.size(); ++i) {
        ASSERT_TRUE(ring[i].is_number_unsigned());
        ASSERT_LT(ring[i].get<size_t>(), document["vertices"].size());
        const int a = ring[i], b = ring[(i + 1) % ring.size()];
        EXPECT_EQ(++edges[std::pair(a, b)], 1);
        const Eigen::Vector3d p = VertexOf(document, ring[i]) - apex, q = VertexOf(document, ring[(i + 1) % ring.size()]) - apex;
        area_above += p.x() * q.y() - p.y() * q.x();
      }
      six_volumes += ConeOf(document, ring, apex);
    }
    if (type == "GroundSurface") {
      EXPECT_LT(area_above, -1.0);
    } else if (type == "RoofSurface") {
      EXPECT_GT(area_above, 1.0);
    } else {
      EXPECT_NEAR(area_above, 0.0, 0.02);
    }
  }
  EXPECT_EQ(types, (std::set<std::string>{"GroundSurface", "RoofSurface", "WallSurface"}));
  EXPECT_EQ(surfaces.size(), 3U);
  for (const auto& [edge, count] : edges) EXPECT_TRUE(edges.contains({edge.second, edge.first})) << edge.first << " " << edge.second;
  // UTM reduces lengths by up to 0.04 %.
  EXPECT_NEAR(six_volumes / 6.0, volume_m3, 0.002 * volume_m3);
}

TEST(CityJson, IsAsVersion2Wants) {
  const BuildingSet set = SampleSet();
  const surface::MapFrame frame = SampleFrame();
  const Json document = WrittenCityJson(set, frame);
  EXPECT_EQ(document["type"], "CityJSON");
  EXPECT_EQ(document["version"], "2.0");
  EXPECT_EQ(document["metadata"]["referenceSystem"], "https://www.opengis.net/def/crs/EPSG/0/32632");
  std::set<std::string> keys;
  for (const auto& [key, value] : document.items()) keys.insert(key);
  EXPECT_EQ(keys, (std::set<std::string>{"type", "version", "transform", "metadata", "CityObjects", "vertices"}));

  std::set<Json> distinct;
  Eigen::Vector3d min = Eigen::Vector3d::Constant(HUGE_VAL), max = -min;
  for (size_t i = 0; i < document["vertices"].size(); ++i) {
    for (const Json& step : document["vertices"][i]) EXPECT_TRUE(step.is_number_integer());
    EXPECT_TRUE(distinct.insert(document["vertices"][i]).second) << i << " is there twice";
    min = min.cwiseMin(VertexOf(document, i));
    max = max.cwiseMax(VertexOf(document, i));
  }
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto row = static_cast<Eigen::Index>(axis);
    EXPECT_NEAR(document["metadata"]["geographicalExtent"][axis].get<double>(), min[row], 1e-4);
    EXPECT_NEAR(document["metadata"]["geographicalExtent"][3 + axis].get<double>(), max[row], 1e-4);
  }

  std::vector<bool> used(document["vertices"].size(), false);
  EXPECT_EQ(document["CityObjects"].size(), set.buildings.size());
  for (const Building& building : set.buildings) {
    const Json& object = document["CityObjects"]["building_" + std::to_string(building.id)];
    EXPECT_EQ(object["type"], "Building");
    ASSERT_EQ(object["geometry"].size(), 2U);
    EXPECT_EQ(object["geometry"][0]["lod"], "1.2");
    EXPECT_EQ(object["geometry"][1]["lod"], "2.2");
    ExpectSolid(document, object["geometry"][0], Volume(building.lod12));
    ExpectSolid(document, object["geometry"][1], Volume(building.lod22));
    for (const Json& geometry : object["geometry"]) {
      for (const Json& face : geometry["boundaries"][0]) {
        for (const Json& ring : face) {
          for (const Json& index : ring) used[index.get<size_t>()] = true;
        }
      }
    }
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0) << "vertices that nothing uses";
  // The courtyard is a hole in its ground and roof.
  const Json& yard = document["CityObjects"]["building_3"]["geometry"][0]["boundaries"][0];
  EXPECT_EQ(std::count_if(yard.begin(), yard.end(), [](const Json& face) { return face.size() == 2; }), 2);
}

TEST(CityJson, VerticesAreThoseOfTheMaps) {
  const BuildingSet set = SampleSet();
  const surface::MapFrame frame = SampleFrame();
  const Json document = WrittenCityJson(set, frame);
  const Json& shell = document["CityObjects"]["building_1"]["geometry"][1]["boundaries"][0];
  const Solid& solid = set.buildings[0].lod22;
  ASSERT_EQ(shell.size(), solid.face.size());
  for (size_t f = 0; f < shell.size(); ++f) {
    for (size_t i = 0; i < solid.face[f].outer.size(); ++i) {
      const Eigen::Vector3d expected = frame.MapFromEnu(solid.vertex[solid.face[f].outer[i]]);
      EXPECT_LT((VertexOf(document, shell[f][0][i]) - expected).cwiseAbs().maxCoeff(), 1.01e-4);
    }
  }
}

TEST(CityJson, AttributesAreMeasuresWithTheirSigma) {
  const BuildingSet set = SampleSet();
  const Json document = WrittenCityJson(set, SampleFrame());
  const Json& house = document["CityObjects"]["building_2"]["attributes"];
  const Measures& known = set.buildings[1].measures;
  EXPECT_EQ(house["roof"], "hip");
  EXPECT_EQ(house["accepted"], false);
  EXPECT_NEAR(house["length_m"].get<double>(), known.length_m.value, 1e-4);
  EXPECT_NEAR(house["length_m_sigma"].get<double>(), known.length_m.sigma, 1e-4);
  EXPECT_NEAR(house["measuredHeight"].get<double>(), known.height_m.value, 1e-4);
  EXPECT_EQ(house["note"], set.buildings[1].note);
  EXPECT_EQ(house["outline_id"], set.buildings[1].given_id);
  ASSERT_EQ(house["parts"].size(), 1U);
  EXPECT_EQ(house["parts"][0]["roof"], "hip");
  EXPECT_EQ(house["parts"][0]["outline"].size(), 4U);
  EXPECT_NEAR(house["parts"][0]["eave_m"].get<double>(), house["eave_m"].get<double>(), 0.002);
  const Json& unknown = document["CityObjects"]["building_4"]["attributes"];
  EXPECT_FALSE(unknown.contains("pitch_deg")) << "what is not known is left out";
  EXPECT_FALSE(unknown.contains("ridge_m_sigma"));
  EXPECT_EQ(unknown["lod22_valid"], false);
  EXPECT_EQ(base::JsonText(document).find("null"), std::string::npos);
}

TEST(CityJson, WithoutGeoreferenceThereIsNoCrs) {
  BuildingSet set = SampleSet();
  set.scale = 2.0;
  const Json scaled = WrittenCityJson(set, SampleFrame(false));
  EXPECT_FALSE(scaled["metadata"].contains("referenceSystem"));
  ExpectSolid(scaled, scaled["CityObjects"]["building_1"]["geometry"][1], 8.0 * Volume(set.buildings[0].lod22));
  set.scale = 1.0;
  set.metric = false;
  const Json unknown = WrittenCityJson(set, SampleFrame(false));
  EXPECT_TRUE(unknown["CityObjects"]["building_1"]["attributes"].contains("length"));
  EXPECT_FALSE(unknown["CityObjects"]["building_1"]["attributes"].contains("measuredHeight"));
  EXPECT_EQ(base::JsonText(unknown).find("_m\""), std::string::npos);
}

TEST(CityJson, OfNoBuildingsIsComplete) {
  const Json document = WrittenCityJson({}, SampleFrame());
  EXPECT_TRUE(document["vertices"].is_array());
  EXPECT_TRUE(document["vertices"].empty());
  EXPECT_TRUE(document["CityObjects"].is_object());
  EXPECT_FALSE(document["metadata"].contains("geographicalExtent"));
}

}  // namespace
}  // namespace skyquilt::buildings
