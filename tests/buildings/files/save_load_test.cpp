#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "buildings/files/building_files.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "tests/buildings/files/sample_set.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::buildings {
namespace {

using Json = nlohmann::json;

// Equal bit by bit, but for the kind of NaN.
bool Same(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) || (a == b && std::signbit(a) == std::signbit(b));
}
bool Same(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) { return Same(x, y); });
}
bool Same(const Polygon& a, const Polygon& b) {
  return a.outer == b.outer && a.holes == b.holes;
}
bool Same(const Solid& a, const Solid& b) {
  return a.vertex == b.vertex && a.face.size() == b.face.size() &&
         std::equal(a.face.begin(), a.face.end(), b.face.begin(),
                    [](const Face& x, const Face& y) { return x.kind == y.kind && x.outer == y.outer && x.holes == y.holes; });
}
bool Same(const Part& a, const Part& b) {
  return a.u0 == b.u0 && a.u1 == b.u1 && a.v0 == b.v0 && a.v1 == b.v1 && a.roof == b.roof && a.along_u == b.along_u && Same(a.eave_z, b.eave_z) &&
         Same(a.ridge_z, b.ridge_z) && a.joins == b.joins;
}
bool Same(const Measure& a, const Measure& b) {
  return Same(a.value, b.value) && Same(a.sigma, b.sigma);
}
bool Same(const Measures& a, const Measures& b) {
  return Same(a.ground_m, b.ground_m) && Same(a.eave_m, b.eave_m) && Same(a.ridge_m, b.ridge_m) && Same(a.height_m, b.height_m) &&
         Same(a.length_m, b.length_m) && Same(a.width_m, b.width_m) && Same(a.yaw_deg, b.yaw_deg) && Same(a.footprint_m2, b.footprint_m2) &&
         Same(a.roof_m2, b.roof_m2) && Same(a.volume_m3, b.volume_m3) && Same(a.pitch_deg, b.pitch_deg) && Same(a.wall_seen, b.wall_seen);
}
bool Same(const Shape& a, const Shape& b) {
  return a.origin == b.origin && Same(a.yaw_rad, b.yaw_rad) && Same(a.u, b.u) && Same(a.v, b.v) && Same(a.ground_z, b.ground_z) &&
         a.parts.size() == b.parts.size() &&
         std::equal(a.parts.begin(), a.parts.end(), b.parts.begin(), [](const Part& x, const Part& y) { return Same(x, y); });
}
bool Same(const Building& a, const Building& b) {
  return a.id == b.id && Same(a.shape, b.shape) && a.roof == b.roof && Same(a.footprint, b.footprint) && a.roofprint.size() == b.roofprint.size() &&
         std::equal(a.roofprint.begin(), a.roofprint.end(), b.roofprint.begin(), [](const Polygon& x, const Polygon& y) { return Same(x, y); }) &&
         Same(a.overhang_m, b.overhang_m) && a.overhang_measured == b.overhang_measured && Same(a.measures, b.measures) && Same(a.lod12, b.lod12) &&
         Same(a.lod22, b.lod22) && a.lod22_valid == b.lod22_valid && a.accepted == b.accepted && Same(a.share_within, b.share_within) &&
         Same(a.residual_m, b.residual_m) && a.roof_points == b.roof_points && a.wall_points == b.wall_points &&
         a.walls_from_points == b.walls_from_points && a.given == b.given && a.given_id == b.given_id && a.note == b.note;
}
bool Same(const BuildingSet& a, const BuildingSet& b) {
  return a.metric == b.metric && Same(a.scale, b.scale) && a.scale_source == b.scale_source && Same(a.gsd_m, b.gsd_m) &&
         a.buildings.size() == b.buildings.size() &&
         std::equal(a.buildings.begin(), a.buildings.end(), b.buildings.begin(), [](const Building& x, const Building& y) { return Same(x, y); });
}

TEST(SaveBuildings, SamplesComeBackExactly) {
  const TemporaryFolder folder;
  const BuildingSet set = SampleSet();
  SaveBuildings(set, SampleFrame(), folder / "buildings.json");
  EXPECT_TRUE(Same(LoadBuildings(folder / "buildings.json"), set));
  BuildingSet other = set;
  other.buildings[2].measures.width_m.sigma += 1e-12;
  EXPECT_FALSE(Same(LoadBuildings(folder / "buildings.json"), other)) << "the comparison sees everything";
  EXPECT_TRUE(LoadBuildings(folder / "buildings.json").buildings[3].measures.pitch_deg.value != 0.0);
  const BuildingSet none;
  SaveBuildings(none, SampleFrame(false), folder / "none.json");
  EXPECT_TRUE(Same(LoadBuildings(folder / "none.json"), none));
}

double AnyNumber() {
  return *rc::gen::oneOf(rc::gen::arbitrary<double>(), rc::gen::map(rc::gen::inRange(-1000000, 1000000), [](int i) { return i / 3000.0; }));
}
double AnyMeasure() {
  return *rc::gen::inRange(0, 4) == 0 ? kUnknown : AnyNumber();
}
bool AnyFlag() {
  return *rc::gen::arbitrary<bool>();
}
RoofKind AnyRoof() {
  return *rc::gen::element(RoofKind::kFlat, RoofKind::kGable, RoofKind::kHip, RoofKind::kOther);
}
std::vector<Eigen::Vector2d> AnyRing() {
  std::vector<Eigen::Vector2d> ring;
  for (int i = *rc::gen::inRange(0, 6); i > 0; --i) ring.emplace_back(AnyNumber(), AnyNumber());
  return ring;
}
Polygon AnyPolygon() {
  Polygon polygon{.outer = AnyRing(), .holes = {}};
  for (int i = *rc::gen::inRange(0, 3); i > 0; --i) polygon.holes.push_back(AnyRing());
  return polygon;
}
Solid AnySolid() {
  Solid solid;
  const int vertices = *rc::gen::inRange(0, 9);
  for (int i = 0; i < vertices; ++i) solid.vertex.emplace_back(AnyNumber(), AnyNumber(), AnyNumber());
  for (int i = vertices == 0 ? 0 : *rc::gen::inRange(0, 5); i > 0; --i) {
    const auto ring = [&] {
      std::vector<uint32_t> indices;
      for (int n = *rc::gen::inRange(3, 6); n > 0; --n) indices.push_back(static_cast<uint32_t>(*rc::gen::inRange(0, vertices)));
      return indices;
    };
    Face face{.kind = *rc::gen::element(FaceKind::kGround, FaceKind::kWall, FaceKind::kRoof), .outer = ring(), .holes = {}};
    if (AnyFlag()) face.holes.push_back(ring());
    solid.face.push_back(face);
  }
  return solid;
}
Building AnyBuilding(int id) {
  Building b;
  b.id = id;
  b.shape.origin = {AnyNumber(), AnyNumber()};
  b.shape.yaw_rad = AnyNumber();
  b.shape.ground_z = AnyNumber();
  for (std::vector<double>* lines : {&b.shape.u, &b.shape.v}) {
    for (int i = *rc::gen::inRange(2, 5); i > 0; --i) lines->push_back(AnyNumber());
  }
  const int parts = *rc::gen::inRange(1, 4);
  for (int i = 0; i < parts; ++i) {
    Part& part = b.shape.parts.emplace_back();
    part.u1 = *rc::gen::inRange(1, static_cast<int>(b.shape.u.size()));
    part.v1 = *rc::gen::inRange(1, static_cast<int>(b.shape.v.size()));
    part.u0 = part.u1 - 1;
    part.roof = AnyRoof();
    part.along_u = AnyFlag();
    part.eave_z = AnyNumber();
    part.ridge_z = AnyNumber();
    part.joins = *rc::gen::inRange(-1, parts);
  }
  b.roof = AnyRoof();
  b.footprint = AnyPolygon();
  b.roofprint = {AnyPolygon(), AnyPolygon()};
  b.overhang_m = AnyNumber();
  b.overhang_measured = AnyFlag();
  Measures& m = b.measures;
  for (Measure* one : {&m.ground_m, &m.eave_m, &m.ridge_m, &m.height_m, &m.length_m, &m.width_m, &m.yaw_deg, &m.footprint_m2, &m.roof_m2,
                       &m.volume_m3, &m.pitch_deg}) {
    *one = {.value = AnyMeasure(), .sigma = AnyMeasure()};
  }
  m.wall_seen = AnyMeasure();
  b.lod12 = AnySolid();
  b.lod22 = AnySolid();
  b.lod22_valid = AnyFlag();
  b.accepted = AnyFlag();
  b.share_within = AnyMeasure();
  b.residual_m = AnyMeasure();
  b.roof_points = *rc::gen::inRange<int64_t>(0, std::numeric_limits<int64_t>::max());
  b.wall_points = *rc::gen::inRange<int64_t>(0, 1000);
  b.walls_from_points = AnyFlag();
  b.given = AnyFlag();
  // Any bytes that are text.
  b.given_id = *rc::gen::container<std::string>(rc::gen::inRange<char>(0, 127));
  b.note = *rc::gen::element<std::string>("", "ü \"x\"\n\\", "⌂ 家", "\t,;\r\n");
  return b;
}

RC_GTEST_PROP(SaveBuildings, AnySetComesBackExactly, ()) {
  const TemporaryFolder folder;
  BuildingSet set;
  set.metric = AnyFlag();
  set.scale = *rc::gen::element(1.0, 1.0 / 3.0, 5e-300, 1e300);
  set.scale_source = *rc::gen::element<std::string>("", "scale bar");
  set.gsd_m = AnyMeasure();
  for (int id = *rc::gen::inRange(0, 3); id > 0; --id) set.buildings.push_back(AnyBuilding(id));
  SaveBuildings(set, SampleFrame(AnyFlag()), folder / "buildings.json");
  RC_ASSERT(Same(LoadBuildings(folder / "buildings.json"), set));
}

TEST(SaveBuildings, SaysWhereItIs) {
  const TemporaryFolder folder;
  BuildingSet set = SampleSet();
  SaveBuildings(set, SampleFrame(), folder / "a.json");
  const Json placed = Json::parse(base::ReadFile(folder / "a.json"));
  EXPECT_EQ(placed["format"], "skyquilt buildings");
  EXPECT_EQ(placed["version"], 1);
  EXPECT_EQ(placed["crs"], "EPSG:32632");
  EXPECT_TRUE(placed["buildings"][3]["measures"]["pitch_deg"][0].is_null());
  EXPECT_EQ(placed["buildings"][0]["lod22"]["face"].size(), set.buildings[0].lod22.face.size());
  set.metric = false;
  SaveBuildings(set, SampleFrame(false), folder / "b.json");
  EXPECT_EQ(Json::parse(base::ReadFile(folder / "b.json"))["crs"], "local frame, unknown scale");
}

TEST(LoadBuildings, RefusesWhatIsDamaged) {
  const TemporaryFolder folder;
  SaveBuildings(SampleSet(), SampleFrame(), folder / "good.json");
  const std::string good = base::ReadFile(folder / "good.json");
  const auto error_of = [&](const std::string& content) {
    base::WriteFileAtomically(folder / "bad.json", content);
    return InputErrorOf([&] { LoadBuildings(folder / "bad.json"); });
  };
  const auto error_after = [&](const std::function<void(Json&)>& change) {
    Json json = Json::parse(good);
    change(json);
    return error_of(base::JsonText(json));
  };
  EXPECT_EQ(error_after([](Json&) {}), "");
  EXPECT_NE(InputErrorOf([&] { LoadBuildings(folder / "none.json"); }).find("none.json: cannot open"), std::string::npos);
  for (size_t length : {size_t{0}, size_t{1}, good.size() / 2, good.size() - 3}) {
    EXPECT_NE(error_of(good.substr(0, length)).find("is damaged"), std::string::npos) << length;
  }
  EXPECT_NE(error_of("[1,2]").find("format is missing"), std::string::npos);
  EXPECT_NE(error_after([](Json& j) { j["format"] = "skyquilt scene"; }).find("is no list of buildings"), std::string::npos);
  EXPECT_NE(error_after([](Json& j) { j["version"] = 2; }).find("is of version 2; this program reads version 1"), std::string::npos);

  const std::vector<std::pair<std::string, std::function<void(Json&)>>> changes = {
      {"gsd_m is missing", [](Json& j) { j.erase("gsd_m"); }},
      {"scale is not positive", [](Json& j) { j["scale"] = 0; }},
      {"buildings is no list", [](Json& j) { j["buildings"] = 3; }},
      {"buildings[1] has the id of another building", [](Json& j) { j["buildings"][1]["id"] = 1; }},
      {"buildings[0].id is out of range", [](Json& j) { j["buildings"][0]["id"] = 0; }},
      {"buildings[0].id is no whole number", [](Json& j) { j["buildings"][0]["id"] = 1.5; }},
      {"buildings[0].roof_points is out of range", [](Json& j) { j["buildings"][0]["roof_points"] = uint64_t{1} << 63U; }},
      {"buildings[2].roof is no kind of roof", [](Json& j) { j["buildings"][2]["roof"] = "mansard"; }},
      {"buildings[2].accepted is neither true nor false", [](Json& j) { j["buildings"][2]["accepted"] = 1; }},
      {"buildings[2].note is no text", [](Json& j) { j["buildings"][2]["note"] = nullptr; }},
      {"buildings[0].measures.eave_m has 1 values instead of 2", [](Json& j) { j["buildings"][0]["measures"]["eave_m"] = {1.0}; }},
      {"buildings[0].measures.eave_m[1] is no number", [](Json& j) { j["buildings"][0]["measures"]["eave_m"][1] = "0.1"; }},
      {"buildings[0].shape.parts[0].u1 is out of range", [](Json& j) { j["buildings"][0]["shape"]["parts"][0]["u1"] = 99; }},
      {"buildings[0].shape.parts[0] has no walls around it", [](Json& j) { j["buildings"][0]["shape"]["parts"][0]["u0"] = 1; }},
      {"buildings[0].shape.parts[0].joins is out of range", [](Json& j) { j["buildings"][0]["shape"]["parts"][0]["joins"] = 1; }},
      {"buildings[0].footprint.outer[0] has 3 values instead of 2",
       [](Json& j) {
         j["buildings"][0]["footprint"]["outer"][0] = {1, 2, 3};
       }},
      {"buildings[0].lod22.vertex[4][2] is no number", [](Json& j) { j["buildings"][0]["lod22"]["vertex"][4][2] = nullptr; }},
      {"buildings[0].lod22.face[0].outer[0] is out of range", [](Json& j) { j["buildings"][0]["lod22"]["face"][0]["outer"][0] = 4000; }},
      {"buildings[0].lod22.face[0].outer has fewer than three corners",
       [](Json& j) {
         j["buildings"][0]["lod22"]["face"][0]["outer"] = {0, 1};
       }},
      {"buildings[0].lod22.face[1].kind is no kind of face", [](Json& j) { j["buildings"][0]["lod22"]["face"][1]["kind"] = "door"; }},
  };
  for (const auto& [finding, change] : changes) {
    const std::string error = error_after(change);
    EXPECT_NE(error.find("bad.json: is damaged: " + finding), std::string::npos) << finding << " / " << error;
  }
}

}  // namespace
}  // namespace skyquilt::buildings
