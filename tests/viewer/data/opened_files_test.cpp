// Which files of a project are shown, and where they lie.
#include <gtest/gtest.h>

#include <cstring>
#include <thread>

#include "core/gis/read_maps.h"
#include "tests/viewer/data/sample_project.h"
#include "tests/viewer/engine/whole_scene.h"

namespace skyquilt::viewer {
namespace {

using OpenedFilesTest = SampleProjectTest;

using Color = std::array<uint8_t, 4>;

template <typename T>
T Value(const std::string& bytes, size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

image::Image8 PictureOf(ProjectData& data) {
  const std::string picture = data.Get("orthophoto.jpg", "").Content();
  return image::DecodeRgb8({reinterpret_cast<const uint8_t*>(picture.data()), picture.size()});
}

// The front end lays the picture's edges on the outermost points: what is in the orthophoto must stay at its place on the ground.
TEST_F(OpenedFilesTest, TheOrthophotoLiesOnThePointsOfTheTerrain) {
  sample_.AddMaps(1500, 700);
  // On another grid than the surface model's, as after `render` with another resolution: red west of a line, green east of it.
  gis::MapGrid grid = gis::ReadMapGrid(sample_.project.ProductsFolder() / "dsm.tif");
  EXPECT_TRUE(grid.georeferenced);
  EXPECT_EQ(grid.zone.Epsg(), 32632);
  const double line_east_m = -300.0;
  const double line = grid.left + 0.5 * grid.width * grid.resolution_m + line_east_m;
  grid.left -= 31.0;
  grid.top += 17.0;
  grid.resolution_m = 1.0;
  grid.width = 830;
  grid.height = 400;
  sample_.WriteOrthophoto(grid, [&](double easting, double) { return easting < line ? Color{200, 0, 0, 255} : Color{0, 200, 0, 255}; });
  ProjectData data(sample_.project);
  const std::string terrain = data.Get("terrain.bin", "").Content();
  const auto columns = Value<uint32_t>(terrain, 8), rows = Value<uint32_t>(terrain, 12);
  const auto east_of = [&](uint32_t column) {
    return Value<double>(terrain, 16) + static_cast<double>(Value<float>(terrain, 40U + 12U * (columns * (rows / 2) + column)));
  };
  const image::Image8 picture = PictureOf(data);
  int edge = 0;
  while (edge < picture.width && picture.At(edge, picture.height / 2)[0] > 100) ++edge;
  // Where the front end shows it: u = column / (columns - 1).
  const double column = static_cast<double>(edge) / picture.width * (columns - 1);
  const auto before = static_cast<uint32_t>(column);
  const double share = column - before;
  EXPECT_NEAR((1.0 - share) * east_of(before) + share * east_of(before + 1), line_east_m, 0.6);
}

TEST_F(OpenedFilesTest, WhereTheOrthophotoHasNoDataItIsGrey) {
  sample_.AddMaps(3000, 300);
  gis::MapGrid grid = gis::ReadMapGrid(sample_.project.ProductsFolder() / "dsm.tif");
  const double line = grid.left + 0.5 * grid.width * grid.resolution_m - 0.3;
  grid.width = 2900;  // ends before the surface model
  sample_.WriteOrthophoto(grid, [&](double easting, double) { return easting < line ? Color{0, 0, 0, 0} : Color{240, 240, 240, 255}; });
  ProjectData data(sample_.project);
  const image::Image8 picture = PictureOf(data);
  const int middle = picture.height / 2;
  EXPECT_NEAR(*picture.At(10, middle), 128, 2);
  EXPECT_NEAR(*picture.At(picture.width * 3 / 4, middle), 240, 2);
  EXPECT_NEAR(*picture.At(picture.width - 2, middle), 128, 2);
  for (int x = 0; x < picture.width; ++x) EXPECT_GT(*picture.At(x, middle), 110) << "a dark seam at " << x;
}

TEST_F(OpenedFilesTest, MapsInOtherCoordinatesAreNotShown) {
  sample_.AddMaps();
  survey::Survey local = survey::LoadSurvey(sample_.project.SurveyFolder());
  local.georeferenced = false;
  survey::SaveSurvey(local, sample_.project.SurveyFolder());
  ProjectData data(sample_.project);
  EXPECT_TRUE(DescriptionOf(data)["crs"].is_null());
  EXPECT_TRUE(DescriptionOf(data)["terrain"].is_null());
  EXPECT_TRUE(IsMissing(DescriptionOf(data), "surface model"));
  EXPECT_EQ(data.Get("terrain.bin", "").status, 404);
}

TEST_F(OpenedFilesTest, ASceneGivesPlaceAndBoxWithoutSurvey) {
  WriteWholeScene(sample_.project.SceneFile());
  std::filesystem::remove(sample_.project.SurveyFolder() / "survey.json");
  ProjectData data(sample_.project);
  const nlohmann::json description = DescriptionOf(data);
  EXPECT_EQ(description["scene"]["blocks"], 1);
  EXPECT_FALSE(description["scene"]["trust"].get<bool>());
  EXPECT_GT(description["scene"]["parameters"].get<int64_t>(), 0) << "train.json is not needed";
  EXPECT_EQ(description["max_enu"], nlohmann::json({5.0, 5.0, 4.0}));
  EXPECT_EQ(description["gsd_m"], 0.05);
  EXPECT_EQ(description["origin"]["latitude_deg"], 41.0);
  EXPECT_EQ(description["crs"]["name"], "EPSG:32631");
  EXPECT_TRUE(IsMissing(description, "photos and sparse points"));
}

TEST_F(OpenedFilesTest, PhotosOutsideTheirFolderAreNotSent) {
  image::SaveJpeg(image::Image8(640, 400, 3, 9), sample_.folder / "private.jpg", 90);
  survey::Survey survey = survey::LoadSurvey(sample_.project.SurveyFolder());
  survey.photos[0].name = "../private.jpg";
  survey.photos[1].name = (sample_.folder / "private.jpg").string();
  survey::SaveSurvey(survey, sample_.project.SurveyFolder());
  ProjectData data(sample_.project);
  for (const char* photo : {"photos/0/", "photos/1/"}) {
    for (const char* size : {"thumbnail.jpg", "photo.jpg", "full.jpg"}) EXPECT_EQ(data.Get(std::string(photo) + size, "").status, 404);
  }
  EXPECT_FALSE(DescriptionOf(data)["photos"][0]["available"].get<bool>());
}

TEST_F(OpenedFilesTest, LinksAmongTheTilesAreNotFollowed) {
  sample_.AddSurface();
  base::WriteFileAtomically(sample_.folder / "private", "private");
  std::filesystem::create_symlink(sample_.folder / "private", sample_.project.SurfaceFolder() / "tiles" / "7_0_0.glb");
  ProjectData data(sample_.project);
  EXPECT_EQ(data.Get("tiles/7_0_0.glb", "").status, 404);
  EXPECT_EQ(data.Get("tiles/0_-1_2.glb", "").status, 200);
}

TEST_F(OpenedFilesTest, ReloadWhileFilesAreAskedFor) {
  sample_.AddMaps(300, 300);
  ProjectData data(sample_.project);
  const auto survey = data.survey();
  std::thread engine([&] {
    for (int i = 0; i < 20; ++i) data.Reload();
  });
  for (int i = 0; i < 30; ++i) {
    EXPECT_EQ(data.Get("terrain.bin", "").status, 200);
    EXPECT_FALSE(data.Get("project.json", "r=1").cache);
  }
  engine.join();
  EXPECT_EQ(DescriptionOf(data)["revision"], 20);
  EXPECT_EQ(data.survey(), survey) << "a survey whose file is the same is not read again";
}

TEST_F(OpenedFilesTest, CommandsCanBePastedIntoAShell) {
  const coordinator::Project odd{sample_.folder.path() / "it's here; rm x"};
  std::filesystem::rename(sample_.project.folder, odd.folder);
  ProjectData data(odd);
  const std::string quoted = "'" + (sample_.folder.path() / "it").string() + "'\\''s here; rm x'";
  const nlohmann::json description = DescriptionOf(data);
  for (const nlohmann::json& one : description["missing"]) {
    EXPECT_NE(one["advice"].get<std::string>().find(quoted), std::string::npos) << one;
  }
}

}  // namespace
}  // namespace skyquilt::viewer
