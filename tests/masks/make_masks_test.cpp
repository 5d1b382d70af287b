#include "masks/make_masks.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/base/cancel.h"
#include "core/base/file.h"
#include "masks/mask_pictures.h"
#include "tests/masks/mask_survey.h"
#include "tests/support/error_of.h"
#include "tests/support/made_onnx.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::masks {
namespace {

namespace fs = std::filesystem;
using image::Image8;

class MakeMasksTest : public testing::Test {
 protected:
  void SetUp() override {
    base::ClearCancel();
    survey_ = MakeMaskSurvey(folder_.path(), 3, false);
    // The third photo has a mask of its own: its lower half.
    Image8 given(kPhotoWidth, kPhotoHeight, 1, 255);
    std::fill(given.data.begin() + given.data.size() / 2, given.data.end(), uint8_t{0});
    image::SavePng(given, folder_ / "given.png");
    survey_.photos[2].mask = (folder_ / "given.png").string();
    survey::SaveSurvey(survey_, Survey());
    base::WriteFileAtomically(folder_ / "red.onnx", onnx::ColorModel({{0, 0, 0, 0}, {1, -1, 0, -0.4F}}, kPhotoHeight, kPhotoWidth));
    base::WriteFileAtomically(folder_ / "red.toml", "input_width = 120\ninput_height = 90\nclasses = [\"other\", \"red\"]\nignore = [\"red\"]\n");
    // x from 40.1 m: the eastern half of the third photo, the last columns of the second.
    base::WriteFileAtomically(folder_ / "lake.geojson", R"({"type":"Polygon","coordinates":[[[40.1,-30],[100,-30],[100,30],[40.1,30],[40.1,-30]]]})");
  }
  fs::path Survey() const { return folder_ / "survey"; }
  fs::path Made(const std::string& name) const { return survey::MadeMasksFolder(Survey()) / name; }
  MaskOptions Network() const { return {(folder_ / "red.onnx").string(), (folder_ / "red.toml").string(), ""}; }
  MaskOptions Ground() const { return {"", "", (folder_ / "lake.geojson").string()}; }
  MaskOptions Both() const { return {Network().segment, Network().segment_config, Ground().ignore_ground}; }

  TemporaryFolder folder_;
  survey::Survey survey_;
};

TEST_F(MakeMasksTest, TheSurveyIsLoadedWithTheMasksThatWereMade) {
  const survey::MadeMasks masks = MakeMasks(Survey(), Both(), 2);
  ASSERT_EQ(masks.photos.size(), 3U);
  const survey::Survey loaded = survey::LoadSurvey(Survey());
  for (size_t i = 0; i < 3; ++i) {
    const survey::MadeMask& made = masks.photos[i];
    EXPECT_EQ(made.photo, loaded.photos[i].name);
    EXPECT_EQ(loaded.photos[i].mask, (fs::absolute(Made(made.file)).lexically_normal().string()));
    const Image8 mask = image::LoadMask(loaded.photos[i].mask);
    ASSERT_EQ(mask.width, kPhotoWidth);
    ASSERT_EQ(mask.height, kPhotoHeight);
    int64_t ignored = 0;
    for (int y = 0; y < kPhotoHeight; ++y) {
      for (int x = 0; x < kPhotoWidth; ++x) {
        const bool red = x >= 20 && x < 30 && y >= 30 && y < 40;
        const double east = 20.0 * static_cast<double>(i) + (x + 0.5 - 60.0) * 0.5;
        const bool lake = east > 40.1, given = i == 2 && y >= kPhotoHeight / 2;
        EXPECT_EQ(*mask.At(x, y) == 0, red || lake || given) << i << ": " << x << " " << y;
        ignored += *mask.At(x, y) == 0 ? 1 : 0;
      }
    }
    EXPECT_EQ(made.pixels, int64_t{kPhotoWidth} * kPhotoHeight);
    EXPECT_EQ(made.ignored, ignored);
    EXPECT_EQ(made.network, 100);
    EXPECT_EQ(made.given, i == 2 ? made.pixels / 2 : 0);
  }
  EXPECT_EQ(masks.photos[0].ground, 0);
  EXPECT_EQ(masks.photos[2].ground, 60 * kPhotoHeight);
  EXPECT_EQ(masks.network, "red.onnx");
  EXPECT_EQ(masks.classes, std::vector<std::string>{"red"});
  EXPECT_EQ(masks.ground, "lake.geojson");
}

// Red by the network, blue on ignored ground, grey by the given mask.
TEST_F(MakeMasksTest, PicturesShowWhatIsIgnored) {
  const survey::MadeMasks masks = MakeMasks(Survey(), Both(), 1);
  const Image8 look = image::LoadRgb8(Made(masks.photos[2].look));
  ASSERT_EQ(look.width, kPhotoWidth);
  const auto color = [&](int x, int y) { return std::array<int, 3>{look.At(x, y)[0], look.At(x, y)[1], look.At(x, y)[2]}; };
  const auto [red, red_g, red_b] = color(25, 35);
  EXPECT_GT(red, red_g + 100);
  EXPECT_GT(red, red_b + 100);
  const auto [blue_r, blue_g, blue] = color(100, 10);
  EXPECT_GT(blue, blue_r + 60);
  const auto [grey, grey_g, grey_b] = color(10, 80);
  EXPECT_LT(std::abs(grey - grey_b), 12);
  EXPECT_GT(grey, 110);
  EXPECT_LT(std::abs(color(10, 10)[0] - 102), 8);  // as it is
}

TEST_F(MakeMasksTest, PhotosWithoutNewIgnoredPixelsKeepWhatTheyWereGiven) {
  const survey::MadeMasks masks = MakeMasks(Survey(), Ground(), 2);
  EXPECT_EQ(masks.photos[0].file, "");
  EXPECT_EQ(masks.photos[0].look, "");
  const survey::Survey loaded = survey::LoadSurvey(Survey());
  EXPECT_EQ(loaded.photos[0].mask, "");
  // And without any masks the survey is as it was.
  MakeMasks(Survey(), {}, 2);
  EXPECT_FALSE(fs::exists(survey::MadeMasksFolder(Survey())));
  EXPECT_EQ(survey::LoadSurvey(Survey()).photos[2].mask, survey_.photos[2].mask);
}

// What the network found is kept, and only what has changed is made again.
TEST_F(MakeMasksTest, RepeatsOnlyWhatHasChanged) {
  MakeMasks(Survey(), Network(), 2);
  const auto time = [&](const std::string& name) { return fs::last_write_time(Made(name)); };
  const std::vector<std::string> found = {"network/sub/0.png.png", "network/sub/1.png.png"};
  const std::vector<fs::file_time_type> before = {time(found[0]), time(found[1])};
  const auto combined = time("combined/sub/0.png.png");
  MakeMasks(Survey(), Network(), 2);
  EXPECT_EQ(time("combined/sub/0.png.png"), combined);
  MakeMasks(Survey(), Both(), 2);  // other polygons: the network does not run again
  EXPECT_EQ(time(found[0]), before[0]);
  EXPECT_EQ(image::LoadMask(survey::LoadSurvey(Survey()).photos[1].mask).data[119], 0);
  // Another photo of the same name.
  image::SavePng(Image8(kPhotoWidth, kPhotoHeight, 3, 90), survey_.photo_root / survey_.photos[0].name);
  const survey::MadeMasks masks = MakeMasks(Survey(), Network(), 2);
  EXPECT_EQ(masks.photos[0].network, 0);
  EXPECT_FALSE(fs::exists(Made("combined/sub/0.png.png")));
  EXPECT_EQ(time(found[1]), before[1]);
  // Another network.
  base::WriteFileAtomically(folder_ / "red.onnx", onnx::ColorModel({{0, 0, 0, 1}, {1, -1, 0, -0.4F}}, kPhotoHeight, kPhotoWidth));
  EXPECT_EQ(MakeMasks(Survey(), Network(), 2).photos[1].network, 0);
}

// A rank that runs the tasks it is given, as texts, with a runner of its own.
class OtherRank : public RemoteTasks {
 public:
  int threads() override { return 1; }
  void Run(std::span<const std::string> tasks, const TaskProgress& on_progress) override {
    MaskRunner runner(1);
    for (const std::string& task : tasks) runner.Run(TaskFromText(task), on_progress);
  }
};

TEST_F(MakeMasksTest, OtherRanksMakeTheSame) {
  MakeMasks(Survey(), Both(), 2);
  const std::string alone = base::ReadFile(survey::MadeMasksFile(Survey()));
  const std::string mask = base::ReadFile(Made("combined/sub/2.png.png"));
  fs::remove_all(survey::MadeMasksFolder(Survey()));
  OtherRank rank;
  MakeMasks(Survey(), Both(), 2, &rank);
  EXPECT_EQ(base::ReadFile(survey::MadeMasksFile(Survey())), alone);
  EXPECT_EQ(base::ReadFile(Made("combined/sub/2.png.png")), mask);
}

TEST_F(MakeMasksTest, StopsWhenAsked) {
  ExpectStopsWhenAsked([&] { MakeMasks(Survey(), Both(), 2); });
  EXPECT_FALSE(fs::exists(survey::MadeMasksFile(Survey())));
}

TEST_F(MakeMasksTest, OptionsAndFilesAreCheckedBeforeTheWork) {
  EXPECT_NE(UsageErrorOf([&] { MaskOptions{"a.onnx", "", ""}.Check(); }).find("masks.segment_config"), std::string::npos);
  EXPECT_NE(UsageErrorOf([&] { MaskOptions{"", "a.toml", ""}.Check(); }).find("masks.segment"), std::string::npos);
  EXPECT_NO_THROW(CheckFiles(Both()));
  EXPECT_NO_THROW(CheckFiles({}));
  base::WriteFileAtomically(folder_ / "lake.geojson", "{");
  EXPECT_NE(InputErrorOf([&] { CheckFiles(Both()); }).find("lake.geojson"), std::string::npos);
  base::WriteFileAtomically(folder_ / "red.toml", "input_width = 120\n");
  EXPECT_NE(InputErrorOf([&] { CheckFiles(Both()); }).find("red.toml"), std::string::npos);
}

TEST_F(MakeMasksTest, DamagedTablesAreRefused) {
  MakeMasks(Survey(), Network(), 2);
  const fs::path file = survey::MadeMasksFile(Survey());
  const std::string good = base::ReadFile(file);
  const auto error_with = [&](const std::string& text) {
    base::WriteFileAtomically(file, text);
    return InputErrorOf([&] { survey::LoadSurvey(Survey()); });
  };
  EXPECT_EQ(error_with(good), "");
  EXPECT_NE(error_with(good.substr(0, good.size() / 2)).find("damaged"), std::string::npos);
  nlohmann::json value = nlohmann::json::parse(good);
  value["photos"][0]["ignored"] = 1000000;
  EXPECT_NE(error_with(value.dump()).find("more pixels"), std::string::npos);
  value = nlohmann::json::parse(good);
  value["photos"][1]["photo"] = "another.png";
  EXPECT_NE(error_with(value.dump()).find("other photos"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::masks
