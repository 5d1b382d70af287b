// Files that panoramas become.
#include "prepare/rigs/cut_panoramas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "core/base/file.h"
#include "core/image/image.h"
#include "core/survey/exif.h"
#include "prepare/rigs/rig_config.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::prepare::rigs {
namespace {

namespace fs = std::filesystem;

class CutFolder : public InTemporaryFolder {
 protected:
  void SetUp() override {
    fs::create_directories(photos_folder_ / "zone");
    for (const char* name : {"zone/P1.jpg", "P2.png", "P3.jpg"}) Make(name, 128, 64, true);
    Make("plain.jpg", 90, 60, false);
    Make("wide.jpg", 120, 60, false);
  }

  void Make(const std::string& name, int width, int height, bool panorama) {
    image::Image8 picture(width, height, 3);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        uint8_t* pixel = picture.At(x, y);
        pixel[0] = static_cast<uint8_t>(40 + y);
        pixel[1] = static_cast<uint8_t>(60 + x / 2);
        pixel[2] = 90;
      }
    }
    const fs::path file = photos_folder_ / name;
    input::PhotoFile photo{.name = name, .width = width, .height = height};
    if (name.ends_with(".png")) {
      image::SavePng(picture, file);
    } else {
      image::SaveJpeg(picture, file, 95);
    }
    photo.tags.gps = geo::Geodetic{47.0 + 1e-4 * static_cast<double>(photos_.usable.size()), 8.0, 500.0};
    photo.tags.capture_time_s = 1000.0 + static_cast<double>(photos_.usable.size());
    photo.tags.exposure = {0.01, 2.0, 100.0};
    if (panorama) photo.tags.panorama = survey::PanoramaTags{.heading_deg = 90.0};
    photos_.usable.push_back(photo);
    std::sort(photos_.usable.begin(), photos_.usable.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  }

  struct Result {
    CutPhotos now;
    input::PhotoSet photos;
  };
  Result Cut(const PanoramaOptions& options) {
    Result result{{photos_folder_, masks_}, photos_};
    base::ThreadPool threads(2);
    CutPanoramas(FindPanoramas(result.photos.usable, options.which), options, out_, result.now, result.photos, threads);
    return result;
  }

  std::map<std::string, fs::file_time_type> TimesOfViews() const {
    std::map<std::string, fs::file_time_type> times;
    for (const auto& entry : fs::recursive_directory_iterator(out_ / "views")) {
      if (entry.is_regular_file() && !entry.is_symlink()) times[entry.path().string()] = entry.last_write_time();
    }
    return times;
  }

  const fs::path photos_folder_ = folder_ / "photos", out_ = folder_ / "survey";
  fs::path masks_;
  input::PhotoSet photos_;
};

using PanoramaFiles = CutFolder;

TEST_F(PanoramaFiles, OnlyPhotosThatSaySoAreTakenUnlessAsked) {
  EXPECT_EQ(FindPanoramas(photos_.usable, "auto").size(), 3U);
  EXPECT_EQ(FindPanoramas(photos_.usable, "all").size(), 4U);
  EXPECT_EQ(FindPanoramas(photos_.usable, "none").size(), 0U);
}

TEST_F(PanoramaFiles, BecomeViewsWithTagsBesideTheOtherPhotos) {
  const Result cut = Cut({});
  ASSERT_EQ(cut.photos.usable.size(), 3U * 12U + 2U);
  EXPECT_TRUE(std::is_sorted(cut.photos.usable.begin(), cut.photos.usable.end(), [](const auto& a, const auto& b) { return a.name < b.name; }));
  EXPECT_EQ(cut.now.picture_root, fs::absolute(out_ / "views"));
  EXPECT_TRUE(cut.now.masks.empty());
  std::map<std::string, int> views_of_shot;
  for (const input::PhotoFile& photo : cut.photos.usable) {
    int width = 0, height = 0;
    image::ReadImageSize(cut.now.picture_root / photo.name, &width, &height);
    EXPECT_EQ(width, photo.width) << photo.name;
    EXPECT_EQ(height, photo.height) << photo.name;
    if (!photo.rig) continue;
    ++views_of_shot[photo.rig->shot];
    EXPECT_NEAR(*photo.rig->exact_focal_px, 0.5 * photo.width, 1e-9);
    // The file's tags say the same.
    const survey::PhotoTags tags = survey::ReadPhotoTags(cut.now.picture_root / photo.name);
    EXPECT_NEAR(tags.gps->latitude_deg, photo.tags.gps->latitude_deg, 1e-9);
    EXPECT_EQ(tags.capture_time_s, photo.tags.capture_time_s);
    EXPECT_NEAR(*tags.exposure.time_s, 0.01, 1e-9);
    EXPECT_NEAR(*tags.gimbal_yaw_deg, *photo.tags.gimbal_yaw_deg, 0.01);
    EXPECT_NEAR(*tags.gimbal_pitch_deg, *photo.tags.gimbal_pitch_deg, 0.01);
    EXPECT_FALSE(tags.panorama);
  }
  EXPECT_EQ(views_of_shot, (std::map<std::string, int>{{"P2.png", 12}, {"P3.jpg", 12}, {"zone/P1.jpg", 12}}));
  EXPECT_TRUE(fs::exists(out_ / "views" / "pano_view11" / "P2.png.jpg"));
  // The rig as others read it.
  const std::vector<Rig> rigs = ReadRigConfig(out_ / "views" / "rig_config.json");
  ASSERT_EQ(rigs.size(), 1U);
  EXPECT_EQ(rigs[0].cameras.size(), 12U);
  EXPECT_EQ(rigs[0].cameras[11].prefix, "pano_view11/");
  const std::string table = base::ReadFile(out_ / "views.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 37);
}

TEST_F(PanoramaFiles, ASecondCallFindsThemAndAnotherChoiceMakesAllAnew) {
  Cut({.per_ring = 4, .pitches_deg = {0.0}, .width = 32});
  const auto times = TimesOfViews();
  ASSERT_EQ(times.size(), 13U);  // and the rig
  const Result again = Cut({.per_ring = 4, .pitches_deg = {0.0}, .width = 32});
  EXPECT_EQ(again.photos.usable.size(), 14U);
  EXPECT_EQ(TimesOfViews(), times);
  const Result other = Cut({.per_ring = 3, .pitches_deg = {0.0}, .width = 40});
  EXPECT_EQ(other.photos.usable.size(), 11U);
  EXPECT_EQ(TimesOfViews().size(), 10U);
  EXPECT_EQ(other.photos.usable.front().width, 40);
}

TEST_F(PanoramaFiles, AnInterruptedCallGoesOnWithWhatIsMissing) {
  const PanoramaOptions options{.per_ring = 4, .pitches_deg = {0.0}, .width = 32};
  Cut(options);
  const auto times = TimesOfViews();
  // As a kill leaves it: no table, the plan not finished, some views missing, one half written.
  const fs::path lost = fs::absolute(out_) / "views" / "pano_view02" / "P3.jpg", half = out_ / "views" / "pano_view02" / ".P3.jpg";
  const std::string whole = base::ReadFile(lost);
  fs::remove(lost);
  base::WriteFileAtomically(half, whole.substr(0, whole.size() / 2));
  fs::remove(out_ / "views.csv");
  std::string plan = base::ReadFile(out_ / "views.json");
  plan.replace(plan.find("\"complete\": true"), 16, "\"complete\": false");
  base::WriteFileAtomically(out_ / "views.json", plan);
  EXPECT_EQ(Cut(options).photos.usable.size(), 14U);
  EXPECT_FALSE(fs::exists(half));
  EXPECT_EQ(base::ReadFile(lost), whole);
  EXPECT_TRUE(fs::exists(out_ / "views.csv"));
  size_t n_same = 0;
  for (const auto& [file, time] : TimesOfViews()) n_same += times.at(file) == time ? 1 : 0;
  EXPECT_GE(n_same, 11U);  // all but the lost one, and the rig
}

TEST_F(PanoramaFiles, ADamagedPlanMakesAllAnew) {
  const PanoramaOptions options{.per_ring = 4, .pitches_deg = {0.0}, .width = 32};
  Cut(options);
  for (const char* text : {"", "{", "[]", "{\"made_from\": 3}"}) {
    base::WriteFileAtomically(out_ / "views.json", text);
    EXPECT_EQ(Cut(options).photos.usable.size(), 14U) << text;
  }
}

TEST_F(PanoramaFiles, MasksOfTheNadirAndOfPhotosAreInOneFolder) {
  masks_ = folder_ / "masks";
  fs::create_directories(masks_);
  image::SavePng(image::Image8(90, 60, 1, 255), masks_ / "plain.jpg.png");
  for (input::PhotoFile& photo : photos_.usable) {
    if (photo.name == "plain.jpg") photo.mask = (masks_ / "plain.jpg.png").string();
  }
  const Result cut = Cut({.per_ring = 4, .pitches_deg = {0.0, -35.0, -90.0}, .width = 64, .nadir_mask_deg = 48.0});
  // Of the views straight down all but the corners are masked.
  size_t n_masked = 0;
  for (const input::PhotoFile& photo : cut.photos.usable) {
    if (photo.mask.empty()) continue;
    ++n_masked;
    EXPECT_EQ(photo.mask, (cut.now.masks / (photo.name + ".png")).string());
    EXPECT_EQ(image::LoadMask(photo.mask).width, photo.width);
  }
  EXPECT_EQ(n_masked, 3U * 9U + 1U);
  const Result wider = Cut({.per_ring = 4, .pitches_deg = {0.0, -90.0}, .width = 64, .nadir_mask_deg = 60.0});
  EXPECT_EQ(wider.photos.usable.size(), 3U * 4U + 2U);
  const std::string table = base::ReadFile(out_ / "views.csv");
  EXPECT_NE(table.find("pano_view04/P3.jpg,P3.jpg,no,"), std::string::npos) << table;
  EXPECT_NE(InputErrorOf([&] { Cut({.which = "auto", .pitches_deg = {-90.0}, .width = 64, .nadir_mask_deg = 60.0}); }).find("nadir_mask_deg"),
            std::string::npos);
}

TEST_F(PanoramaFiles, ADamagedPanoramaIsLeftOutAndListed) {
  const std::string bytes = base::ReadFile(photos_folder_ / "P3.jpg");
  base::WriteFileAtomically(photos_folder_ / "P3.jpg", bytes.substr(0, bytes.size() / 2));
  for (int call = 0; call < 2; ++call) {
    const Result cut = Cut({.per_ring = 4, .pitches_deg = {0.0}, .width = 32});
    EXPECT_EQ(cut.photos.usable.size(), 10U);
    EXPECT_EQ(cut.photos.unreadable, std::vector<std::string>{"P3.jpg"});
  }
  EXPECT_NE(base::ReadFile(out_ / "views.csv").find("P3.jpg,no,"), std::string::npos);
}

TEST_F(PanoramaFiles, WithoutPanoramasNothingIsMadeAndOldViewsGo) {
  Cut({.per_ring = 4, .pitches_deg = {0.0}, .width = 32});
  const Result none = Cut({.which = "none"});
  EXPECT_EQ(none.photos.usable.size(), 5U);
  EXPECT_EQ(none.now.picture_root, photos_folder_);
  EXPECT_FALSE(fs::exists(out_ / "views"));
  EXPECT_FALSE(fs::exists(out_ / "views.csv"));
}

}  // namespace
}  // namespace skyquilt::prepare::rigs
