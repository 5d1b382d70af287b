#include "surface/files/surface_files.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "surface/files/file_writer.h"
#include "tests/support/error_of.h"
#include "tests/support/limited_file_size.h"
#include "tests/surface/files/sample_surface.h"

namespace skyquilt::surface {
namespace {

using SurfaceFilesTest = InToronto;

using Names = std::vector<std::string>;

void WriteAll(const MapFrame& frame, const std::filesystem::path& folder, std::vector<WrittenFile>* table = nullptr) {
  SurfaceFiles files(frame, {}, kSampleTile_m, folder);
  for (const TexturedTile& tile : SamplePyramid()) files.Add(tile);
  files.AddPoints(SamplePoints(500));
  const std::vector<WrittenFile> rows = files.Close();
  if (table != nullptr) *table = rows;
}

TEST_F(SurfaceFilesTest, TableTellsWhatWasWritten) {
  std::vector<WrittenFile> table;
  WriteAll(TorontoFrame(), folder_.path(), &table);
  ASSERT_EQ(table.size(), 7U);
  int64_t bytes = 0;
  for (const WrittenFile& row : table) {
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / row.file)) << row.file;
    EXPECT_EQ(row.vertical, "WGS84 ellipsoid (EPSG:4979)");
    bytes += row.bytes;
  }
  int64_t on_disk = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path())) {
    if (entry.is_regular_file()) on_disk += static_cast<int64_t>(entry.file_size());
  }
  EXPECT_EQ(bytes, on_disk);
  EXPECT_EQ(table[0].file, "mesh.glb");
  EXPECT_EQ(table[0].crs, "EPSG:32617 minus offset");
  EXPECT_EQ(table[0].detail, "128 triangles, 4 textures");
  EXPECT_EQ(table[3].crs, "EPSG:32617");
  EXPECT_EQ(table[3].detail, "500 points");
  EXPECT_EQ(table[5].file, "tiles/tileset.json");
  EXPECT_EQ(table[5].crs, "EPSG:4978");
  EXPECT_EQ(table[5].detail, "10 tiles in 3 levels");
}

TEST_F(SurfaceFilesTest, SameInputGivesTheSameBytes) {
  const TemporaryFolder one, other;
  const MapFrame frame = TorontoFrame();
  WriteAll(frame, one.path());
  WriteAll(frame, other.path());
  for (const std::string& name : NamesIn(one.path())) {
    if (name == "tiles") continue;
    EXPECT_EQ(base::ReadFile(one / name), base::ReadFile(other / name)) << name;
  }
}

TEST_F(SurfaceFilesTest, LeaveNothingWithoutClose) {
  {
    SurfaceFiles files(frame_, {}, kSampleTile_m, folder_.path(), 100);
    for (const TexturedTile& tile : SamplePyramid()) files.Add(tile);
    files.AddPoints(SamplePoints(500));
    for (const std::string& name : NamesIn(folder_.path())) EXPECT_TRUE(name.ends_with(".partial")) << name;
  }
  EXPECT_EQ(NamesIn(folder_.path()), Names{});
}

TEST_F(SurfaceFilesTest, AnOldSurfaceStaysUntilTheNewOneIsComplete) {
  WriteAll(frame_, folder_.path());
  const Names before = NamesIn(folder_.path());
  const std::string old_mesh = base::ReadFile(folder_ / "mesh.glb");
  {
    SurfaceFiles files(frame_, {}, kSampleTile_m, folder_.path());
    files.Add(SampleTile({0, 7, 7}));
  }
  EXPECT_EQ(NamesIn(folder_.path()), before);
  EXPECT_EQ(base::ReadFile(folder_ / "mesh.glb"), old_mesh);
}

TEST_F(SurfaceFilesTest, ANewSurfaceReplacesAllOfTheOldOne) {
  {
    SurfaceFiles files(frame_, {}, kSampleTile_m, folder_.path(), 100);
    for (const TexturedTile& tile : SamplePyramid()) files.Add(tile);
    files.AddPoints(SamplePoints(500));
    files.Close();
  }
  // Of a process that was killed, and of other parts of the program.
  std::filesystem::create_directory(folder_ / "tiles.partial");
  for (const char* name : {"mesh.glb.bin.partial", "mesh_0_9_9.jpg.partial", "dtm.tif", "mesh_notes.jpg", "cloud_of_mine.las"}) {
    std::ofstream(folder_ / name) << "x";
  }
  {
    SurfaceFiles files(frame_, {.glb = true, .obj = true, .ply = false, .cloud = false, .tiles = true}, kSampleTile_m, folder_.path());
    files.Add(SampleTile({0, 7, 7}));
    files.Close();
  }
  EXPECT_EQ(NamesIn(folder_.path()), (Names{"cloud_of_mine.las", "dtm.tif", "georeference.json", "mesh.glb", "mesh.mtl", "mesh.obj", "mesh_0_7_7.jpg",
                                            "mesh_notes.jpg", "offset.txt", "tiles"}));
  EXPECT_EQ(NamesIn(folder_ / "tiles"), (Names{"0_7_7.glb", "tileset.json"}));
}

TEST_F(SurfaceFilesTest, AnEmptySurfaceHasOnlyItsGeoReference) {
  const MapFrame frame(SampleInfo({43.64, -79.39, 100.0}, false));
  SurfaceFiles files(frame, {}, kSampleTile_m, folder_.path());
  files.Add(TexturedTile());
  files.AddPoints({});
  EXPECT_TRUE(files.Close().empty());
  EXPECT_EQ(NamesIn(folder_.path()), Names{"georeference.json"});
}

TEST_F(SurfaceFilesTest, OnlyWhatIsSelectedIsWritten) {
  SurfaceFiles files(frame_, {.glb = false, .obj = false, .ply = true, .cloud = false, .tiles = false}, kSampleTile_m, folder_.path());
  files.Add(SampleTile({0, 0, 0}));
  files.AddPoints(SamplePoints(5));
  files.Close();
  EXPECT_EQ(NamesIn(folder_.path()), (Names{"georeference.json", "mesh.ply", "offset.txt"}));
}

TEST_F(SurfaceFilesTest, GeoReferenceTellsHowToReadTheRest) {
  WriteAll(frame_, folder_.path());
  const auto json = base::ParseJson(base::ReadFile(folder_ / "georeference.json"));
  EXPECT_EQ(json["crs"], "EPSG:32617");
  EXPECT_EQ(json["offset"].get<std::vector<double>>(), std::vector<double>(frame_.offset().data(), frame_.offset().data() + 3));
  EXPECT_EQ(json["origin"]["latitude_deg"], 43.64);
  EXPECT_EQ(json["vertical"], "WGS84 ellipsoid (EPSG:4979)");
  const Names lines = Lines(base::ReadFile(folder_ / "offset.txt"));
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0], "WGS84 UTM 17N");
  EXPECT_EQ(lines[1], std::to_string(std::lround(frame_.offset().x())) + " " + std::to_string(std::lround(frame_.offset().y())));
}

TEST_F(SurfaceFilesTest, PolarZonesAreNamedByTheirCode) {
  const MapFrame frame(SampleInfo({-90.0, 0.0, 2800.0}));
  WriteAll(frame, folder_.path());
  EXPECT_EQ(Lines(base::ReadFile(folder_ / "offset.txt")).at(0), "EPSG:32761");
}

TEST_F(SurfaceFilesTest, AFolderThatCannotBeWrittenIsNamed) {
  std::ofstream(folder_ / "file") << "x";
  const std::string message = InputErrorOf([&] { SurfaceFiles(frame_, {}, kSampleTile_m, folder_ / "file" / "inside"); });
  EXPECT_NE(message.find("file"), std::string::npos) << message;
}

TEST_F(SurfaceFilesTest, AFullDiskNamesTheFileAndLeavesNothing) {
  const std::string message = InputErrorOf([&] {
    SurfaceFiles files(frame_, {.glb = true, .obj = false, .ply = false, .cloud = false, .tiles = false}, kSampleTile_m, folder_.path());
    files.Add(SampleTile({0, 0, 0}));
    const LimitedFileSize limit(1000);
    files.Close();
  });
  EXPECT_NE(message.find("mesh.glb"), std::string::npos) << message;
  EXPECT_EQ(NamesIn(folder_.path()), Names{});
}

TEST_F(SurfaceFilesTest, BrokenTilesAreBugs) {
  SurfaceFiles files(frame_, {}, kSampleTile_m, folder_.path());
  TexturedTile tile = SampleTile({0, 0, 0});
  tile.triangle.push_back({0, 1, 9999});
  EXPECT_THROW(files.Add(tile), std::logic_error);
  tile = SampleTile({0, 0, 0});
  tile.uv.pop_back();
  EXPECT_THROW(files.Add(tile), std::logic_error);
}

}  // namespace
}  // namespace skyquilt::surface
