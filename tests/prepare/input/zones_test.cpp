#include "prepare/input/zones.h"

#include <gtest/gtest.h>

#include <set>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::prepare::input {
namespace {

namespace fs = std::filesystem;

class Zones : public InTemporaryFolder {
 protected:
  fs::path Zone(const std::string& name) const {
    fs::create_directories(folder_ / name);
    base::WriteFileAtomically(folder_ / name / "DJI_0001.JPG", name);
    return folder_ / name;
  }
  std::set<std::string> Links(const std::vector<fs::path>& zones) const {
    std::set<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(LinkZones(zones, folder_ / "out" / "zones"))) {
      EXPECT_TRUE(fs::is_regular_file(entry.path() / "DJI_0001.JPG")) << entry.path();
      names.insert(entry.path().filename().string());
    }
    return names;
  }
  std::string Refusal(const std::vector<fs::path>& zones, const std::string& out = "out/zones") const {
    try {
      LinkZones(zones, folder_ / out);
    } catch (const base::UsageError& error) {
      return error.what();
    }
    return "";
  }
};

using FoldersOfPhotos = Zones;

TEST_F(FoldersOfPhotos, AreLinkedByTheirNames) {
  using Names = std::set<std::string>;
  const fs::path north = Zone("north"), south = Zone("south"), east = Zone("east");
  EXPECT_EQ(Links({north, south}), (Names{"north", "south"}));
  EXPECT_EQ(Links({south, east / ""}), (Names{"east", "south"})) << "what is no longer given is gone";
  EXPECT_TRUE(fs::exists(north / "DJI_0001.JPG")) << "the photos themselves stay";
  EXPECT_EQ(Links({Zone("monday/DCIM"), Zone("tuesday/DCIM"), north}), (Names{"monday_DCIM", "north", "tuesday_DCIM"}));
  // Of a simulated survey the photos.
  Zone("simulated/images");
  base::WriteFileAtomically(folder_ / "simulated" / "simulate.json", "{}");
  EXPECT_EQ(Links({folder_ / "simulated", north}), (Names{"images", "north"}));
}

TEST_F(FoldersOfPhotos, AreAddedToThoseOfAProject) {
  using Names = std::set<std::string>;
  const fs::path links = folder_ / "out" / "zones", north = Zone("monday/north"), south = Zone("south");
  const auto names = [&] {
    Names found;
    for (const fs::directory_entry& entry : fs::directory_iterator(links)) found.insert(entry.path().filename().string());
    return found;
  };
  EXPECT_EQ(AddZones(north, {north}, links), north) << "nothing to add";
  EXPECT_EQ(AddZones(north, {south}, links), links);
  EXPECT_EQ(names(), (Names{"north", "south"}));
  AddZones(links, {south / "", Zone("tuesday/north")}, links);
  EXPECT_EQ(names(), (Names{"north", "south", "tuesday_north"})) << "earlier ones keep their names, one that is there is not added again";
  EXPECT_THROW(AddZones(links, {Zone("south/inner")}, links), base::UsageError);
  EXPECT_THROW(AddZones(links, {folder_ / "none"}, links), base::InputError);
  EXPECT_EQ(names(), (Names{"north", "south", "tuesday_north"})) << "nothing has changed";
}

TEST_F(FoldersOfPhotos, ThatCannotBeOneSurveyAreRefused) {
  const fs::path north = Zone("north"), inner = Zone("north/inner");
  EXPECT_NE(Refusal({north, north}).find("twice"), std::string::npos);
  EXPECT_NE(Refusal({north, inner}).find("inside"), std::string::npos);
  EXPECT_NE(Refusal({north, Zone("south")}, "north/out/zones").find("project folder"), std::string::npos);
  EXPECT_NE(Refusal({Zone("1/a/images"), Zone("2/a/images")}).find("rename"), std::string::npos);
  EXPECT_THROW(LinkZones({north, folder_ / "none"}, folder_ / "out" / "zones"), base::InputError);
}

}  // namespace
}  // namespace skyquilt::prepare::input
