#include "products/photo_map/paint_job.h"

#include <algorithm>
#include <fstream>

#include "core/base/errors.h"
#include "tests/products/photo_orthophoto_fixture.h"

namespace skyquilt::products {
namespace {

// Another process on this machine: it has nothing but the job's file, the survey and the photos. It begins with the last tile and leaves some out.
class OtherProcess : public TileService {
 public:
  explicit OtherProcess(const survey::Survey& survey) : survey_(survey) {}

  void Paint(const std::filesystem::path& job, std::span<const TileArea> tiles, const Take& take) override {
    base::ThreadPool threads(1);
    PaintJob painter(survey_, job, size_t{1} << 20, threads);
    for (size_t i = tiles.size(); i > 0; --i) {
      if (static_cast<int>(i) <= left_out_) continue;
      PhotoMapRows cells;
      painter.map().PaintTile(tiles[i - 1], &cells);
      ++painted_;
      take(i - 1, std::move(cells));
    }
  }

  int left_out_ = 0, painted_ = 0;

 private:
  const survey::Survey& survey_;
};

class PaintJobTest : public PhotoOrthophotoTest {
 protected:
  std::map<std::string, std::string> Files() const {
    std::map<std::string, std::string> files;
    for (const char* name : {"orthophoto.tif", "ortho_sources.tif", "ortho_sources.json", "cutline.gpkg"}) {
      files[name] = base::ReadFile(folder_ / "products" / name);
    }
    return files;
  }
  // Two rows of tiles, two in each.
  static ProductOptions Fine() {
    ProductOptions options;
    options.resolution_m = 0.042;
    return options;
  }
};

TEST_F(PaintJobTest, TilesFromElsewhereAreTheSame) {
  const survey::Survey survey = PatternedSurvey::Write(folder_.path(), 0.5, false);
  const MapProducts here = Make(survey, Fine());
  ASSERT_GT(here.grid.width, 1024);
  ASSERT_GT(here.grid.height, PhotoMap::kRows);
  const auto wanted = Files();
  OtherProcess other(survey);
  elsewhere_ = &other;
  Make(survey, Fine());
  EXPECT_EQ(other.painted_, 4);
  EXPECT_EQ(Files(), wanted);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "products/orthophoto.parts"));
  // What nobody paints elsewhere is painted here.
  OtherProcess lazy(survey);
  lazy.left_out_ = 1;
  elsewhere_ = &lazy;
  Make(survey, Fine());
  EXPECT_EQ(lazy.painted_, 3);
  EXPECT_EQ(Files(), wanted);
}

TEST_F(PaintJobTest, PartsThatStandAreNotAskedForAgain) {
  const survey::Survey survey = PatternedSurvey::Write(folder_.path(), 0.0, false);
  const std::filesystem::path in_the_way = folder_ / "products/cutline.gpkg";
  std::filesystem::create_directories(in_the_way / "full");
  EXPECT_THROW(Make(survey, Fine()), std::exception);
  std::filesystem::remove_all(in_the_way);
  std::filesystem::remove(folder_ / "products/orthophoto.parts/rows_0.bin");
  OtherProcess other(survey);
  elsewhere_ = &other;
  Make(survey, Fine());
  EXPECT_EQ(other.painted_, 2);
}

TEST_F(PaintJobTest, RefusesOtherPhotosAndADamagedFile) {
  const survey::Survey survey = PatternedSurvey::Write(folder_.path(), 0.0, false);
  const gis::MapGrid grid = PlanMapGrid(Info(), {});
  const gis::MapProjection projection(Info().origin, grid);
  base::ThreadPool threads(2);
  const HeightGrid surface(grid, std::vector<float>(grid.size(), 3.0F));
  const std::vector<float> slack_m = SightSlack(surface, threads);
  const std::vector<char> usable(survey.photos.size(), 1);
  const PhotoMapInput input{.survey = survey,
                            .usable = usable,
                            .grid = grid,
                            .projection = projection,
                            .surface = surface,
                            .slack_m = slack_m,
                            .field_rgba = {},
                            .ground_z = 3.0,
                            .flown_height_m = 40.0};
  PhotoMap map(input, threads);
  const std::filesystem::path file = folder_ / "job";
  WritePaintJob(input, Info().origin, map, file);
  PaintJob job(survey, file, size_t{1} << 20, threads);
  PhotoMapRows here, there;
  const TileArea tile{.column = 10, .row = 20, .columns = 60, .rows = 50};
  map.PaintTile(tile, &here);
  job.map().PaintTile(tile, &there);
  EXPECT_EQ(here.rgba, there.rgba);
  EXPECT_EQ(here.sources, there.sources);
  EXPECT_TRUE(std::any_of(here.sources.begin(), here.sources.end(), [](uint16_t source) { return source >= kFirstPhotoSource; }));

  const std::filesystem::path photo = folder_ / survey.photos[3].name;
  std::ofstream(photo, std::ios::app) << "longer";
  EXPECT_THROW(PaintJob(survey, file, size_t{1} << 20, threads), base::InputError);
  PatternedSurvey::Write(folder_.path(), 0.0, false);
  std::string bytes = base::ReadFile(file);
  bytes[bytes.size() / 2] ^= 1;
  base::WriteFileAtomically(file, bytes);
  EXPECT_THROW(PaintJob(survey, file, size_t{1} << 20, threads), base::InputError);
}

}  // namespace
}  // namespace skyquilt::products
