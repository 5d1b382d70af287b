#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <limits>

#include "buildings/files/building_files.h"
#include "core/base/cancel.h"
#include "core/base/file.h"
#include "tests/buildings/files/sample_set.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::buildings {
namespace {

const std::vector<std::string> kAll = {"buildings.city.json", "buildings.csv", "buildings.dxf", "buildings.glb", "buildings.gpkg", "buildings.json"};

std::vector<std::string> FilesOf(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(WriteBuildings, WritesAllThatIsChosen) {
  const TemporaryFolder folder;
  const auto rows = WriteBuildings(SampleSet(), SampleFrame(), {}, folder / "new/buildings");
  EXPECT_EQ(FilesOf(folder / "new/buildings"), kAll);
  ASSERT_EQ(rows.size(), kAll.size());
  for (const surface::WrittenFile& row : rows) {
    EXPECT_EQ(row.bytes, static_cast<int64_t>(std::filesystem::file_size(folder / "new/buildings" / row.file))) << row.file;
    EXPECT_EQ(row.detail, "4 buildings");
    EXPECT_EQ(row.crs, row.file == "buildings.glb" ? "EPSG:32632 minus offset" : "EPSG:32632");
  }
  EXPECT_EQ(LoadBuildings(folder / "new/buildings/buildings.json").buildings.size(), 4U);
}

TEST(WriteBuildings, RemovesWhatIsNotChosenAndNothingElse) {
  const TemporaryFolder folder;
  WriteBuildings(SampleSet(), SampleFrame(), {}, folder.path());
  base::WriteFileAtomically(folder / "facade_1_1.png", "mine");
  BuildingsOptions options;
  options.cityjson = options.geopackage = options.glb = options.dxf = false;
  const auto rows = WriteBuildings(SampleSet(), SampleFrame(), options, folder.path());
  EXPECT_EQ(rows.size(), 2U);
  EXPECT_EQ(FilesOf(folder.path()), (std::vector<std::string>{"buildings.csv", "buildings.json", "facade_1_1.png"}));
}

TEST(WriteBuildings, TheSameBuildingsGiveTheSameBytes) {
  const TemporaryFolder folder;
  WriteBuildings(SampleSet(), SampleFrame(), {}, folder / "a");
  // Longer than the resolution of the time stamps.
  timespec wait = {.tv_sec = 0, .tv_nsec = 20'000'000};
  nanosleep(&wait, nullptr);
  WriteBuildings(SampleSet(), SampleFrame(), {}, folder / "b");
  WriteBuildings(SampleSet(), SampleFrame(), {}, folder / "b");
  for (const std::string& name : kAll) {
    EXPECT_TRUE(base::ReadFile(folder.path() / "a" / name) == base::ReadFile(folder.path() / "b" / name)) << name;
  }
}

TEST(WriteBuildings, OfNoBuildingsWritesAllFilesToo) {
  const TemporaryFolder folder;
  WriteBuildings({}, SampleFrame(false), {}, folder.path());
  EXPECT_EQ(FilesOf(folder.path()), kAll);
  EXPECT_TRUE(LoadBuildings(folder / "buildings.json").buildings.empty());
}

TEST(WriteBuildings, SaysWhenTheFolderCannotBeWritten) {
  const TemporaryFolder folder;
  base::WriteFileAtomically(folder / "file", "not a folder");
  const std::string error = InputErrorOf([&] { WriteBuildings(SampleSet(), SampleFrame(), {}, folder / "file"); });
  EXPECT_NE(error.find((folder / "file").string()), std::string::npos) << error;
  EXPECT_EQ(base::ReadFile(folder / "file"), "not a folder");
  EXPECT_EQ(FilesOf(folder.path()), (std::vector<std::string>{"file"}));
  // A folder where a file must go.
  for (const std::string& name : kAll) {
    const std::filesystem::path blocked = folder / ("for_" + name);
    std::filesystem::create_directories(blocked / name / "full");
    const std::string reason = InputErrorOf([&] { WriteBuildings(SampleSet(), SampleFrame(), {}, blocked); });
    EXPECT_NE(reason.find(name), std::string::npos) << reason;
    for (const std::string& left : FilesOf(blocked)) EXPECT_EQ(std::count(kAll.begin(), kAll.end(), left), 1) << left << " is left behind";
  }
}

TEST(WriteBuildings, StopsWhenAsked) {
  const TemporaryFolder folder;
  base::RequestCancel();
  EXPECT_THROW(WriteBuildings(SampleSet(), SampleFrame(), {}, folder.path()), base::Interrupted);
  base::ClearCancel();
}

TEST(WriteBuildings, NoFileHoldsANumberThatIsNone) {
  const TemporaryFolder folder;
  BuildingSet set = SampleSet();
  set.buildings[0].lod22.vertex[3].z() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(WriteCityJson(set, SampleFrame(), folder / "a"), std::logic_error);
  EXPECT_THROW(WriteGlb(set, SampleFrame(), folder / "a"), std::logic_error);
  EXPECT_THROW(WriteDxf(set, SampleFrame(), folder / "a"), std::logic_error);
  EXPECT_THROW(WriteGeoPackage(set, SampleFrame(), folder / "a.gpkg"), std::logic_error);
  EXPECT_TRUE(FilesOf(folder.path()).empty());
}

}  // namespace
}  // namespace skyquilt::buildings
