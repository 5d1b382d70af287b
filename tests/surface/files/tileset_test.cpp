#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>
#include <set>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/geo/ecef.h"
#include "core/geo/geoid.h"
#include "surface/files/earth_place.h"
#include "surface/files/surface_files.h"
#include "tests/support/in_temporary_folder.h"
#include "tests/surface/files/sample_surface.h"

namespace skyquilt::surface {
namespace {

using Tileset = InTemporaryFolder;

using nlohmann::json;

constexpr FileSelection kOnlyTiles = {.glb = false, .obj = false, .ply = false, .cloud = false, .tiles = true};

void WriteTiles(const MapFrame& frame, const std::vector<TexturedTile>& tiles, const std::filesystem::path& folder) {
  SurfaceFiles files(frame, kOnlyTiles, kSampleTile_m, folder);
  for (const TexturedTile& tile : tiles) files.Add(tile);
  files.Close();
}

json ReadTileset(const std::filesystem::path& folder) {
  return base::ParseJson(base::ReadFile(folder / "tiles" / "tileset.json"));
}

template <typename Json>
Eigen::Matrix4d TransformOf(const Json& tile) {
  const auto values = tile["transform"].template get<std::vector<double>>();
  return Eigen::Map<const Eigen::Matrix4d>(values.data());  // both column-major
}

// The vertices of a content in the frame of its tile, as a viewer computes them: glTF's node, then y up to z up.
std::vector<Eigen::Vector3d> ContentPositions(const Glb& glb) {
  const auto t = glb.json["nodes"][0].value("translation", std::vector<double>{0.0, 0.0, 0.0});
  std::vector<Eigen::Vector3d> positions;
  for (const auto& p : glb.Accessor(glb.primitive(0)["attributes"]["POSITION"])) {
    positions.emplace_back(p[0] + t[0], -(p[2] + t[2]), p[1] + t[1]);
  }
  return positions;
}

struct Box {
  Eigen::Vector3d min, max;
  explicit Box(const json& tile) {
    const auto values = tile["boundingVolume"]["box"].get<std::vector<double>>();
    const Eigen::Map<const Eigen::Vector3d> middle(values.data());
    const Eigen::Vector3d half(values[3], values[7], values[11]);
    EXPECT_EQ(values.size(), 12U);
    EXPECT_GT(half.minCoeff(), 0.0);
    min = middle - half;
    max = middle + half;
  }
  bool Contains(const Eigen::Vector3d& x) const { return (x.array() >= min.array() - 1e-6).all() && (x.array() <= max.array() + 1e-6).all(); }
};

void Visit(const json& tile, const std::function<void(const json&)>& action) {
  action(tile);
  if (!tile.contains("children")) return;
  for (const json& child : tile["children"]) Visit(child, action);
}

TEST_F(Tileset, VerticesStandWhereTheyAreOnEarth) {
  for (const geo::Geodetic& origin : DifficultOrigins()) {
    const TemporaryFolder folder;
    const TexturedTile tile = SampleTile({0, 30, -20});  // 2 km from the origin
    WriteTiles(MapFrame(SampleInfo(origin)), {tile}, folder.path());
    const Eigen::Matrix4d ecef_from_tile = TransformOf(ReadTileset(folder.path())["root"]);
    const Glb glb(folder.path() / "tiles" / "0_30_-20.glb");
    const std::vector<Eigen::Vector3d> positions = ContentPositions(glb);
    const auto indices = glb.Accessor(glb.primitive(0)["indices"]);
    const geo::EnuFrame frame(origin);
    for (size_t corner = 0; corner < indices.size(); ++corner) {
      const Eigen::Vector3d expected = geo::EcefFromGeodetic(frame.GeodeticFromEnu(tile.position[tile.triangle[corner / 3][corner % 3]]));
      const Eigen::Vector3d moved = (ecef_from_tile * positions.at(static_cast<size_t>(indices[corner][0])).homogeneous()).head<3>();
      EXPECT_LT((moved - expected).norm(), 0.01) << origin.latitude_deg << " " << origin.longitude_deg;
    }
  }
}

// EPSG:4978 has heights above the ellipsoid only, whatever the survey and products.vertical have.
TEST_F(Tileset, HeightsAboveTheGeoidAreRaisedToTheEllipsoid) {
  for (const geo::Geodetic& origin : DifficultOrigins()) {
    const TemporaryFolder folder;
    const TexturedTile tile = SampleTile({0, 30, -20});  // 2 km from the origin
    scene::SceneInfo info = SampleInfo(origin);
    info.height_reference = geo::HeightReference::kEgm96;
    WriteTiles(MapFrame(info, geo::Vertical::kEgm96), {tile}, folder.path());
    auto tileset = base::ParseOrderedJson(base::ReadFile(folder / "tiles/tileset.json"));
    EXPECT_EQ(tileset["asset"]["extras"]["verticalDatum"], "WGS84 ellipsoid (EPSG:4979)");
    const Eigen::Matrix4d ecef_from_tile = TransformOf(tileset["root"]);
    const Glb glb(folder.path() / "tiles" / "0_30_-20.glb");
    const std::vector<Eigen::Vector3d> positions = ContentPositions(glb);
    const auto indices = glb.Accessor(glb.primitive(0)["indices"]);
    const geo::EnuFrame frame(origin);
    ASSERT_TRUE(StandInSurvey(&tileset));
    const Eigen::Matrix4d survey_from_tile = TransformOf(tileset["root"]);
    for (size_t corner = 0; corner < indices.size(); ++corner) {
      geo::Geodetic place = frame.GeodeticFromEnu(tile.position[tile.triangle[corner / 3][corner % 3]]);
      const Eigen::Vector3d in_survey = geo::EcefFromGeodetic(place);
      place.height_m += geo::Egm96Undulation(place.latitude_deg, place.longitude_deg);
      const Eigen::Vector4d position = positions.at(static_cast<size_t>(indices[corner][0])).homogeneous();
      EXPECT_LT(((ecef_from_tile * position).head<3>() - geo::EcefFromGeodetic(place)).norm(), 0.01) << origin.latitude_deg;
      // Beside the survey, the geoid's slope over 2 km is left, 0.6 m at most.
      EXPECT_LT(((survey_from_tile * position).head<3>() - in_survey).norm(), 0.6) << origin.latitude_deg;
    }
  }
}

TEST_F(Tileset, OfTheEllipsoidStandsInItsSurveyAlready) {
  WriteTiles(MapFrame(SampleInfo({60.0, 24.9, 30.0}), geo::Vertical::kEgm96), {SampleTile({0, 0, 0})}, folder_.path());
  auto tileset = base::ParseOrderedJson(base::ReadFile(folder_ / "tiles/tileset.json"));
  const auto before = tileset;
  EXPECT_FALSE(StandInSurvey(&tileset));
  EXPECT_EQ(tileset, before);
  nlohmann::ordered_json empty = nlohmann::ordered_json::object();
  EXPECT_FALSE(StandInSurvey(&empty));
}

TEST_F(Tileset, ContentsStandUpright) {
  for (const geo::Geodetic& origin : DifficultOrigins()) {
    const TemporaryFolder folder;
    TexturedTile tile = SampleTile({0, 0, 0});
    for (Eigen::Vector3f& normal : tile.normal) normal = Eigen::Vector3f::UnitZ();
    WriteTiles(MapFrame(SampleInfo(origin)), {tile}, folder.path());
    const Eigen::Matrix3d rotation = TransformOf(ReadTileset(folder.path())["root"]).topLeftCorner<3, 3>();
    const Glb glb(folder.path() / "tiles" / "0_0_0.glb");
    const Eigen::Vector3d up =
        geo::EcefFromGeodetic({origin.latitude_deg, origin.longitude_deg, origin.height_m + 1.0}) - geo::EcefFromGeodetic(origin);
    for (const auto& n : glb.Accessor(glb.primitive(0)["attributes"]["NORMAL"])) {
      EXPECT_LT((rotation * Eigen::Vector3d(n[0], -n[2], n[1]) - up).norm(), 1e-6);
    }
  }
}

TEST_F(Tileset, IsAQuadtreeOfAllTilesWithGrowingBoxesAndErrors) {
  const std::vector<TexturedTile> tiles = SamplePyramid();
  WriteTiles(MapFrame(SampleInfo({60.0, 24.9, 30.0})), tiles, folder_.path());
  const json tileset = ReadTileset(folder_.path());
  EXPECT_EQ(tileset["asset"]["version"], "1.1");
  EXPECT_EQ(tileset["root"]["refine"], "REPLACE");
  EXPECT_GE(tileset["geometricError"].get<double>(), tileset["root"]["geometricError"].get<double>());
  EXPECT_FALSE(tileset["root"].contains("content")) << "several tiles are at the top";
  // A root without content must be refined wherever the survey can be seen at all.
  EXPECT_GE(tileset["root"]["geometricError"].get<double>(), 256.0);
  std::set<std::string> contents;
  Visit(tileset["root"], [&](const json& tile) {
    const Box box(tile);
    if (tile.contains("content")) {
      const std::string uri = tile["content"]["uri"];
      EXPECT_TRUE(contents.insert(uri).second) << uri;
      for (const Eigen::Vector3d& position : ContentPositions(Glb(folder_.path() / "tiles" / uri))) EXPECT_TRUE(box.Contains(position)) << uri;
    }
    if (!tile.contains("children")) {
      EXPECT_EQ(tile["geometricError"], 0.0);
      return;
    }
    for (const json& child : tile["children"]) {
      EXPECT_FALSE(child.contains("transform"));
      EXPECT_TRUE(box.Contains(Box(child).min) && box.Contains(Box(child).max));
      EXPECT_LT(child["geometricError"].get<double>(), tile["geometricError"].get<double>());
      if (!tile.contains("content")) continue;
      int level = 0, column = 0, row = 0;
      ASSERT_EQ(std::sscanf(child["content"]["uri"].get<std::string>().c_str(), "%d_%d_%d", &level, &column, &row), 3);
      EXPECT_EQ((TileId{level, column, row}.Parent().Name() + ".glb"), tile["content"]["uri"]);
    }
  });
  EXPECT_EQ(contents.size(), tiles.size());
}

TEST_F(Tileset, BoxesAreTight) {
  const TexturedTile tile = SampleTile({0, -3, 2});
  WriteTiles(MapFrame(SampleInfo({60.0, 24.9, 30.0})), {tile}, folder_.path());
  const Box box(ReadTileset(folder_.path())["root"]);
  Eigen::Vector3d min = tile.position[0], max = tile.position[0];
  for (const Eigen::Vector3d& position : tile.position) {
    min = min.cwiseMin(position);
    max = max.cwiseMax(position);
  }
  EXPECT_LT((box.min - min).norm(), 1e-4);
  EXPECT_LT((box.max - max).norm(), 1e-4);
}

TEST_F(Tileset, ErrorsFollowTheTextureWhereTheGroundIsFlat) {
  TexturedTile coarse = SampleTile({1, 0, 0});
  coarse.error_m = 0.0;
  for (Eigen::Vector3d& position : coarse.position) position.z() = 0.0;
  WriteTiles(MapFrame(SampleInfo({60.0, 24.9, 30.0})), {SampleTile({0, 0, 0}), coarse}, folder_.path());
  // 128 m in 64 x 48 texels: their middle side is 2.3 m.
  EXPECT_NEAR(ReadTileset(folder_.path())["root"]["geometricError"].get<double>(), 8.0 * 128.0 / std::sqrt(64.0 * 48.0), 0.01);
}

TEST_F(Tileset, TilesBelowAMissingOneHangOnWhatIsAbove) {
  WriteTiles(MapFrame(SampleInfo({60.0, 24.9, 30.0})), {SampleTile({2, 0, 0}), SampleTile({0, 1, 1}), SampleTile({1, 1, 1})}, folder_.path());
  const json root = ReadTileset(folder_.path())["root"];
  EXPECT_EQ(root["content"]["uri"], "2_0_0.glb");
  ASSERT_EQ(root["children"].size(), 2U);
  EXPECT_EQ(root["children"][0]["content"]["uri"], "0_1_1.glb");
}

TEST_F(Tileset, DoesNotDependOnTheOrderOfTiles) {
  const TemporaryFolder one, other;
  std::vector<TexturedTile> tiles = SamplePyramid();
  const MapFrame frame(SampleInfo({60.0, 24.9, 30.0}));
  WriteTiles(frame, tiles, one.path());
  std::reverse(tiles.begin(), tiles.end());
  WriteTiles(frame, tiles, other.path());
  EXPECT_EQ(NamesIn(one / "tiles"), NamesIn(other / "tiles"));
  for (const std::string& name : NamesIn(one / "tiles")) {
    EXPECT_EQ(base::ReadFile(one.path() / "tiles" / name), base::ReadFile(other.path() / "tiles" / name)) << name;
  }
}

TEST_F(Tileset, WithoutGeoReferenceThereIsNoTransform) {
  WriteTiles(MapFrame(SampleInfo({0.0, 0.0, 0.0}, false)), {SampleTile({0, 0, 0})}, folder_.path());
  const json tileset = ReadTileset(folder_.path());
  EXPECT_FALSE(tileset["root"].contains("transform"));
  EXPECT_NE(tileset["asset"]["extras"]["crs"].get<std::string>().find("local frame"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::surface
