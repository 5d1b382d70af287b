#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/base/file.h"
#include "core/image/image.h"
#include "surface/files/ply_writer.h"
#include "surface/files/surface_files.h"
#include "tests/support/temporary_folder.h"
#include "tests/surface/files/sample_surface.h"

namespace skyquilt::surface {
namespace {

struct ObjVertex {
  Eigen::Vector3d position;
  Eigen::Vector2d uv;
  Eigen::Vector3d normal;
};

struct Obj {
  std::vector<Eigen::Vector3d> position, normal;
  std::vector<Eigen::Vector2d> uv;
  std::vector<std::vector<ObjVertex>> faces;
  std::vector<std::string> material;  // per face
};

// Faces may only use vertices that stand above them; at() throws otherwise.
Obj ReadObj(const std::string& text) {
  Obj obj;
  std::string material;
  for (const std::string& line : Lines(text)) {
    std::istringstream stream(line);
    std::string key;
    stream >> key;
    double x = 0.0, y = 0.0, z = 0.0;
    if (key == "v" && stream >> x >> y >> z) obj.position.emplace_back(x, y, z);
    if (key == "vn" && stream >> x >> y >> z) obj.normal.emplace_back(x, y, z);
    if (key == "vt" && stream >> x >> y) obj.uv.emplace_back(x, y);
    if (key == "usemtl") stream >> material;
    if (key != "f") continue;
    obj.material.push_back(material);
    std::vector<ObjVertex>& face = obj.faces.emplace_back();
    size_t v = 0, vt = 0, vn = 0;
    char slash = 0;
    while (stream >> v >> slash >> vt >> slash >> vn) face.push_back({obj.position.at(v - 1), obj.uv.at(vt - 1), obj.normal.at(vn - 1)});
  }
  return obj;
}

TEST(Obj, FacesAreThoseOfTheTiles) {
  const TemporaryFolder folder;
  const MapFrame frame(SampleInfo({43.64, -79.39, 100.0}));
  const std::vector<TexturedTile> tiles = {SampleTile({0, -1, 0}), SampleTile({0, 0, 0}, 5), SampleTile({1, 0, 0})};
  {
    SurfaceFiles files(frame, {.glb = false, .obj = true, .ply = false, .cloud = false, .tiles = false}, kSampleTile_m, folder.path());
    for (const TexturedTile& tile : tiles) files.Add(tile);
    files.Close();
  }
  const std::string text = base::ReadFile(folder / "mesh.obj");
  EXPECT_NE(text.find("# CRS: EPSG:32617"), std::string::npos);
  EXPECT_NE(text.find("# offset: " + std::to_string(std::lround(frame.offset().x())) + " "), std::string::npos);
  const Obj obj = ReadObj(text);
  ASSERT_EQ(obj.faces.size(), tiles[0].triangle.size() + tiles[1].triangle.size()) << "only level 0";
  size_t face = 0;
  for (size_t t = 0; t < 2; ++t) {
    for (const Triangle& triangle : tiles[t].triangle) {
      EXPECT_EQ(obj.material[face], "tile_" + tiles[t].id.Name());
      ASSERT_EQ(obj.faces[face].size(), 3U);
      for (size_t corner = 0; corner < 3; ++corner) {
        const ObjVertex& vertex = obj.faces[face][corner];
        const uint32_t source = triangle[corner];
        EXPECT_LT((vertex.position + frame.offset() - frame.MapFromEnu(tiles[t].position[source])).norm(), 1e-3);
        EXPECT_LT((vertex.normal - frame.MapDirection(tiles[t].normal[source]).cast<double>()).norm(), 1e-3);
        EXPECT_NEAR(vertex.uv.x(), static_cast<double>(tiles[t].uv[source].x()), 1e-6);
        EXPECT_NEAR(vertex.uv.y(), 1.0 - static_cast<double>(tiles[t].uv[source].y()), 1e-6);
      }
      ++face;
    }
  }
  const std::string materials = base::ReadFile(folder / "mesh.mtl");
  EXPECT_NE(materials.find("newmtl tile_0_-1_0\n"), std::string::npos);
  EXPECT_NE(materials.find("map_Kd mesh_0_-1_0.jpg\n"), std::string::npos);
  const std::string picture = base::ReadFile(folder / "mesh_0_-1_0.jpg");
  EXPECT_EQ(std::vector<uint8_t>(picture.begin(), picture.end()), tiles[0].atlas_jpeg);
}

struct Ply {
  std::vector<std::string> head;
  std::string data;
  size_t vertices = 0, faces = 0;
  explicit Ply(const std::string& bytes) {
    const size_t end = bytes.find("end_header\n");
    head = Lines(bytes.substr(0, end));
    data = bytes.substr(end + std::string("end_header\n").size());
    for (const std::string& line : head) {
      if (line.starts_with("element vertex ")) vertices = std::stoul(line.substr(15));
      if (line.starts_with("element face ")) faces = std::stoul(line.substr(13));
    }
  }
  bool Has(const std::string& line) const { return std::find(head.begin(), head.end(), line) != head.end(); }
};

TEST(Ply, MeshComesBackWithColours) {
  const TemporaryFolder folder;
  const MapFrame frame(SampleInfo({43.64, -79.39, 100.0}));
  const std::vector<TexturedTile> tiles = {SampleTile({0, -1, 0}), SampleTile({0, 0, 0}, 5)};
  {
    SurfaceFiles files(frame, {.glb = false, .obj = false, .ply = true, .cloud = false, .tiles = false}, kSampleTile_m, folder.path());
    for (const TexturedTile& tile : tiles) files.Add(tile);
    files.Close();
  }
  const Ply ply(base::ReadFile(folder / "mesh.ply"));
  EXPECT_EQ(ply.head[0], "ply");
  EXPECT_TRUE(ply.Has("format binary_little_endian 1.0"));
  EXPECT_TRUE(ply.Has("comment CRS: EPSG:32617"));
  EXPECT_TRUE(ply.Has("property list uchar int vertex_indices"));
  constexpr size_t kVertex = 29, kFace = 13;
  ASSERT_EQ(ply.vertices, tiles[0].position.size() + tiles[1].position.size());
  ASSERT_EQ(ply.faces, tiles[0].triangle.size() + tiles[1].triangle.size());
  ASSERT_EQ(ply.data.size(), ply.vertices * kVertex + ply.faces * kFace);
  size_t face = 0;
  for (const TexturedTile& tile : tiles) {
    for (const Triangle& triangle : tile.triangle) {
      const size_t at = ply.vertices * kVertex + kFace * face++;
      EXPECT_EQ(ply.data[at], 3);
      for (size_t corner = 0; corner < 3; ++corner) {
        const auto index = static_cast<size_t>(ReadAs<int32_t>(ply.data, at + 1 + 4 * corner));
        ASSERT_LT(index, ply.vertices);
        const uint32_t source = triangle[corner];
        const size_t begin = index * kVertex;
        const Eigen::Vector3d back(static_cast<double>(ReadAs<float>(ply.data, begin)), static_cast<double>(ReadAs<float>(ply.data, begin + 4)),
                                   static_cast<double>(ReadAs<float>(ply.data, begin + 8)));
        // Half a step of single precision at a height of 9 km.
        EXPECT_LT((back + frame.offset() - frame.MapFromEnu(tile.position[source])).norm(), 5e-4);
        EXPECT_NEAR(ReadAs<float>(ply.data, begin + 20), frame.MapDirection(tile.normal[source]).z(), 1e-6F);
        EXPECT_NEAR(ReadAs<uint8_t>(ply.data, begin + 24), 20.0 + 200.0 * static_cast<double>(tile.uv[source].x()), 6.0);
        EXPECT_NEAR(ReadAs<uint8_t>(ply.data, begin + 25), 20.0 + 200.0 * static_cast<double>(tile.uv[source].y()), 6.0);
        EXPECT_NEAR(ReadAs<uint8_t>(ply.data, begin + 26), 40.0, 6.0);
        EXPECT_EQ(ReadAs<uint8_t>(ply.data, begin + 27), tile.views[source]);
        EXPECT_EQ(ReadAs<uint8_t>(ply.data, begin + 28), tile.filled[source]);
      }
    }
  }
}

TEST(Ply, CloudComesBack) {
  const TemporaryFolder folder;
  const MapFrame frame(SampleInfo({-33.0, 18.4, 20.0}));
  const std::vector<CloudPoint> points = SamplePoints(1000);
  {
    SurfaceFiles files(frame, {.glb = false, .obj = false, .ply = false, .cloud = true, .tiles = false}, kSampleTile_m, folder.path());
    files.AddPoints(std::span(points).first(300));
    files.AddPoints(std::span(points).subspan(300));
    files.Close();
  }
  const Ply ply(base::ReadFile(folder / "cloud.ply"));
  constexpr size_t kPoint = 30;
  ASSERT_EQ(ply.vertices, points.size());
  ASSERT_EQ(ply.data.size(), kPoint * points.size());
  EXPECT_FALSE(ply.Has("property list uchar int vertex_indices"));
  for (size_t i = 0; i < points.size(); ++i) {
    const size_t at = i * kPoint;
    const Eigen::Vector3d back(static_cast<double>(ReadAs<float>(ply.data, at)), static_cast<double>(ReadAs<float>(ply.data, at + 4)),
                               static_cast<double>(ReadAs<float>(ply.data, at + 8)));
    EXPECT_LT((back + frame.offset() - frame.MapFromEnu(points[i].position)).norm(), 5e-4);  // single precision 4 km from the offset
    EXPECT_EQ(ReadAs<uint8_t>(ply.data, at + 24), points[i].rgb[0]);
    EXPECT_EQ(ReadAs<uint8_t>(ply.data, at + 29), points[i].las_class);
  }
}

TEST(SampleTexture, IsLinearBetweenTheMiddlesOfTexels) {
  image::Image8 texture(2, 2, 3);
  for (size_t c = 0; c < 3; ++c) {
    texture.At(1, 0)[c] = 100;
    texture.At(1, 1)[c] = 200;
  }
  EXPECT_EQ(SampleTexture(texture, {0.75F, 0.25F})[0], 100);
  EXPECT_EQ(SampleTexture(texture, {0.5F, 0.25F})[0], 50);
  EXPECT_EQ(SampleTexture(texture, {0.75F, 0.5F})[0], 150);
  EXPECT_EQ(SampleTexture(texture, {7.0F, -1.0F})[0], 100);
  EXPECT_EQ(SampleTexture(image::Image8(), {0.5F, 0.5F})[0], 128);
}

TEST(DecodeRgb8, ReadsWhatEncodeJpegWrites) {
  const image::Image8 grey(8, 8, 3, 77);
  const image::Image8 back = image::DecodeRgb8(image::EncodeJpeg(grey, 95));
  ASSERT_EQ(back.data.size(), grey.data.size());
  EXPECT_NEAR(back.data[0], 77, 2);
}

}  // namespace
}  // namespace skyquilt::surface
