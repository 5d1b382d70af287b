// buildings.dxf: AutoCAD R12 (AC1009), the version that every program reads.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "buildings/files/building_files.h"
#include "buildings/files/file_frame.h"
#include "core/base/file.h"

namespace skyquilt::buildings {
namespace {

constexpr const char* kRoofs = "ROOFS";
constexpr const char* kWalls = "WALLS";
constexpr const char* kGround = "GROUND";
constexpr const char* kFootprints = "FOOTPRINTS";
// Colours of AutoCAD's index: red, light grey, dark grey, green.
constexpr std::array<std::pair<const char*, int>, 4> kLayers = {{{kRoofs, 1}, {kWalls, 9}, {kGround, 8}, {kFootprints, 3}}};

// Groups: a code on one line, its value on the next.
class DxfText {
 public:
  void Add(int code, const std::string& value) { text_ += std::to_string(code) + "\r\n" + value + "\r\n"; }
  void Add(int code, int value) { Add(code, std::to_string(value)); }
  // In groups first, first + 10 and first + 20.
  void Add(int first, const Eigen::Vector3d& point) {
    for (int axis = 0; axis < 3; ++axis) Add(first + 10 * axis, NumberText(point[axis]));
  }
  void Begin(const std::string& type, const std::string& name) {
    Add(0, type);
    Add(2, name);
  }
  void Entity(const std::string& type, const char* layer) {
    Add(0, type);
    Add(8, layer);
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

void AddTables(DxfText* dxf) {
  dxf->Begin("SECTION", "TABLES");
  dxf->Begin("TABLE", "LTYPE");
  dxf->Add(70, 1);
  dxf->Begin("LTYPE", "CONTINUOUS");
  dxf->Add(70, 0);
  dxf->Add(3, "Solid line");
  dxf->Add(72, 65);
  dxf->Add(73, 0);
  dxf->Add(40, "0.0");
  dxf->Add(0, "ENDTAB");
  dxf->Begin("TABLE", "LAYER");
  dxf->Add(70, static_cast<int>(kLayers.size()));
  for (const auto& [name, colour] : kLayers) {
    dxf->Begin("LAYER", name);
    dxf->Add(70, 0);
    dxf->Add(62, colour);
    dxf->Add(6, "CONTINUOUS");
  }
  dxf->Add(0, "ENDTAB");
  dxf->Add(0, "ENDSEC");
}

// Layer of an edge: what is nearest to a roof first.
const char* LayerOf(FaceKind kind, const char* before) {
  if (kind == FaceKind::kRoof || before == kRoofs) return kRoofs;
  if (kind == FaceKind::kGround || before == kGround) return kGround;
  return kWalls;
}

void AddSolid(const Solid& solid, const FileFrame& frame, DxfText* dxf) {
  // Two faces share an edge; it is drawn once.
  std::map<std::pair<uint32_t, uint32_t>, const char*> edges;
  const auto add = [&](const std::vector<uint32_t>& ring, FaceKind kind) {
    for (size_t i = 0; i < ring.size(); ++i) {
      const auto edge = std::minmax(ring[i], ring[(i + 1) % ring.size()]);
      const char*& layer = edges.emplace(edge, kWalls).first->second;
      layer = LayerOf(kind, layer);
    }
  };
  for (const Face& face : solid.face) {
    add(face.outer, face.kind);
    for (const std::vector<uint32_t>& hole : face.holes) add(hole, face.kind);
  }
  const std::vector<Eigen::Vector3d> position = frame.PositionsOf(solid);
  for (const auto& [edge, layer] : edges) {
    dxf->Entity("LINE", layer);
    dxf->Add(10, position[edge.first]);
    dxf->Add(11, position[edge.second]);
  }
}

void AddOutline(const std::vector<Eigen::Vector2d>& ring, double ground_z, const FileFrame& frame, DxfText* dxf) {
  if (ring.empty()) return;
  std::vector<Eigen::Vector3d> points;
  points.reserve(ring.size());
  for (const Eigen::Vector2d& point : ring) points.push_back(frame.PositionOf({point.x(), point.y(), ground_z}));
  // A flat polyline: its height is that of the entity.
  const double height = points.front().z();
  dxf->Entity("POLYLINE", kFootprints);
  dxf->Add(66, 1);  // vertices follow
  dxf->Add(10, Eigen::Vector3d(0.0, 0.0, height));
  dxf->Add(70, 1);  // closed
  for (const Eigen::Vector3d& point : points) {
    dxf->Entity("VERTEX", kFootprints);
    dxf->Add(10, Eigen::Vector3d(point.x(), point.y(), height));
  }
  dxf->Entity("SEQEND", kFootprints);
}

void AddHeader(const BuildingSet& set, const FileFrame& frame, DxfText* dxf) {
  dxf->Begin("SECTION", "HEADER");
  dxf->Add(9, "$ACADVER");
  dxf->Add(1, "AC1009");
  Eigen::Vector3d min = Eigen::Vector3d::Constant(HUGE_VAL), max = -min;
  for (const Building& building : set.buildings) {
    const auto include = [&](const Eigen::Vector3d& position) {
      min = min.cwiseMin(position);
      max = max.cwiseMax(position);
    };
    for (const Eigen::Vector3d& position : frame.PositionsOf(building.lod22)) include(position);
    for (const Eigen::Vector2d& point : building.footprint.outer) include(frame.PositionOf({point.x(), point.y(), building.shape.ground_z}));
  }
  if ((min.array() <= max.array()).all()) {
    dxf->Add(9, "$EXTMIN");
    dxf->Add(10, min);
    dxf->Add(9, "$EXTMAX");
    dxf->Add(10, max);
  }
  dxf->Add(0, "ENDSEC");
}

}  // namespace

void WriteDxf(const BuildingSet& set, const surface::MapFrame& map, const std::filesystem::path& file) {
  const FileFrame frame(set, map);
  DxfText dxf;
  AddHeader(set, frame, &dxf);
  AddTables(&dxf);
  dxf.Begin("SECTION", "ENTITIES");
  for (const Building& building : set.buildings) {
    AddSolid(building.lod22, frame, &dxf);
    AddOutline(building.footprint.outer, building.shape.ground_z, frame, &dxf);
    for (const std::vector<Eigen::Vector2d>& hole : building.footprint.holes) AddOutline(hole, building.shape.ground_z, frame, &dxf);
  }
  dxf.Add(0, "ENDSEC");
  dxf.Add(0, "EOF");
  base::WriteFileAtomically(file, dxf.text());
}

}  // namespace skyquilt::buildings
