#include "tests/surface/files/sample_surface.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/image/image.h"

namespace skyquilt::surface {

scene::SceneInfo SampleInfo(const geo::Geodetic& origin, bool georeferenced) {
  scene::SceneInfo info;
  info.origin = origin;
  info.georeferenced = georeferenced;
  info.height_reference = geo::HeightReference::kEllipsoid;
  info.min_enu = Eigen::Vector3d(-150.0, -100.0, -20.0);
  info.max_enu = Eigen::Vector3d(350.0, 300.0, 60.0);
  info.gsd_m = 0.1;
  return info;
}

std::vector<geo::Geodetic> DifficultOrigins() {
  return {{0.0, 0.0, 0.0},     {60.0, 24.9, 30.0},      {90.0, 0.0, 5.0},     {-90.0, 40.0, 2800.0},
          {-16.5, 180.0, 7.0}, {-16.5, -179.999, 10.0}, {31.5, 35.5, -400.0}, {27.99, 86.93, 8849.0}};
}

TexturedTile SampleTile(const TileId& id, int cells) {
  TexturedTile tile;
  tile.id = id;
  const double size_m = std::ldexp(kSampleTile_m, id.level);
  tile.error_m = id.level == 0 ? 0.02 : std::ldexp(0.05, id.level);
  const auto height = [](double x, double y) { return 6.0 * std::sin(0.05 * x) + 4.0 * std::cos(0.07 * y) + 0.01 * x; };
  const auto side = static_cast<uint32_t>(cells + 1);
  for (uint32_t row = 0; row < side; ++row) {
    for (uint32_t column = 0; column < side; ++column) {
      const double u = static_cast<double>(column) / cells;
      const double v = static_cast<double>(row) / cells;  // to the south, as in the texture
      const double x = (id.column + u) * size_m;
      const double y = (id.row + 1.0 - v) * size_m;
      tile.position.emplace_back(x, y, height(x, y));
      const double slope_x = 0.3 * std::cos(0.05 * x) + 0.01;
      const double slope_y = -0.28 * std::sin(0.07 * y);
      tile.normal.push_back(Eigen::Vector3d(-slope_x, -slope_y, 1.0).normalized().cast<float>());
      tile.uv.push_back(Eigen::Vector2d(u, v).cast<float>());
      tile.views.push_back(static_cast<uint8_t>(3 + (row + column) % 5));
      tile.filled.push_back(static_cast<uint8_t>(row == 1 && column == 1));
      if (row == 0 || column == 0) continue;
      const uint32_t here = row * side + column;
      tile.triangle.push_back({here, here - side, here - side - 1});
      tile.triangle.push_back({here, here - side - 1, here - 1});
    }
  }
  image::Image8 atlas(64, 48, 3);
  for (int y = 0; y < atlas.height; ++y) {
    for (int x = 0; x < atlas.width; ++x) {
      atlas.At(x, y)[0] = static_cast<uint8_t>(20 + 200 * x / (atlas.width - 1));
      atlas.At(x, y)[1] = static_cast<uint8_t>(20 + 200 * y / (atlas.height - 1));
      atlas.At(x, y)[2] = 40;
    }
  }
  tile.atlas_width = atlas.width;
  tile.atlas_height = atlas.height;
  tile.atlas_jpeg = image::EncodeJpeg(atlas, 95);
  return tile;
}

std::vector<TexturedTile> SamplePyramid() {
  std::vector<TexturedTile> tiles;
  for (const TileId& id :
       {TileId{0, -1, -1}, TileId{0, 0, -1}, TileId{0, 0, 0}, TileId{0, 1, 0}, TileId{1, -1, -1}, TileId{1, 0, -1}, TileId{1, 0, 0}}) {
    tiles.push_back(SampleTile(id));
  }
  // Parents never end below zero, so the top of a survey on both sides of the origin has several tiles of the highest level.
  tiles.push_back(SampleTile({2, -1, -1}));
  tiles.push_back(SampleTile({2, 0, -1}));
  tiles.push_back(SampleTile({2, 0, 0}));
  return tiles;
}

std::vector<CloudPoint> SamplePoints(int count) {
  std::vector<CloudPoint> points;
  for (int i = 0; i < count; ++i) {
    CloudPoint point;
    point.position = Eigen::Vector3d(3.1234 * i, -2.71 * i, 0.0123 * i);
    point.normal = Eigen::Vector3f(0.6F, 0.0F, 0.8F);
    point.rgb = {static_cast<uint8_t>(i % 256), 255, 0};
    point.views = static_cast<uint8_t>(i % 7);
    point.filled = static_cast<uint8_t>(i % 2);
    point.las_class = static_cast<uint8_t>(1 + i % 2);
    points.push_back(point);
  }
  return points;
}

Glb::Glb(const std::filesystem::path& file) {
  const std::string bytes = base::ReadFile(file);
  if (bytes.substr(0, 4) != "glTF" || ReadAs<uint32_t>(bytes, 4) != 2) throw std::runtime_error("not a GLB 2 file");
  if (ReadAs<uint32_t>(bytes, 8) != bytes.size()) throw std::runtime_error("wrong length of the file");
  const size_t json_bytes = ReadAs<uint32_t>(bytes, 12);
  if (bytes.substr(16, 4) != "JSON" || json_bytes % 4 != 0) throw std::runtime_error("wrong JSON chunk");
  json = base::ParseJson(bytes.substr(20, json_bytes));
  const size_t at = 20 + json_bytes;
  if (bytes.substr(at + 4, 4) != std::string("BIN\0", 4)) throw std::runtime_error("wrong BIN chunk");
  binary = bytes.substr(at + 8);
  if (ReadAs<uint32_t>(bytes, at) != binary.size() || binary.size() % 4 != 0) throw std::runtime_error("wrong length of the BIN chunk");
  if (json["buffers"][0]["byteLength"] != binary.size()) throw std::runtime_error("wrong length of the buffer");
}

std::vector<std::vector<double>> Glb::Accessor(size_t index) const {
  const nlohmann::json& accessor = json["accessors"][index];
  const nlohmann::json& view = json["bufferViews"][accessor["bufferView"].get<size_t>()];
  const size_t columns = accessor["type"] == "VEC3" ? 3 : accessor["type"] == "VEC2" ? 2 : 1;
  size_t at = view["byteOffset"];
  std::vector<std::vector<double>> rows(accessor["count"].get<size_t>(), std::vector<double>(columns));
  for (std::vector<double>& row : rows) {
    for (double& value : row) {
      const int type = accessor["componentType"];
      if (type == 5126) value = static_cast<double>(ReadAs<float>(binary, at));
      if (type == 5125) value = ReadAs<uint32_t>(binary, at);
      if (type == 5123) value = ReadAs<uint16_t>(binary, at);
      at += type == 5123 ? 2 : 4;
    }
  }
  if (at != view["byteOffset"].get<size_t>() + view["byteLength"].get<size_t>()) throw std::runtime_error("wrong length of a buffer view");
  return rows;
}

std::string Glb::Picture(size_t image) const {
  const nlohmann::json& view = json["bufferViews"][json["images"][image]["bufferView"].get<size_t>()];
  return binary.substr(view["byteOffset"], view["byteLength"]);
}

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> NamesIn(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace skyquilt::surface
