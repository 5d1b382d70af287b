// buildings.glb: binary glTF 2.0, which stands on the surface's mesh.glb.
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "buildings/files/building_files.h"
#include "buildings/files/building_table.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "surface/files/file_writer.h"
#include "surface/files/gltf_document.h"

namespace skyquilt::buildings {
namespace {

using Json = nlohmann::ordered_json;
using surface::Put;

// Numbers of the glTF 2.0 specification.
constexpr uint32_t kMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinChunk = 0x004E4942;
constexpr int kFloat = 5126, kUint32 = 5125;
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;
constexpr int kVectorBytes = 12;
constexpr std::array<FaceKind, 3> kKinds = {FaceKind::kRoof, FaceKind::kWall, FaceKind::kGround};

Json MaterialsJson() {
  const auto material = [](const char* name, double red, double green, double blue) -> Json {
    return {{"name", name},
            {"pbrMetallicRoughness", {{"baseColorFactor", {red, green, blue, 1.0}}, {"metallicFactor", 0.0}, {"roughnessFactor", 1.0}}}};
  };
  // In the order of kKinds.
  return Json::array({material("roof", 0.55, 0.12, 0.08), material("wall", 0.6, 0.6, 0.6), material("ground", 0.25, 0.25, 0.25)});
}

// Double precision, so that slim faces have a direction too.
Eigen::Vector3d NormalOf(const std::vector<uint32_t>& ring, const std::vector<Eigen::Vector3d>& position) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector3d a = position[ring[i]] - position[ring[0]], b = position[ring[(i + 1) % ring.size()]] - position[ring[0]];
    sum += Eigen::Vector3d(a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x());
  }
  return sum.norm() > 1e-12 ? sum.normalized() : Eigen::Vector3d::UnitZ();
}

// The binary part: all positions, all normals, all indices; and the JSON that points into it.
class GlbMeshes {
 public:
  // Returns the number of the mesh, or -1 when there is nothing to show. position: of the solid's vertices, z up.
  int Add(const Solid& solid, const std::vector<Eigen::Vector3d>& position, const std::string& name) {
    const SolidTriangles triangles = Triangulate(solid);
    Json primitives = Json::array();
    for (size_t kind = 0; kind < kKinds.size(); ++kind) {
      const size_t first = vertices_;
      std::map<std::pair<uint32_t, uint32_t>, uint32_t> index_of;  // of a vertex in a face: faces have edges, so they share no normals
      Eigen::Vector3f min = Eigen::Vector3f::Constant(HUGE_VALF), max = -min;
      const size_t first_index = indices_;
      for (size_t i = 0; i < triangles.triangle.size(); ++i) {
        const Face& face = solid.face[triangles.face[i]];
        if (face.kind != kKinds[kind]) continue;
        for (const uint32_t vertex : triangles.triangle[i]) {
          const auto [entry, is_new] = index_of.emplace(std::pair(triangles.face[i], vertex), static_cast<uint32_t>(index_of.size()));
          if (is_new) {
            const Eigen::Vector3f placed = surface::YUp(position[vertex].cast<float>());
            PutVector(placed, &position_bytes_);
            PutVector(surface::YUp(NormalOf(face.outer, position).cast<float>()), &normal_bytes_);
            min = min.cwiseMin(placed);
            max = max.cwiseMax(placed);
            ++vertices_;
          }
          Put(&index_bytes_, entry->second);
          ++indices_;
        }
      }
      if (indices_ == first_index) continue;
      const size_t count = vertices_ - first;
      accessors_.push_back({{"bufferView", 0},
                            {"byteOffset", first * kVectorBytes},
                            {"componentType", kFloat},
                            {"count", count},
                            {"type", "VEC3"},
                            {"min", {min.x(), min.y(), min.z()}},
                            {"max", {max.x(), max.y(), max.z()}}});
      accessors_.push_back({{"bufferView", 1}, {"byteOffset", first * kVectorBytes}, {"componentType", kFloat}, {"count", count}, {"type", "VEC3"}});
      accessors_.push_back({{"bufferView", 2},
                            {"byteOffset", first_index * sizeof(uint32_t)},
                            {"componentType", kUint32},
                            {"count", indices_ - first_index},
                            {"type", "SCALAR"}});
      const size_t accessor = accessors_.size() - 3;
      primitives.push_back({{"attributes", {{"POSITION", accessor}, {"NORMAL", accessor + 1}}}, {"indices", accessor + 2}, {"material", kind}});
    }
    if (primitives.empty()) return -1;
    meshes_.push_back({{"name", name}, {"primitives", std::move(primitives)}});
    return static_cast<int>(meshes_.size()) - 1;
  }

  std::vector<uint8_t> Binary() const {
    std::vector<uint8_t> bytes = position_bytes_;
    bytes.insert(bytes.end(), normal_bytes_.begin(), normal_bytes_.end());
    bytes.insert(bytes.end(), index_bytes_.begin(), index_bytes_.end());
    return bytes;
  }
  // glTF allows no empty lists.
  void AddTo(Json* document) const {
    if (meshes_.empty()) return;
    const size_t vectors = position_bytes_.size();
    (*document)["meshes"] = meshes_;
    (*document)["materials"] = MaterialsJson();
    (*document)["accessors"] = accessors_;
    (*document)["bufferViews"] =
        Json::array({{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", vectors}, {"byteStride", kVectorBytes}, {"target", kArrayBuffer}},
                     {{"buffer", 0}, {"byteOffset", vectors}, {"byteLength", vectors}, {"byteStride", kVectorBytes}, {"target", kArrayBuffer}},
                     {{"buffer", 0}, {"byteOffset", 2 * vectors}, {"byteLength", index_bytes_.size()}, {"target", kElementArrayBuffer}}});
    (*document)["buffers"] = Json::array({{{"byteLength", 2 * vectors + index_bytes_.size()}}});
  }

 private:
  static void PutVector(const Eigen::Vector3f& vector, std::vector<uint8_t>* bytes) {
    for (int axis = 0; axis < 3; ++axis) Put(bytes, vector[axis]);
  }

  std::vector<uint8_t> position_bytes_, normal_bytes_, index_bytes_;
  size_t vertices_ = 0, indices_ = 0;
  Json accessors_ = Json::array(), meshes_ = Json::array();
};

Json ExtrasOf(const Building& building, const FileFrame& frame) {
  Json extras = {{"id", building.id}, {"roof", NameOf(building.roof)}, {"accepted", building.accepted}};
  for (const NamedMeasure& column : MeasuresOf(building, frame)) {
    if (std::isfinite(column.measure.value)) extras[column.name] = column.measure.value;
    if (std::isfinite(column.measure.sigma)) extras[column.name + "_sigma"] = column.measure.sigma;
  }
  if (std::isfinite(building.measures.wall_seen)) extras["wall_seen"] = Rounded(building.measures.wall_seen, 4);
  if (!building.note.empty()) extras["note"] = building.note;
  return extras;
}

std::vector<uint8_t> Packed(const Json& document, const std::vector<uint8_t>& binary, const std::filesystem::path& file) {
  std::string json = base::JsonText(document);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  constexpr uint64_t kHeaderBytes = 12, kChunkHeaderBytes = 8;
  const uint64_t total = kHeaderBytes + kChunkHeaderBytes + json.size() + (binary.empty() ? 0 : kChunkHeaderBytes + binary.size());
  if (total > UINT32_MAX) {
    throw base::InputError(file, "would have " + std::to_string(total >> 20U) + " MiB; the format ends at 4096 MiB",
                           "Turn it off with buildings.glb = false");
  }
  std::vector<uint8_t> bytes;
  bytes.reserve(static_cast<size_t>(total));
  Put(&bytes, kMagic);
  Put(&bytes, uint32_t{2});
  Put(&bytes, static_cast<uint32_t>(total));
  Put(&bytes, static_cast<uint32_t>(json.size()));
  Put(&bytes, kJsonChunk);
  surface::PutText(&bytes, json, json.size());
  if (binary.empty()) return bytes;
  Put(&bytes, static_cast<uint32_t>(binary.size()));
  Put(&bytes, kBinChunk);
  bytes.insert(bytes.end(), binary.begin(), binary.end());
  return bytes;
}

}  // namespace

void WriteGlb(const BuildingSet& set, const surface::MapFrame& map, const std::filesystem::path& file) {
  const FileFrame frame(set, map);
  GlbMeshes meshes;
  Json nodes = Json::array(), roots = Json::array();
  for (const Building& building : set.buildings) {
    std::vector<Eigen::Vector3d> position;
    for (const Eigen::Vector3d& vertex : building.lod22.vertex) {
      position.emplace_back(map.MapFromEnu(vertex) - map.offset());
      SKYQUILT_CHECK(position.back().allFinite(), "a building with a coordinate that is not finite");
    }
    const std::string name = "building " + std::to_string(building.id);
    Json node = {{"name", name}};
    if (const int mesh = meshes.Add(building.lod22, position, name); mesh >= 0) node["mesh"] = mesh;
    node["extras"] = ExtrasOf(building, frame);
    roots.push_back(nodes.size());
    nodes.push_back(std::move(node));
  }
  const Eigen::Vector3d& offset = map.offset();
  const Json place = {{"crs", frame.CrsName()},
                      {"offset", {offset.x(), offset.y(), offset.z()}},
                      {"verticalDatum", frame.VerticalName()},
                      {"metresPerUnit", frame.metric() && !map.georeferenced() ? Json(frame.scale())
                                        : frame.metric()                       ? Json(1.0)
                                                                               : Json(nullptr)}};
  Json scene = {{"extras", place}};
  if (!nodes.empty()) scene["nodes"] = roots;
  Json document;
  document["asset"] = {{"version", "2.0"}, {"generator", "Skyquilt"}, {"extras", place}};
  document["scene"] = 0;
  document["scenes"] = Json::array({scene});
  if (!nodes.empty()) document["nodes"] = nodes;
  meshes.AddTo(&document);
  const std::vector<uint8_t> bytes = Packed(document, meshes.Binary(), file);
  base::WriteFileAtomically(file, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

}  // namespace skyquilt::buildings
