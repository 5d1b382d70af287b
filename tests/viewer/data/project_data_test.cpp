#include "viewer/data/project_data.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include "core/base/errors.h"
#include "core/base/json_text.h"
#include "core/geo/enu_frame.h"
#include "core/geo/geoid.h"
#include "tests/viewer/data/sample_project.h"

namespace skyquilt::viewer {
namespace {

using ProjectDataTest = SampleProjectTest;

template <typename T>
T ValueAt(const std::string& bytes, size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

TEST_F(ProjectDataTest, SaysWhatIsMissingAndWhichCommandHelps) {
  const nlohmann::json description = DescriptionOf(data_);
  EXPECT_EQ(description["name"], "project");
  EXPECT_TRUE(description["scene"].is_null());
  EXPECT_TRUE(description["tiles"].is_null());
  EXPECT_TRUE(description["terrain"].is_null());
  EXPECT_TRUE(description["before"].is_null());
  for (const char* what : {"exact frames", "blocks", "textured surface", "surface model", "scores"})
    EXPECT_TRUE(IsMissing(description, what)) << what;
  EXPECT_EQ(description["photos"].size(), 2U);
  EXPECT_EQ(description["photos"][1]["position"], nlohmann::json({10.0, 0.0, 50.0}));
  EXPECT_TRUE(description["photos"][1]["is_test"].get<bool>());
  EXPECT_EQ(description["crs"]["name"], "EPSG:32632");
  EXPECT_EQ(description["crs"]["zone"], 32);
  EXPECT_EQ(description["points"], "points.bin");
  // The box of the sparse points, without the outermost.
  EXPECT_NEAR(description["min_enu"][0].get<double>(), -19.6, 0.5);
  EXPECT_NEAR(description["ground_m"].get<double>(), 1.0, 1e-9);
}

TEST_F(ProjectDataTest, ShowsASurfaceOnlyWhenItIsFinished) {
  sample_.AddSurface();
  std::filesystem::remove(sample_.project.SurfaceTable());
  ProjectData data(sample_.project);
  EXPECT_TRUE(DescriptionOf(data)["tiles"].is_null());
  EXPECT_EQ(data.Get("tiles/0_-1_2.glb", "").status, 404);
  sample_.AddSurface();
  data.Reload();
  const nlohmann::json description = DescriptionOf(data);
  EXPECT_EQ(description["tiles"], "tiles/tileset.json");
  EXPECT_EQ(description["surface"]["triangles"], 12);
  EXPECT_EQ(description["revision"], 1);
  EXPECT_EQ(data.Get("tiles/0_-1_2.glb", "r=1").file, sample_.project.SurfaceFolder() / "tiles" / "0_-1_2.glb");
  EXPECT_TRUE(data.Get("tiles/0_-1_2.glb", "r=1").cache);
  EXPECT_FALSE(data.Get("tiles/0_-1_2.glb", "").cache);
}

TEST_F(ProjectDataTest, GivesNothingThatIsNotInItsTable) {
  sample_.AddSurface();
  ProjectData data(sample_.project);
  for (const char* path : {"tiles/notes.txt", "tiles/../surface.json", "../config.toml", "survey/survey.json", "surface.json",
                           "photos/0/../1/full.jpg", "photos/2/full.jpg", "photos/-1/full.jpg", "photos/0", "photos//full.jpg",
                           "photos/99999999999999999999/full.jpg", "before/project.json", "pictures/0.png", "", "/etc/passwd", "tiles/"}) {
    EXPECT_EQ(data.Get(path, "").status, 404) << path;
  }
  EXPECT_EQ(data.Put("project.json", "{}", "").status, 405);
  EXPECT_EQ(data.Put("../evil.json", "{}", "").status, 405);
}

TEST_F(ProjectDataTest, TerrainLiesWhereTheMapSays) {
  sample_.AddMaps();
  ProjectData data(sample_.project);
  ASSERT_EQ(DescriptionOf(data)["terrain"], "terrain.bin");
  const std::string terrain = data.Get("terrain.bin", "").Content();
  ASSERT_EQ(terrain.substr(0, 8), "SKYTERR1");
  const auto columns = ValueAt<uint32_t>(terrain, 8), rows = ValueAt<uint32_t>(terrain, 12);
  ASSERT_EQ(columns, 40U);
  ASSERT_EQ(rows, 30U);
  ASSERT_EQ(terrain.size(), 40U + 12U * columns * rows);
  const auto vertex = [&](uint32_t column, uint32_t row) {
    Eigen::Vector3d at;
    for (size_t i = 0; i < 3; ++i) {
      at(static_cast<Eigen::Index>(i)) =
          ValueAt<double>(terrain, 16 + 8 * i) + static_cast<double>(ValueAt<float>(terrain, 40 + 12 * (row * columns + column) + 4 * i));
    }
    return at;
  };
  EXPECT_TRUE(std::isnan(vertex(0, 0).x())) << "a cell without height";
  // 10 m above the origin; the map's grid is turned by the convergence of the meridians, which is small here.
  const Eigen::Vector3d middle = 0.25 * (vertex(19, 14) + vertex(20, 14) + vertex(19, 15) + vertex(20, 15));
  EXPECT_NEAR(middle.x(), 0.0, 1e-3);
  EXPECT_NEAR(middle.y(), 0.0, 1e-3);
  EXPECT_NEAR(middle.z(), 10.0, 1e-3);
  EXPECT_NEAR((vertex(21, 15) - vertex(20, 15)).norm(), 0.5, 1e-3);
  EXPECT_GT(vertex(20, 10).y(), vertex(20, 20).y()) << "rows go from north to south";
  const std::string picture = data.Get("orthophoto.jpg", "").Content();
  const image::Image8 decoded = image::DecodeRgb8({reinterpret_cast<const uint8_t*>(picture.data()), picture.size()});
  EXPECT_EQ(decoded.width, 39) << "from the first to the last column of points";
  EXPECT_NEAR(*decoded.At(5, 5), 200, 3);
}

// The map is in another system than the survey, whose frame everything is shown in.
TEST_F(ProjectDataTest, TerrainHasTheHeightsOfTheSurvey) {
  SampleProject own, other;
  own.AddMaps();
  other.AddMaps(40, 30, 418.0 - geo::Egm96Undulation(47.3769, 8.5417), -1);
  ProjectData own_data(own.project), other_data(other.project);
  const std::string expected = own_data.Get("terrain.bin", "").Content(), terrain = other_data.Get("terrain.bin", "").Content();
  ASSERT_EQ(terrain.size(), expected.size());
  for (const size_t axis : {size_t{0}, size_t{1}, size_t{2}}) {
    EXPECT_NEAR(ValueAt<double>(terrain, 16 + 8 * axis), ValueAt<double>(expected, 16 + 8 * axis), 2e-3) << axis;
  }
}

TEST_F(ProjectDataTest, TilesStandAtTheHeightsOfTheSurvey) {
  sample_.AddSurface();
  const std::filesystem::path file = sample_.project.SurfaceFolder() / "tiles" / "tileset.json";
  base::WriteFileAtomically(file, R"({"asset": {"extras": {"surveyTransform": [1, 2]}}, "root": {"transform": [3, 4]}})");
  ProjectData data(sample_.project);
  const auto tileset = base::ParseJson(data.Get("tiles/tileset.json", "").Content());
  EXPECT_EQ(tileset["root"]["transform"], nlohmann::json::array({1, 2}));
}

TEST_F(ProjectDataTest, LargeMapsAreReduced) {
  sample_.AddMaps(1500, 700);
  ProjectData data(sample_.project);
  const std::string terrain = data.Get("terrain.bin", "").Content();
  EXPECT_EQ(ValueAt<uint32_t>(terrain, 8), 512U);
  EXPECT_NEAR(ValueAt<uint32_t>(terrain, 12), 239, 1);
}

TEST_F(ProjectDataTest, SendsPointsAndPhotos) {
  const std::string points = data_.Get("points.bin", "").Content();
  ASSERT_EQ(points.substr(0, 8), "SKYPNTS1");
  EXPECT_EQ(ValueAt<uint32_t>(points, 8), 100U);
  ASSERT_EQ(points.size(), 40U + 1500U);
  EXPECT_NEAR(ValueAt<double>(points, 16) + static_cast<double>(ValueAt<float>(points, 40)), -20.0, 1e-5);
  EXPECT_EQ(points[40 + 1200], 10);

  const auto width = [&](const std::string& path) {
    const std::string body = data_.Get(path, "").Content();
    return image::DecodeRgb8({reinterpret_cast<const uint8_t*>(body.data()), body.size()}).width;
  };
  EXPECT_EQ(width("photos/0/thumbnail.jpg"), 256);
  EXPECT_EQ(width("photos/1/photo.jpg"), 640) << "never enlarged";
  EXPECT_EQ(data_.Get("photos/1/full.jpg", "").file, sample_.photos / "IMG_1.jpg");
  std::filesystem::remove(sample_.photos / "IMG_1.jpg");
  EXPECT_EQ(data_.Get("photos/1/full.jpg", "").status, 404);
  std::ofstream(sample_.photos / "IMG_1.jpg") << "not a photo";
  data_.Reload();  // forgets what it made
  EXPECT_EQ(data_.Get("photos/1/full.jpg", "").status, 404) << "not a JPEG";
  EXPECT_EQ(data_.Get("photos/1/photo.jpg", "").status, 404);
}

TEST_F(ProjectDataTest, DamagedFilesBecomeReasons) {
  sample_.AddMaps();
  base::WriteFileAtomically(sample_.project.SceneFile(), "not a scene");
  base::WriteFileAtomically(sample_.project.BlocksFile(), "{");
  std::filesystem::create_directories(sample_.project.ReportFolder());
  base::WriteFileAtomically(sample_.project.MetricsFile(), "[1");
  {
    ProjectData data(sample_.project);
    const nlohmann::json description = DescriptionOf(data);
    EXPECT_TRUE(IsMissing(description, "exact frames"));
    EXPECT_TRUE(IsMissing(description, "blocks"));
    EXPECT_TRUE(IsMissing(description, "scores"));
    EXPECT_EQ(description["photos"].size(), 2U);
  }
  base::WriteFileAtomically(sample_.project.SurveyFolder() / "survey.json", "{}");
  base::WriteFileAtomically(sample_.project.ProductsFolder() / "dsm.tif", "not a map");
  ProjectData data(sample_.project);
  EXPECT_TRUE(IsMissing(DescriptionOf(data), "photos and sparse points"));
  EXPECT_EQ(data.survey(), nullptr);
  EXPECT_EQ(data.Get("points.bin", "").status, 404);
  EXPECT_EQ(data.Get("terrain.bin", "").status, 404);
}

TEST_F(ProjectDataTest, DescribesTheEarlierProjectInItsOwnFrame) {
  SampleProject sample, earlier;
  earlier.AddMaps();
  survey::Survey moved = survey::LoadSurvey(earlier.project.SurveyFolder());
  moved.origin.longitude_deg += 0.001;
  survey::SaveSurvey(moved, earlier.project.SurveyFolder());
  ProjectData data(sample.project, earlier.project);
  const nlohmann::json before = DescriptionOf(data)["before"];
  ASSERT_TRUE(before.is_object());
  EXPECT_EQ(before["terrain"], "before/terrain.bin");
  EXPECT_EQ(data.Get("before/terrain.bin", "").status, 200);
  EXPECT_EQ(data.Get("terrain.bin", "").status, 404);
  const std::vector<double> transform = before["enu_from_before"];
  ASSERT_EQ(transform.size(), 16U);
  const geo::EnuFrame frame({47.3769, 8.5417, 408.0});
  const Eigen::Vector3d expected = frame.EnuFromGeodetic(moved.origin);
  EXPECT_NEAR(transform[3], expected.x(), 1e-6);
  EXPECT_NEAR(transform[7], expected.y(), 1e-6);
  EXPECT_NEAR(transform[11], expected.z(), 1e-6);
  EXPECT_NEAR(transform[0], 1.0, 1e-9);
}

TEST_F(ProjectDataTest, KeepsTheNewestPictures) {
  const std::string first = data_.AddPicture("one");
  EXPECT_EQ(data_.Get(first, "").Content(), "one");
  for (int i = 0; i < 8; ++i) data_.AddPicture("more");
  EXPECT_EQ(data_.Get(first, "").status, 404);
}

TEST_F(ProjectDataTest, FilesThatAreKeptAreNotCopied) {
  const DataReply first = data_.Get("photos/0/photo.jpg", ""), second = data_.Get("photos/0/photo.jpg", "");
  ASSERT_NE(first.kept, nullptr);
  EXPECT_EQ(first.kept, second.kept);
}

TEST(Project, IsOpenedToReadWithoutWriting) {
  if (geteuid() == 0) {
    // Root may write everywhere; at least nothing is left behind or created.
    EXPECT_THROW(coordinator::Project::OpenToRead("/nowhere/at/all"), base::InputError);
  }
  SampleProject sample;
  const auto time = std::filesystem::last_write_time(sample.project.folder);
  std::filesystem::permissions(sample.project.folder, std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  EXPECT_EQ(coordinator::Project::OpenToRead(sample.project.folder / "." / "survey" / "..").folder.lexically_relative(sample.project.folder), ".");
  std::filesystem::permissions(sample.project.folder, std::filesystem::perms::owner_all);
  EXPECT_EQ(std::filesystem::last_write_time(sample.project.folder), time) << "a test file in the folder would change it";
  EXPECT_THROW(coordinator::Project::OpenToRead(sample.photos), base::InputError);
}

}  // namespace
}  // namespace skyquilt::viewer
