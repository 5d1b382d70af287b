#include "bench/poses/photo_sets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "bench/poses/photo_edits.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/order_statistics.h"
#include "core/base/text.h"
#include "core/image/image.h"
#include "core/survey/colmap_model.h"
#include "core/survey/exif.h"

namespace skyquilt::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kJpegQuality = 95;
constexpr size_t kEveryTurned = 3, kEveryBlurred = 4;
constexpr int kBlurParts = 40;          // of the longer side, that a blurred photo moved by
constexpr double kNarrowerView = 0.75;  // width and height of the second camera's photos, relative to the first one's

struct SetText {
  const char* name;
  const char* about;
};
constexpr std::array<SetText, 7> kSets = {{{"plain", "as simulated"},
                                           {"two_cameras", "second half by a camera with a narrower view"},
                                           {"turned", "every third photo turned by 90 degrees"},
                                           {"blurred", "every fourth photo blurred along the flight"},
                                           {"other_place", "with 4 photos of another place, tagged here"},
                                           {"no_tags", "without positions and gimbal angles"},
                                           {"solar_farm", "rows of identical panels"}}};

// Same parity as the whole, so that the middle stays the middle.
int NarrowerSide(int side) {
  const int wanted = static_cast<int>(kNarrowerView * side);
  return wanted - (side - wanted) % 2;
}

void RemovePlaceTags(survey::PhotoTags& tags) {
  tags.gps.reset();
  tags.relative_altitude_m.reset();
  tags.absolute_altitude_m.reset();
  tags.gimbal_yaw_deg.reset();
  tags.gimbal_pitch_deg.reset();
  tags.gimbal_roll_deg.reset();
  tags.speed_mps.reset();
}

void Save(const image::Image8& pixels, const survey::PhotoTags& tags, const fs::path& file) {
  image::SaveJpeg(pixels, file, kJpegQuality);
  survey::WritePhotoTags(tags, file);
}

// Photo `index` of `n` as the set has it. The true pose changes with the pixels.
void WriteMember(PhotoSet set, size_t index, size_t n, const fs::path& from, const fs::path& to, TruePhoto* truth) {
  const bool second_camera = set == PhotoSet::kTwoCameras && 2 * index >= n;
  const bool turned = set == PhotoSet::kTurned && index % kEveryTurned == kEveryTurned - 1;
  const bool blurred = set == PhotoSet::kBlurred && index % kEveryBlurred == kEveryBlurred - 1;
  if (!second_camera && !turned && !blurred && set != PhotoSet::kNoTags) {
    fs::copy_file(from, to);
    return;
  }
  const image::Image8 photo = image::LoadRgb8(from);
  survey::PhotoTags tags = survey::ReadPhotoTags(from);
  if (second_camera) {
    const image::Image8 narrow = MiddleOf(photo, NarrowerSide(photo.width), NarrowerSide(photo.height));
    tags.model += " Tele";
    if (tags.focal_length_35mm) tags.focal_length_35mm = std::round(*tags.focal_length_35mm * photo.width / narrow.width);
    Save(narrow, tags, to);
  } else if (turned) {
    truth->cam_from_enu = TurnedClockwise(truth->cam_from_enu);
    Save(TurnedClockwise(photo), tags, to);
  } else if (blurred) {
    Save(MovedWhileOpen(photo, std::max(2, std::max(photo.width, photo.height) / kBlurParts)), tags, to);
  } else {
    RemovePlaceTags(tags);
    Save(photo, tags, to);
  }
}

// Photos of the other place with the tags of photos of this one, from its beginning to its end.
void AddIntruders(const fs::path& survey, const fs::path& other, const fs::path& out, TrueSet* made) {
  const survey::ColmapModel elsewhere = survey::ReadColmapModel(other / "sparse" / "0");
  SKYQUILT_CHECK(elsewhere.images.size() >= static_cast<size_t>(kIntruders), "too few photos of another place");
  const size_t n_ours = made->photos.size();
  for (size_t i = 0; i < static_cast<size_t>(kIntruders); ++i) {
    std::array<char, 32> name{};
    std::snprintf(name.data(), name.size(), "OTHER_%04zu.jpg", i + 1);
    const std::string like = made->photos[(2 * i + 1) * n_ours / (2 * static_cast<size_t>(kIntruders))].name;
    const survey::PhotoTags tags = survey::ReadPhotoTags(survey / "images" / like);
    Save(image::LoadRgb8(other / "images" / elsewhere.images[i].name), tags, out / name.data());
    made->photos.push_back({.name = name.data(), .cam_from_enu = {}, .focal_px = 0.0, .intruder = true});
  }
}

}  // namespace

const std::vector<std::string>& PhotoSetNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const SetText& set : kSets) all.emplace_back(set.name);
    return all;
  }();
  return names;
}

const char* NameOf(PhotoSet set) {
  return kSets[static_cast<size_t>(set)].name;
}

const char* AboutSet(PhotoSet set) {
  return kSets[static_cast<size_t>(set)].about;
}

PhotoSet PhotoSetOf(const std::string& name) {
  const std::vector<std::string>& names = PhotoSetNames();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw base::UsageError("there is no photo set '" + name + "'; there are " + base::Join(names));
  return static_cast<PhotoSet>(found - names.begin());
}

size_t TrueSet::CountOurs() const {
  return static_cast<size_t>(std::count_if(photos.begin(), photos.end(), [](const TruePhoto& photo) { return !photo.intruder; }));
}

TrueSet MakePhotoSet(PhotoSet set, const fs::path& survey, const fs::path& other, const fs::path& out) {
  base::RequireWritableFolder(out);
  survey::ColmapModel model = survey::ReadColmapModel(survey / "sparse" / "0");
  std::sort(model.images.begin(), model.images.end(), [](const survey::ColmapImage& a, const survey::ColmapImage& b) { return a.name < b.name; });
  TrueSet made;
  std::vector<double> heights_m;
  for (size_t i = 0; i < model.images.size(); ++i) {
    base::ThrowIfCancelled();
    const survey::ColmapImage& image = model.images[i];
    const fs::path from = survey / "images" / image.name;
    if (const auto height_m = survey::ReadPhotoTags(from).relative_altitude_m) heights_m.push_back(*height_m);
    TruePhoto truth{.name = image.name, .cam_from_enu = image.cam_from_world, .focal_px = model.cameras.at(image.camera_id).FocalX()};
    WriteMember(set, i, model.images.size(), from, out / image.name, &truth);
    made.photos.push_back(std::move(truth));
  }
  if (heights_m.empty()) throw base::InputError(survey, "its photos have no heights in their tags", "Simulate with tag_heights = \"true\"");
  made.height_m = base::Median(std::move(heights_m));
  if (set == PhotoSet::kOtherPlace) AddIntruders(survey, other, out, &made);
  return made;
}

}  // namespace skyquilt::bench
