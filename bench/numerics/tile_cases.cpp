// 3D tiles at extreme places: what a viewer of the files sees, from the bytes on disk, against closed formulas in long double.
#include <fmt/core.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numbers>

#include "bench/numerics/geodesy.h"
#include "bench/numerics/groups.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/geo/enu_frame.h"
#include "core/image/image.h"
#include "surface/files/surface_files.h"

namespace skyquilt::bench {
namespace {

namespace fs = std::filesystem;

// A wall of 30 m upright on its western foot, 800 m east and 600 m south of the survey's origin.
surface::TexturedTile Wall() {
  surface::TexturedTile tile;
  const Eigen::Vector3d foot(800.0, -600.0, 12.0);
  for (const auto& [along, up] : {std::pair{0.0, 0.0}, {20.0, 0.0}, {20.0, 30.0}, {0.0, 30.0}}) {
    tile.position.push_back(foot + Eigen::Vector3d(along, 0.0, up));
    tile.normal.push_back({0.0F, -1.0F, 0.0F});
    tile.uv.push_back({static_cast<float>(along / 20.0), static_cast<float>(1.0 - up / 30.0)});
    tile.views.push_back(3);
    tile.filled.push_back(0);
  }
  tile.triangle = {{0, 1, 2}, {0, 2, 3}};
  tile.atlas_width = tile.atlas_height = 16;
  tile.atlas_jpeg = image::EncodeJpeg(image::Image8(16, 16, 3, 200), 80);
  return tile;
}

// The corners of the first mesh of a GLB in glTF's axes (y up), with the translation of its node.
std::vector<Eigen::Vector3d> CornersOf(const fs::path& glb) {
  const std::string bytes = base::ReadFile(glb);
  const auto word = [&](size_t at) {
    uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, sizeof(value));
    return static_cast<size_t>(value);
  };
  const size_t json_bytes = word(12);
  const nlohmann::json json = base::ParseJson(bytes.substr(20, json_bytes));
  const size_t binary = 20 + json_bytes + 8;
  const auto& accessor = json["accessors"][json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].get<size_t>()];
  const auto& view = json["bufferViews"][accessor["bufferView"].get<size_t>()];
  const size_t start = binary + view.value("byteOffset", size_t{0}) + accessor.value("byteOffset", size_t{0});
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  for (const auto& node : json["nodes"]) {
    if (!node.contains("mesh") || !node.contains("translation")) continue;
    for (int axis = 0; axis < 3; ++axis) shift[axis] = node["translation"][static_cast<size_t>(axis)].get<double>();
  }
  std::vector<Eigen::Vector3d> corners;
  for (size_t i = 0; i < accessor["count"].get<size_t>(); ++i) {
    Eigen::Vector3f corner;
    std::memcpy(corner.data(), bytes.data() + start + i * 3 * sizeof(float), 3 * sizeof(float));
    corners.emplace_back(corner.cast<double>() + shift);
  }
  return corners;
}

CaseResult TileAt(const geo::Geodetic& origin, const fs::path& folder) {
  scene::SceneInfo info;
  info.origin = origin;
  info.georeferenced = true;
  info.min_enu = {-1000.0, -1000.0, 0.0};
  info.max_enu = {1000.0, 1000.0, 100.0};
  const surface::TexturedTile wall = Wall();
  fs::remove_all(folder);
  {
    const surface::MapFrame map_frame(info);
    surface::SurfaceFiles files(map_frame, {.glb = false, .obj = false, .ply = false, .cloud = false, .tiles = true}, 2000.0, folder);
    files.Add(wall);
    files.Close();
  }
  const nlohmann::json root = base::ParseJson(base::ReadFile(folder / "tiles" / "tileset.json"))["root"];
  Eigen::Matrix4d ecef_from_tile;
  for (int i = 0; i < 16; ++i) ecef_from_tile(i % 4, i / 4) = root["transform"][static_cast<size_t>(i)].get<double>();
  const std::vector<Eigen::Vector3d> corners = CornersOf(folder / "tiles" / (wall.id.Name() + ".glb"));
  const geo::EnuFrame frame(origin);
  Worst worst;
  std::vector<Vector3L> placed;
  for (size_t i = 0; i < corners.size() && i < wall.position.size(); ++i) {
    // Viewers turn the y-up content of glTF into z-up before they apply the tile's transform (3D Tiles 1.1, section 6.7.1.6).
    const Eigen::Vector3d z_up(corners[i].x(), -corners[i].z(), corners[i].y());
    const Eigen::Vector3d seen = (ecef_from_tile * z_up.homogeneous()).head<3>();
    const Vector3L expected = EcefOf(frame.GeodeticFromEnu(wall.position[i]));
    worst.Take(1e3 * static_cast<double>((seen.cast<long double>() - expected).norm()));
    placed.push_back(seen.cast<long double>());
  }
  CaseResult result{.seen = "", .worst = worst.value(), .holds = corners.size() == wall.position.size()};
  if (placed.size() < 4) return result;
  // The wall is upright in the survey's frame, whose up is the ellipsoid's normal at the origin.
  const double latitude = origin.latitude_deg * std::numbers::pi / 180.0;
  const double longitude = origin.longitude_deg * std::numbers::pi / 180.0;
  const Eigen::Vector3d up(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude), std::sin(latitude));
  const Eigen::Vector3d edge = (placed[3] - placed[0]).cast<double>();
  const double lean_deg = std::atan2(edge.cross(up).norm(), edge.dot(up)) * 180.0 / std::numbers::pi;
  result.holds = result.holds && lean_deg < 1e-4;
  result.seen = fmt::format("the wall leans {}", FormatError(lean_deg, "\xC2\xB0"));
  return result;
}

}  // namespace

NumericGroup TilesGroup(const NumericsOptions& options) {
  NumericGroup group{
      .id = "tiles",
      .title = "3D tiles",
      .lead =
          "A wall one kilometre from the survey's origin is written as a 3D tile and read back from its files as a viewer does. Its corners "
          "are compared with their Earth-centred places in long double, its upright edges with the ellipsoid's normal.",
      .cases = {},
      .charts = {}};
  if (options.work_folder.empty()) return group;
  const std::vector<std::pair<std::string, geo::Geodetic>> places = {{"Equator", {0.0, 8.5417, 100.0}},
                                                                     {"47\xC2\xB0 N", {47.3769, 8.5417, 408.0}},
                                                                     {"North pole", {90.0, 0.0, 2.0}},
                                                                     {"South pole", {-90.0, 0.0, 2835.0}},
                                                                     {"Ten metres from the north pole", {89.9999, 37.0, 0.0}},
                                                                     {"Across \xC2\xB1"
                                                                      "180\xC2\xB0 at 16.8\xC2\xB0 S",
                                                                      {-16.8, -180.0, 5.0}},
                                                                     {"Below sea level (-430 m)", {31.5, 35.5, -430.0}},
                                                                     {"At 9 km height", {27.9881, 86.925, 9000.0}}};
  for (const auto& [name, origin] : places) {
    group.cases.push_back({.name = name,
                           .expected = "corners within 1 mm, upright to 0.0001\xC2\xB0",
                           .unit = "mm",
                           .limit = 1.0,
                           .run = [origin = origin, folder = options.work_folder / "tiles"] { return TileAt(origin, folder); }});
  }
  return group;
}

}  // namespace skyquilt::bench
