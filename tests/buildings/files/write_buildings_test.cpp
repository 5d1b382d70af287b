#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "buildings/files/building_files.h"
#include "core/base/file.h"
#include "tests/buildings/files/sample_set.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::buildings {
namespace {

using WriteBuildingsTest = InTemporaryFolder;

const std::vector<std::string> kAll = {"buildings.city.json", "buildings.csv", "buildings.dxf", "buildings.glb", "buildings.gpkg", "buildings.json"};

std::vector<std::string> FilesOf(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

TEST_F(WriteBuildingsTest, WritesAllThatIsChosen) {
  const auto rows = WriteBuildings(SampleSet(), SampleFrame(), {}, folder_ / "new/buildings");
  EXPECT_EQ(FilesOf(folder_ / "new/buildings"), kAll);
  ASSERT_EQ(rows.size(), kAll.size());
  for (const surface::WrittenFile& row : rows) {
    EXPECT_EQ(row.bytes, static_cast<int64_t>(std::filesystem::file_size(folder_ / "new/buildings" / row.file))) << row.file;
    EXPECT_EQ(row.detail, "4 buildings");
    EXPECT_EQ(row.crs, row.file == "buildings.glb" ? "EPSG:32632 minus offset" : "EPSG:32632");
  }
  EXPECT_EQ(LoadBuildings(folder_ / "new/buildings/buildings.json").buildings.size(), 4U);
}

TEST_F(WriteBuildingsTest, RemovesWhatIsNotChosenAndNothingElse) {
  WriteBuildings(SampleSet(), SampleFrame(), {}, folder_.path());
  base::WriteFileAtomically(folder_ / "facade_1_1.png", "mine");
  BuildingsOptions options;
  options.cityjson = options.geopackage = options.glb = options.dxf = false;
  const auto rows = WriteBuildings(SampleSet(), SampleFrame(), options, folder_.path());
  EXPECT_EQ(rows.size(), 2U);
  EXPECT_EQ(FilesOf(folder_.path()), (std::vector<std::string>{"buildings.csv", "buildings.json", "facade_1_1.png"}));
}

TEST_F(WriteBuildingsTest, TheSameBuildingsGiveTheSameBytes) {
  WriteBuildings(SampleSet(), SampleFrame(), {}, folder_ / "a");
  // Longer than the resolution of the time stamps.
  timespec wait = {.tv_sec = 0, .tv_nsec = 20'000'000};
  nanosleep(&wait, nullptr);
  WriteBuildings(SampleSet(), SampleFrame(), {}, folder_ / "b");
  WriteBuildings(SampleSet(), SampleFrame(), {}, folder_ / "b");
  for (const std::string& name : kAll) {
    EXPECT_TRUE(base::ReadFile(folder_.path() / "a" / name) == base::ReadFile(folder_.path() / "b" / name)) << name;
  }
}

TEST_F(WriteBuildingsTest, OfNoBuildingsWritesAllFilesToo) {
  WriteBuildings({}, SampleFrame(false), {}, folder_.path());
  EXPECT_EQ(FilesOf(folder_.path()), kAll);
  EXPECT_TRUE(LoadBuildings(folder_ / "buildings.json").buildings.empty());
}

TEST_F(WriteBuildingsTest, SaysWhenTheFolderCannotBeWritten) {
  base::WriteFileAtomically(folder_ / "file", "not a folder");
  const std::string error = InputErrorOf([&] { WriteBuildings(SampleSet(), SampleFrame(), {}, folder_ / "file"); });
  EXPECT_NE(error.find((folder_ / "file").string()), std::string::npos) << error;
  EXPECT_EQ(base::ReadFile(folder_ / "file"), "not a folder");
  EXPECT_EQ(FilesOf(folder_.path()), (std::vector<std::string>{"file"}));
  // A folder where a file must go.
  for (const std::string& name : kAll) {
    const std::filesystem::path blocked = folder_ / ("for_" + name);
    std::filesystem::create_directories(blocked / name / "full");
    const std::string reason = InputErrorOf([&] { WriteBuildings(SampleSet(), SampleFrame(), {}, blocked); });
    EXPECT_NE(reason.find(name), std::string::npos) << reason;
    for (const std::string& left : FilesOf(blocked)) EXPECT_EQ(std::count(kAll.begin(), kAll.end(), left), 1) << left << " is left behind";
  }
}

TEST_F(WriteBuildingsTest, StopsWhenAsked) {
  ExpectStopsWhenAsked([&] { WriteBuildings(SampleSet(), SampleFrame(), {}, folder_.path()); });
}

TEST_F(WriteBuildingsTest, NoFileHoldsANumberThatIsNone) {
  BuildingSet set = SampleSet();
  set.buildings[0].lod22.vertex[3].z() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(WriteCityJson(set, SampleFrame(), folder_ / "a"), std::logic_error);
  EXPECT_THROW(WriteGlb(set, SampleFrame(), folder_ / "a"), std::logic_error);
  EXPECT_THROW(WriteDxf(set, SampleFrame(), folder_ / "a"), std::logic_error);
  EXPECT_THROW(WriteGeoPackage(set, SampleFrame(), folder_ / "a.gpkg"), std::logic_error);
  EXPECT_TRUE(FilesOf(folder_.path()).empty());
}

}  // namespace
}  // namespace skyquilt::buildings
