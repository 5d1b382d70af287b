#include "odm/place_files.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/base/errors.h"
#include "core/base/json_document.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/memory_map.h"
#include "core/base/output_file.h"
#include "core/gis/derived_maps.h"
#include "core/gis/read_maps.h"
#include "core/gis/zone_wkt.h"
#include "odm/ept/write_ept.h"
#include "surface/files/las_part.h"

namespace skyquilt::odm {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 9> kResults = {"odm_orthophoto",     "odm_dem",    "odm_georeferencing", "odm_texturing", "3d_tiles",
                                                 "entwine_pointcloud", "odm_report", "images.json",        "cameras.json"};

[[noreturn]] void FailPlacing(const fs::path& file, const std::error_code& error) {
  throw base::InputError(file, "cannot be made: " + error.message(), "Check the free space and permissions of its folder");
}

void RemoveAll(const fs::path& path) {
  std::error_code error;
  fs::remove_all(path, error);
  if (error) throw base::InputError(path, "cannot be removed: " + error.message(), "Check the permissions of its folder");
}

void CopyWhole(const fs::path& from, const fs::path& to) {
  base::PartialPath partial(to);
  std::error_code error;
  fs::copy_file(from, partial.path(), fs::copy_options::overwrite_existing, error);
  if (error) FailPlacing(to, error);
  partial.Publish();
}

// A map, with cells of at least that size.
void ProvideMap(const fs::path& from, const fs::path& to, double cell_m) {
  if (!fs::exists(from) || gis::ReadMapGrid(from).resolution_m > 0.999 * cell_m) {
    ProvideFile(from, to);
    return;
  }
  fs::create_directories(to.parent_path());
  gis::WriteCoarserMap(from, to, cell_m);
}

// The OBJ names its material file in its head, so that file is there under both names; textures keep theirs.
void ProvideMesh(const fs::path& surface, const Wishes& wishes, const fs::path& to) {
  RemoveAll(to);
  if (!wishes.mesh || !fs::exists(surface / "mesh.obj")) return;
  ProvideFile(surface / "mesh.obj", to / "odm_textured_model_geo.obj");
  ProvideFile(surface / "mesh.mtl", to / "mesh.mtl");
  ProvideFile(surface / "mesh.mtl", to / "odm_textured_model_geo.mtl");
  for (const fs::directory_entry& entry : fs::directory_iterator(surface)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("mesh_") && name.ends_with(".jpg")) ProvideFile(entry.path(), to / name);
  }
  if (!wishes.glb || !fs::exists(surface / "mesh.glb")) return;
  const base::JsonDocument place(surface / "georeference.json", "Make the surface again with --rerun-from odm_meshing");
  const std::vector<double> offset = place.Root().At("offset").Numbers(3);
  WriteUprightGlb(surface / "mesh.glb", {offset[0], offset[1], offset[2]}, to / "odm_textured_model_geo.glb");
}

void ProvideFolder(const fs::path& from, const fs::path& to) {
  RemoveAll(to);
  if (!fs::is_directory(from)) return;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(from)) {
    if (entry.is_regular_file()) ProvideFile(entry.path(), to / fs::relative(entry.path(), from));
  }
}

// The CRS of the surface's files.
ept::EptCrs CrsOf(const fs::path& surface) {
  const base::JsonDocument place(surface / "georeference.json", "Make the surface again with --rerun-from odm_meshing");
  const std::optional<base::JsonValue> crs = place.Root().Find("crs");
  ept::EptCrs found;
  if (!crs) return found;
  const std::string name = crs->Text();
  found.epsg = std::atoi(name.substr(name.find(':') + 1).c_str());
  geo::UtmZone zone{.zone = found.epsg % 100, .north = found.epsg < 32700};
  if (zone.zone == 61) zone.zone = 0;  // UPS
  found.wkt = gis::WktOfZone(zone);
  return found;
}

void ProvideCloud(const fs::path& surface, const Wishes& wishes, const fs::path& folder) {
  const fs::path to = folder / "odm_georeferencing";
  RemoveAll(to);
  const std::vector<fs::path> parts = wishes.cloud ? surface::CloudFiles(surface) : std::vector<fs::path>();
  for (const fs::path& part : parts) {
    // A large cloud is cut into cloud_1.las, cloud_2.las ...
    ProvideFile(part, to / ("odm_georeferenced_model" + part.filename().string().substr(std::strlen("cloud"))));
  }
  ProvideFile(surface / "offset.txt", to / "coords.txt");
  RemoveAll(folder / "entwine_pointcloud");
  if (wishes.ept && !parts.empty()) ept::WriteEpt(parts, CrsOf(surface), folder / "entwine_pointcloud");
}

uint32_t WordAt(std::span<const uint8_t> bytes, size_t at) {
  uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

}  // namespace

void ProvideFile(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::remove(to, error);
  if (error) FailPlacing(to, error);
  if (!fs::exists(from)) return;
  fs::create_directories(to.parent_path(), error);
  if (error) FailPlacing(to.parent_path(), error);
  fs::create_hard_link(from, to, error);
  if (error) CopyWhole(from, to);
}

void WriteUprightGlb(const fs::path& glb, const Eigen::Vector3d& offset, const fs::path& to) {
  constexpr size_t kHeadBytes = 12, kChunkHeadBytes = 8;
  constexpr uint32_t kMagic = 0x46546C67, kJsonChunk = 0x4E4F534A;
  const base::MemoryMap map(glb);
  const std::span<const uint8_t> bytes = map.bytes();
  const char* fix = "Make the surface again with --rerun-from odm_meshing";
  if (bytes.size() < kHeadBytes + kChunkHeadBytes || WordAt(bytes, 0) != kMagic || WordAt(bytes, kHeadBytes + 4) != kJsonChunk ||
      WordAt(bytes, kHeadBytes) > bytes.size() - kHeadBytes - kChunkHeadBytes) {
    throw base::InputError(glb, "is no binary glTF file", fix);
  }
  const size_t json_bytes = WordAt(bytes, kHeadBytes);
  const auto* text = reinterpret_cast<const char*>(bytes.data()) + kHeadBytes + kChunkHeadBytes;
  nlohmann::ordered_json document = base::ParseOrderedJson({text, json_bytes});
  // A node above all others turns y up into z up: (x, y, z) becomes (x, -z, y).
  nlohmann::ordered_json& scene = document["scenes"][0];
  const double half = 0.5 * std::numbers::sqrt2;
  document["nodes"].push_back({{"name", "z up"}, {"rotation", {half, 0.0, 0.0, half}}, {"children", scene["nodes"]}});
  scene["nodes"] = nlohmann::ordered_json::array({document["nodes"].size() - 1});
  document["extensionsUsed"].push_back("CESIUM_RTC");
  document["extensions"]["CESIUM_RTC"] = {{"center", {offset.x(), offset.y(), offset.z()}}};
  std::string described = base::JsonText(document);
  described.resize((described.size() + 3) / 4 * 4, ' ');
  const std::span<const uint8_t> rest = bytes.subspan(kHeadBytes + kChunkHeadBytes + json_bytes);
  const uint64_t total = kHeadBytes + kChunkHeadBytes + described.size() + rest.size();
  if (total > UINT32_MAX) throw base::InputError(glb, "is too large for the format with another head", "Leave --gltf out");
  fs::create_directories(to.parent_path());
  base::OutputFile file(to);
  const std::array<uint32_t, 5> head = {kMagic, 2, static_cast<uint32_t>(total), static_cast<uint32_t>(described.size()), kJsonChunk};
  file.Append(std::span<const uint8_t>(reinterpret_cast<const uint8_t*>(head.data()), sizeof head));
  file.Append(described);
  file.Append(rest);
  file.Complete();
  file.Publish();
}

void PlaceProducts(const Dataset& dataset, const coordinator::Project& project, const Wishes& wishes, const MapCells& cells) {
  const fs::path maps = project.ProductsFolder(), surface = project.SurfaceFolder();
  const fs::path none;
  const fs::path orthophoto = dataset.folder / "odm_orthophoto";
  ProvideMap(wishes.orthophoto ? maps / "orthophoto.tif" : none, orthophoto / "odm_orthophoto.tif", cells.orthophoto_m);
  ProvideFile(wishes.orthophoto && wishes.cutline ? maps / "cutline.gpkg" : none, orthophoto / "cutline.gpkg");
  for (const char* name : {"odm_orthophoto.png", "odm_orthophoto.wld"}) RemoveAll(orthophoto / name);
  if (wishes.png && fs::exists(orthophoto / "odm_orthophoto.tif")) {
    gis::WriteMapPicture(orthophoto / "odm_orthophoto.tif", orthophoto / "odm_orthophoto.png");
  }
  ProvideMap(wishes.dsm ? maps / "dsm.tif" : none, dataset.folder / "odm_dem" / "dsm.tif", cells.heights_m);
  ProvideMap(wishes.dtm ? surface / "dtm.tif" : none, dataset.folder / "odm_dem" / "dtm.tif", cells.heights_m);
  ProvideMesh(surface, wishes, dataset.folder / "odm_texturing");
  ProvideFolder(wishes.tiles_3d ? surface / "tiles" : none, dataset.folder / "3d_tiles" / "model");
  ProvideCloud(surface, wishes, dataset.folder);
}

void CopyResults(const fs::path& dataset, const fs::path& to) {
  std::error_code error;
  fs::create_directories(to, error);
  if (error) FailPlacing(to, error);
  for (const char* name : kResults) {
    if (!fs::exists(dataset / name)) continue;
    fs::copy(dataset / name, to / name, fs::copy_options::recursive | fs::copy_options::overwrite_existing, error);
    if (error) FailPlacing(to / name, error);
  }
  base::LogInfo("results copied to {}", to.string());
}

void RemoveResultFolders(const fs::path& dataset) {
  for (const char* name : kResults) RemoveAll(dataset / name);
}

}  // namespace skyquilt::odm
