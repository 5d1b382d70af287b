#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "buildings/files/building_files.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "tests/buildings/files/sample_set.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::buildings {
namespace {

using Json = nlohmann::json;

struct Glb {
  Json json;
  std::string binary;

  explicit Glb(const std::string& bytes) {
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(Word(bytes, 4), 2U);
    EXPECT_EQ(Word(bytes, 8), bytes.size());
    const size_t length = Word(bytes, 12);
    EXPECT_EQ(length % 4, 0U);
    EXPECT_EQ(bytes.substr(16, 4), "JSON");
    json = Json::parse(bytes.substr(20, length));
    if (20 + length == bytes.size()) return;
    binary = bytes.substr(28 + length);
    EXPECT_EQ(Word(bytes, 20 + length), binary.size());
    EXPECT_EQ(bytes.substr(24 + length, 4), std::string("BIN\0", 4));
    EXPECT_EQ(json["buffers"][0]["byteLength"], binary.size());
  }
  static uint32_t Word(const std::string& bytes, size_t at) { return Read<uint32_t>(bytes, at); }
  template <typename T>
  static T Read(const std::string& bytes, size_t at) {
    T value;
    if (at + sizeof(T) > bytes.size()) throw std::out_of_range("beyond the end of the file");
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    return value;
  }
  size_t Begin(const Json& accessor) const {
    return json["bufferViews"][accessor["bufferView"].get<size_t>()]["byteOffset"].get<size_t>() + accessor["byteOffset"].get<size_t>();
  }
  std::vector<Eigen::Vector3d> Vectors(size_t index) const {
    const Json& accessor = json["accessors"][index];
    std::vector<Eigen::Vector3d> vectors;
    for (size_t i = 0; i < accessor["count"].get<size_t>(); ++i) {
      const size_t at = Begin(accessor) + 12 * i;
      vectors.emplace_back(Read<float>(binary, at), Read<float>(binary, at + 4), Read<float>(binary, at + 8));
    }
    return vectors;
  }
  std::vector<uint32_t> Indices(size_t index) const {
    const Json& accessor = json["accessors"][index];
    std::vector<uint32_t> indices;
    for (size_t i = 0; i < accessor["count"].get<size_t>(); ++i) indices.push_back(Read<uint32_t>(binary, Begin(accessor) + 4 * i));
    return indices;
  }
};

Glb WrittenGlb(const BuildingSet& set, const surface::MapFrame& frame) {
  const TemporaryFolder folder;
  WriteGlb(set, frame, folder / "buildings.glb");
  return Glb(base::ReadFile(folder / "buildings.glb"));
}

TEST(BuildingsGlb, HasANodePerBuildingWithItsMeasures) {
  const BuildingSet set = SampleSet();
  const Glb glb = WrittenGlb(set, SampleFrame());
  ASSERT_EQ(glb.json["nodes"].size(), set.buildings.size());
  EXPECT_EQ(glb.json["scenes"][0]["nodes"].size(), set.buildings.size());
  for (size_t i = 0; i < set.buildings.size(); ++i) {
    const Json& node = glb.json["nodes"][i];
    EXPECT_EQ(node["extras"]["id"], set.buildings[i].id);
    EXPECT_NEAR(node["extras"]["length_m"].get<double>(), set.buildings[i].measures.length_m.value, 1e-4);
    EXPECT_EQ(node["mesh"], i);
  }
  EXPECT_FALSE(glb.json["nodes"][3]["extras"].contains("pitch_deg"));
  EXPECT_EQ(glb.json["asset"]["extras"]["crs"], "EPSG:32632");
  EXPECT_EQ(base::JsonText(glb.json).find("null"), std::string::npos);
}

TEST(BuildingsGlb, MeshesAreTheSolids) {
  const BuildingSet set = SampleSet();
  const surface::MapFrame frame = SampleFrame();
  const Glb glb = WrittenGlb(set, frame);
  for (size_t i = 0; i < set.buildings.size(); ++i) {
    double six_volumes = 0.0, roof_m2 = 0.0;
    Eigen::Vector3d min = Eigen::Vector3d::Constant(HUGE_VAL), max = -min;
    for (const Json& primitive : glb.json["meshes"][i]["primitives"]) {
      const std::vector<Eigen::Vector3d> position = glb.Vectors(primitive["attributes"]["POSITION"]);
      const std::vector<Eigen::Vector3d> normal = glb.Vectors(primitive["attributes"]["NORMAL"]);
      const std::vector<uint32_t> index = glb.Indices(primitive["indices"]);
      const Json& accessor = glb.json["accessors"][primitive["attributes"]["POSITION"].get<size_t>()];
      Eigen::Vector3d own_min = Eigen::Vector3d::Constant(HUGE_VAL), own_max = -own_min;
      for (const Eigen::Vector3d& x : position) {
        own_min = own_min.cwiseMin(x);
        own_max = own_max.cwiseMax(x);
      }
      for (size_t axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(accessor["min"][axis].get<double>(), own_min[static_cast<Eigen::Index>(axis)]);
        EXPECT_EQ(accessor["max"][axis].get<double>(), own_max[static_cast<Eigen::Index>(axis)]);
      }
      min = min.cwiseMin(own_min);
      max = max.cwiseMax(own_max);
      const bool roof = glb.json["materials"][primitive["material"].get<size_t>()]["name"] == "roof";
      for (size_t k = 0; k < index.size(); k += 3) {
        const Eigen::Vector3d &a = position.at(index[k]), &b = position.at(index[k + 1]), &c = position.at(index[k + 2]);
        six_volumes += a.dot(b.cross(c));
        const Eigen::Vector3d across = (b - a).cross(c - a);
        EXPECT_NEAR(normal[index[k]].norm(), 1.0, 1e-5);
        EXPECT_GT(across.dot(normal[index[k]]), 0.999 * across.norm());
        if (roof) {
          roof_m2 += 0.5 * across.norm();
          EXPECT_GT(normal[index[k]].y(), 0.1) << "y is up";
        }
      }
    }
    const Solid& solid = set.buildings[i].lod22;
    EXPECT_NEAR(six_volumes / 6.0, Volume(solid), 0.003 * Volume(solid));
    EXPECT_NEAR(roof_m2, Area(solid, FaceKind::kRoof), 0.002 * roof_m2);
    // On the ground of the maps: x is easting and -z northing minus the offset.
    Eigen::Vector3d map_min = Eigen::Vector3d::Constant(HUGE_VAL), map_max = -map_min;
    for (const Eigen::Vector3d& vertex : solid.vertex) {
      map_min = map_min.cwiseMin(frame.MapFromEnu(vertex) - frame.offset());
      map_max = map_max.cwiseMax(frame.MapFromEnu(vertex) - frame.offset());
    }
    EXPECT_LT((Eigen::Vector3d(min.x(), -max.z(), min.y()) - map_min).norm(), 1e-3);
    EXPECT_LT((Eigen::Vector3d(max.x(), -min.z(), max.y()) - map_max).norm(), 1e-3);
  }
}

TEST(BuildingsGlb, KeepsTheCoordinatesOfALocalSurface) {
  BuildingSet set = SampleSet();
  set.scale = 3.0;
  const Glb glb = WrittenGlb(set, SampleFrame(false));
  EXPECT_EQ(glb.json["asset"]["extras"]["metresPerUnit"], 3.0);
  double lowest = HUGE_VAL;
  for (const Eigen::Vector3d& x : glb.Vectors(glb.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"])) lowest = std::min(lowest, x.y());
  EXPECT_NEAR(lowest, 1.9, 1e-3) << "the eave, where mesh.glb has it";
}

TEST(BuildingsGlb, OfNoBuildingsHasNoEmptyLists) {
  const Glb glb = WrittenGlb({}, SampleFrame());
  EXPECT_EQ(glb.json["asset"]["version"], "2.0");
  for (const char* key : {"nodes", "meshes", "accessors", "bufferViews", "buffers", "materials"}) EXPECT_FALSE(glb.json.contains(key)) << key;
  EXPECT_FALSE(glb.json["scenes"][0].contains("nodes"));
  EXPECT_TRUE(glb.binary.empty());
}

}  // namespace
}  // namespace skyquilt::buildings
