#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "surface/files/glb_writer.h"
#include "surface/files/surface_files.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/surface/files/sample_surface.h"

namespace skyquilt::surface {
namespace {

constexpr FileSelection kOnlyGlb = {.glb = true, .obj = false, .ply = false, .cloud = false, .tiles = false};

// Writes the tiles and takes mesh.glb apart.
Glb WriteGlb(const MapFrame& frame, const std::vector<TexturedTile>& tiles) {
  const TemporaryFolder folder;
  SurfaceFiles files(frame, kOnlyGlb, kSampleTile_m, folder.path());
  for (const TexturedTile& tile : tiles) files.Add(tile);
  files.Close();
  return Glb(folder / "mesh.glb");
}

TEST(Glb, PositionsComeBackWithYUp) {
  for (const geo::Geodetic& origin : DifficultOrigins()) {
    const MapFrame frame(SampleInfo(origin));
    const TexturedTile tile = SampleTile({0, 1, -2});
    const Glb glb = WriteGlb(frame, {tile});
    const auto positions = glb.Accessor(glb.primitive(0)["attributes"]["POSITION"]);
    const auto normals = glb.Accessor(glb.primitive(0)["attributes"]["NORMAL"]);
    const auto indices = glb.Accessor(glb.primitive(0)["indices"]);
    ASSERT_EQ(indices.size(), 3 * tile.triangle.size());
    for (size_t corner = 0; corner < indices.size(); ++corner) {
      const auto vertex = static_cast<size_t>(indices[corner][0]);
      const uint32_t source = tile.triangle[corner / 3][corner % 3];
      const auto& p = positions.at(vertex);
      const Eigen::Vector3d back = frame.offset() + Eigen::Vector3d(p[0], -p[2], p[1]);
      // Half a step of single precision at a height of 9 km.
      EXPECT_LT((back - frame.MapFromEnu(tile.position[source])).norm(), 5e-4);
      const Eigen::Vector3f normal = frame.MapDirection(tile.normal[source]);
      EXPECT_NEAR(normals[vertex][0], static_cast<double>(normal.x()), 1e-6);
      EXPECT_NEAR(normals[vertex][1], static_cast<double>(normal.z()), 1e-6);
      EXPECT_NEAR(normals[vertex][2], static_cast<double>(-normal.y()), 1e-6);
      EXPECT_NEAR(std::hypot(normals[vertex][0], normals[vertex][1], normals[vertex][2]), 1.0, 1e-4);
      const auto uv = glb.Accessor(glb.primitive(0)["attributes"]["TEXCOORD_0"])[vertex];
      EXPECT_EQ(uv[0], static_cast<double>(tile.uv[source].x()));
      EXPECT_EQ(uv[1], static_cast<double>(tile.uv[source].y()));
    }
  }
}

TEST(Glb, BoundsAreExactAndPiecesAligned) {
  const MapFrame frame = TorontoFrame();
  const Glb glb = WriteGlb(frame, {SampleTile({0, 0, 0}), SampleTile({0, 1, 0}, 5)});
  ASSERT_EQ(glb.json["meshes"][0]["primitives"].size(), 2U);
  for (size_t i = 0; i < 2; ++i) {
    const size_t accessor = glb.primitive(i)["attributes"]["POSITION"];
    std::vector<double> min(3, HUGE_VAL), max(3, -HUGE_VAL);
    for (const auto& p : glb.Accessor(accessor)) {
      for (size_t axis = 0; axis < 3; ++axis) {
        min[axis] = std::min(min[axis], p[axis]);
        max[axis] = std::max(max[axis], p[axis]);
      }
    }
    EXPECT_EQ(glb.json["accessors"][accessor]["min"].get<std::vector<double>>(), min);
    EXPECT_EQ(glb.json["accessors"][accessor]["max"].get<std::vector<double>>(), max);
  }
  for (const auto& view : glb.json["bufferViews"]) EXPECT_EQ(view["byteOffset"].get<size_t>() % 4, 0U);
}

TEST(Glb, MaterialsShowTheTextureWithoutLight) {
  const MapFrame frame = TorontoFrame();
  const TexturedTile tile = SampleTile({0, 0, 0});
  TexturedTile other = SampleTile({0, 1, 0});
  other.atlas_jpeg.push_back(0);  // bytes after the end of a JPEG do no harm, but tell the two apart
  const Glb glb = WriteGlb(frame, {tile, other});
  EXPECT_EQ(glb.json["asset"]["generator"], "Skyquilt");
  EXPECT_EQ(glb.json["asset"]["extras"]["crs"], "EPSG:32617");
  EXPECT_EQ(glb.json["asset"]["extras"]["offset"].get<std::vector<double>>(), std::vector<double>(frame.offset().data(), frame.offset().data() + 3));
  EXPECT_EQ(glb.json["scenes"][0]["extras"]["verticalDatum"], "WGS84 ellipsoid (EPSG:4979)");
  EXPECT_EQ(glb.json["extensionsUsed"][0], "KHR_materials_unlit");
  for (size_t i = 0; i < 2; ++i) {
    const auto& material = glb.json["materials"][glb.primitive(i)["material"].get<size_t>()];
    EXPECT_TRUE(material["doubleSided"]);
    EXPECT_TRUE(material["extensions"].contains("KHR_materials_unlit"));
    EXPECT_EQ(material["pbrMetallicRoughness"]["metallicFactor"], 0.0);
    const size_t texture = material["pbrMetallicRoughness"]["baseColorTexture"]["index"];
    EXPECT_EQ(glb.json["samplers"][glb.json["textures"][texture]["sampler"].get<size_t>()]["wrapS"], 33071);
    const std::string picture = glb.Picture(glb.json["textures"][texture]["source"]);
    const std::vector<uint8_t>& expected = i == 0 ? tile.atlas_jpeg : other.atlas_jpeg;
    EXPECT_EQ(picture, std::string(expected.begin(), expected.end()));
  }
}

TEST(Glb, IndicesAreShortWhileTheyFit) {
  const MapFrame frame(SampleInfo({0.0, 0.0, 0.0}, false));
  // 255^2 = 65025 and 256^2 = 65536 vertices; the index 65535 is reserved.
  const Glb few = WriteGlb(frame, {SampleTile({0, 0, 0}, 254)});
  EXPECT_EQ(few.json["accessors"][few.primitive(0)["indices"].get<size_t>()]["componentType"], 5123);
  const Glb many = WriteGlb(frame, {SampleTile({0, 0, 0}, 255)});
  EXPECT_EQ(many.json["accessors"][many.primitive(0)["indices"].get<size_t>()]["componentType"], 5125);
  double greatest = 0.0;
  for (const auto& row : many.Accessor(many.primitive(0)["indices"])) greatest = std::max(greatest, row[0]);
  EXPECT_EQ(greatest, 65535.0);
}

TEST(Glb, BadTrianglesAndNormalsAreMended) {
  const MapFrame frame = TorontoFrame();
  TexturedTile tile = SampleTile({0, 0, 0});
  const size_t good = tile.triangle.size();
  tile.triangle.push_back({0, 0, 1});
  tile.position.emplace_back(std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0);
  tile.normal.push_back(Eigen::Vector3f::Zero());
  tile.uv.push_back(Eigen::Vector2f::Zero());
  tile.views.push_back(0);
  tile.filled.push_back(0);
  tile.triangle.push_back({0, 1, static_cast<uint32_t>(tile.position.size() - 1)});
  tile.normal[2].setZero();
  tile.normal[3] *= 7.0F;
  const Glb glb = WriteGlb(frame, {tile});
  EXPECT_EQ(glb.Accessor(glb.primitive(0)["indices"]).size(), 3 * good);
  for (const auto& n : glb.Accessor(glb.primitive(0)["attributes"]["NORMAL"])) EXPECT_NEAR(std::hypot(n[0], n[1], n[2]), 1.0, 1e-4);
  for (const auto& p : glb.Accessor(glb.primitive(0)["attributes"]["POSITION"])) EXPECT_TRUE(std::isfinite(p[0]));
}

TEST(Glb, TilesWithoutTextureAreWritten) {
  const MapFrame frame = TorontoFrame();
  TexturedTile tile = SampleTile({0, 0, 0});
  tile.atlas_jpeg.clear();
  const Glb glb = WriteGlb(frame, {tile});
  EXPECT_FALSE(glb.json.contains("images"));
  EXPECT_FALSE(glb.primitive(0)["attributes"].contains("TEXCOORD_0"));
}

TEST(Glb, TooLargeFilesAreRefusedWithAdvice) {
  const TemporaryFolder folder;
  const MapFrame frame = TorontoFrame();
  const TexturedTile tile = CleanTile(SampleTile({0, 0, 0}));
  const MapVertices in_map = VerticesInMap(tile, frame);
  {
    GlbWriter writer(frame, folder.path(), 10'000);
    const std::string message = InputErrorOf([&] {
      for (int i = 0; i < 10; ++i) writer.AddTile(tile, &in_map);
    });
    EXPECT_NE(message.find("mesh.glb"), std::string::npos) << message;
    EXPECT_NE(message.find("surface.glb = false"), std::string::npos) << message;
  }
  EXPECT_TRUE(NamesIn(folder.path()).empty());
}

}  // namespace
}  // namespace skyquilt::surface
