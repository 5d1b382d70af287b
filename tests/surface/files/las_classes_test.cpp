#include "surface/files/las_classes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "core/base/file.h"
#include "surface/files/surface_files.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/surface/files/sample_surface.h"

namespace skyquilt::surface {
namespace {

constexpr FileSelection kCloudAlone = {.glb = false, .obj = false, .ply = false, .cloud = true, .tiles = false};
// Of LAS 1.4 and its point format 7.
constexpr size_t kPointsBeginAt = 96, kPointSize = 36, kClassOffset = 16;

struct Cloud {
  TemporaryFolder folder;
  MapFrame frame;
  std::vector<Eigen::Vector3d> positions;
  std::vector<uint8_t> codes;

  explicit Cloud(int count, int64_t max_points = 1000, bool georeferenced = true) : frame(SampleInfo({43.64, -79.39, 100.0}, georeferenced)) {
    std::vector<CloudPoint> points = SamplePoints(count);
    points[static_cast<size_t>(count) / 2].position.x() = std::numeric_limits<double>::quiet_NaN();  // which the writer leaves out
    SurfaceFiles files(frame, kCloudAlone, kSampleTile_m, folder.path(), max_points);
    files.AddPoints(points);
    files.Close();
    for (size_t i = 0; i < points.size(); ++i) {
      positions.push_back(points[i].position);
      codes.push_back(static_cast<uint8_t>(i % 2 == 0 ? 64 + i % 3 : 2 + i % 5));
    }
  }
  void Rewrite() const { RewriteLasClasses(folder.path(), frame, positions, codes); }
};

// Every byte of all files in the folder, cloud_2.las before cloud_10.las.
std::vector<std::pair<std::string, std::string>> ContentsOf(const std::filesystem::path& folder) {
  std::vector<std::pair<std::string, std::string>> contents;
  for (const std::string& name : NamesIn(folder)) contents.emplace_back(name, base::ReadFile(folder / name));
  std::stable_sort(contents.begin(), contents.end(), [](const auto& a, const auto& b) { return a.first.size() < b.first.size(); });
  return contents;
}

// Checks that files differ in classes only; these, in order.
std::vector<uint8_t> ClassesOf(const std::vector<std::pair<std::string, std::string>>& before,
                               const std::vector<std::pair<std::string, std::string>>& after) {
  std::vector<uint8_t> classes;
  EXPECT_EQ(before.size(), after.size());
  for (size_t file = 0; file < std::min(before.size(), after.size()); ++file) {
    EXPECT_EQ(before[file].first, after[file].first);
    std::string old = before[file].second, changed = after[file].second;
    if (before[file].first.ends_with(".las")) {
      EXPECT_EQ(old.size(), changed.size());
      for (size_t at = ReadAs<uint32_t>(old, kPointsBeginAt); at + kPointSize <= changed.size(); at += kPointSize) {
        classes.push_back(static_cast<uint8_t>(changed[at + kClassOffset]));
        old[at + kClassOffset] = changed[at + kClassOffset] = 0;
      }
    }
    EXPECT_TRUE(old == changed) << before[file].first;
  }
  return classes;
}

TEST(LasClasses, ChangeNothingElse) {
  for (const int64_t max_points : {int64_t{1000}, int64_t{40}, int64_t{9}}) {
    const Cloud cloud(100, max_points);
    const auto before = ContentsOf(cloud.folder.path());
    cloud.Rewrite();
    const auto after = ContentsOf(cloud.folder.path());
    std::vector<uint8_t> expected = cloud.codes;
    expected.erase(expected.begin() + 50);
    EXPECT_EQ(ClassesOf(before, after), expected) << max_points;
    cloud.Rewrite();
    EXPECT_TRUE(ContentsOf(cloud.folder.path()) == after) << "twice is as once";
  }
}

TEST(LasClasses, OfLocalCloudsAndManyBlocks) {
  const Cloud cloud(70000, 100000, false);
  const auto before = ContentsOf(cloud.folder.path());
  cloud.Rewrite();
  std::vector<uint8_t> expected = cloud.codes;
  expected.erase(expected.begin() + 35000);
  EXPECT_TRUE(ClassesOf(before, ContentsOf(cloud.folder.path())) == expected);
}

TEST(LasClasses, RefuseAnotherCloudAndLeaveItAlone) {
  const std::vector<std::pair<std::string, std::function<void(Cloud*)>>> changes = {
      {"it has 99 points, the surface has 98",
       [](Cloud* cloud) {
         cloud->positions.pop_back();
         cloud->codes.pop_back();
       }},
      {"point 3 is at another place", [](Cloud* cloud) { cloud->positions[3].y() += 0.01; }},
      {"at another place", [](Cloud* cloud) { cloud->positions.back().z() -= 0.01; }},
      {"at another place", [](Cloud* cloud) { std::swap(cloud->positions[98], cloud->positions[99]); }},
      {"at another place",
       [](Cloud* cloud) {
         cloud->frame = MapFrame(SampleInfo({43.6401, -79.39, 100.0}));
       }},
  };
  for (const int64_t max_points : {int64_t{1000}, int64_t{30}}) {
    for (const auto& [finding, change] : changes) {
      Cloud cloud(100, max_points);
      const auto before = ContentsOf(cloud.folder.path());
      change(&cloud);
      const std::string error = InputErrorOf([&] { cloud.Rewrite(); });
      EXPECT_NE(error.find("is another cloud than that of the surface"), std::string::npos) << error;
      EXPECT_NE(error.find(finding), std::string::npos) << error;
      EXPECT_TRUE(ContentsOf(cloud.folder.path()) == before) << finding;
    }
  }
  Cloud close(100);
  close.positions[3].y() += 0.001;
  EXPECT_EQ(InputErrorOf([&] { close.Rewrite(); }), "") << "single precision is near enough";
}

TEST(LasClasses, RefuseDamagedFiles) {
  const Cloud cloud(100);
  const std::filesystem::path las = cloud.folder / "cloud.las";
  const std::string good = base::ReadFile(las);
  const auto error_of = [&](const std::string& content) {
    base::WriteFileAtomically(las, content);
    const std::string error = InputErrorOf([&] { cloud.Rewrite(); });
    EXPECT_EQ(base::ReadFile(las), content);
    return error;
  };
  EXPECT_NE(error_of("").find("is not a cloud of this program"), std::string::npos);
  EXPECT_NE(error_of("LASF").find("is not a cloud of this program"), std::string::npos);
  EXPECT_NE(error_of(good.substr(0, good.size() - 1)).find("is damaged"), std::string::npos);
  EXPECT_NE(error_of(good.substr(0, 380)).find("is damaged"), std::string::npos);
  std::string changed = good;
  changed[104] = 6;
  EXPECT_NE(error_of(changed).find("is not a cloud of this program"), std::string::npos) << "another point format";
  changed = good;
  for (size_t i = 0; i < 8; ++i) changed[247 + i] = '\xFF';
  EXPECT_NE(error_of(changed).find("is damaged"), std::string::npos) << "a count that overflows";
  std::filesystem::remove(las);
  const std::string missing = InputErrorOf([&] { cloud.Rewrite(); });
  EXPECT_NE(missing.find("cloud.las: does not exist"), std::string::npos) << missing;
  EXPECT_NE(missing.find("surface.cloud=true"), std::string::npos) << missing;
}

TEST(LasClasses, StopWhenAsked) {
  const Cloud cloud(100);
  const auto before = ContentsOf(cloud.folder.path());
  ExpectStopsWhenAsked([&] { cloud.Rewrite(); });
  EXPECT_TRUE(ContentsOf(cloud.folder.path()) == before);
}

}  // namespace
}  // namespace skyquilt::surface
