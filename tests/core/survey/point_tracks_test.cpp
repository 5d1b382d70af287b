#include "core/survey/point_tracks.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <fstream>
#include <string>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::survey {
namespace {

using TracksFile = InTemporaryFolder;

constexpr size_t kPhotos = 6;
constexpr TrackCounts kCounts = {.photos = kPhotos, .points = 3, .kept_points = 2, .observations = 9};

PointTracks Points() {
  PointTracks tracks;
  tracks.Add({4, 0, 2, 4});
  tracks.Add({});
  tracks.Add({5, 1});
  return tracks;
}

PointTracks KeptPoints() {
  PointTracks tracks;
  tracks.Add({3});
  tracks.Add({0, 1, 2});
  return tracks;
}

std::vector<int32_t> List(std::span<const int32_t> photos) {
  return {photos.begin(), photos.end()};
}

TEST(PointTracks, PhotosAreAscendingAndListedOnce) {
  const PointTracks tracks = Points();
  EXPECT_EQ(tracks.points(), 3U);
  EXPECT_EQ(tracks.observations(), 5U);
  EXPECT_EQ(List(tracks.PhotosOf(0)), (std::vector<int32_t>{0, 2, 4}));
  EXPECT_TRUE(tracks.PhotosOf(1).empty());
  EXPECT_EQ(List(tracks.PhotosOf(2)), (std::vector<int32_t>{1, 5}));
  EXPECT_FALSE(tracks.Empty());
  EXPECT_TRUE(PointTracks().Empty());
  EXPECT_TRUE(PointTracks().PhotosOf(7).empty()) << "no tracks are known";
}

TEST(PointTracks, FollowThePhotosThatRemain) {
  const PointTracks fewer = Points().Renumbered(std::array<int32_t, kPhotos>{-1, 0, 1, -1, 2, -1});
  EXPECT_EQ(fewer.points(), 3U);
  EXPECT_EQ(List(fewer.PhotosOf(0)), (std::vector<int32_t>{1, 2}));
  EXPECT_TRUE(fewer.PhotosOf(1).empty());
  EXPECT_EQ(List(fewer.PhotosOf(2)), (std::vector<int32_t>{0}));
}

TEST_F(TracksFile, IsReadBackAndTakesFourBytesPerObservation) {
  WriteTracks(Points(), KeptPoints(), kPhotos, folder_ / "tracks.bin");
  EXPECT_EQ(std::filesystem::file_size(folder_ / "tracks.bin"), 48U + 4U * (3 + 5 + 2 + 4));
  const SurveyTracks back = ReadTracks(folder_ / "tracks.bin", kCounts);
  EXPECT_EQ(back.points, Points());
  EXPECT_EQ(back.kept_points, KeptPoints());

  WriteTracks({}, {}, 0, folder_ / "none.bin");
  EXPECT_TRUE(ReadTracks(folder_ / "none.bin", {}).points.Empty());
}

TEST_F(TracksFile, OfAnotherSurveyIsRefused) {
  WriteTracks(Points(), KeptPoints(), kPhotos, folder_ / "tracks.bin");
  const auto refused = [&](const std::string& word, TrackCounts counts) {
    const std::string error = InputErrorOf([&] { ReadTracks(folder_ / "tracks.bin", counts); });
    EXPECT_NE(error.find(word), std::string::npos) << error;
  };
  refused("6 photos, but survey.json says 5", {5, 3, 2, 9});
  refused("3 points, but survey.json says 4", {6, 4, 2, 9});
  refused("2 kept points, but survey.json says 1", {6, 3, 1, 9});
  refused("9 observations, but survey.json says 10", {6, 3, 2, 10});
  EXPECT_THROW(ReadTracks(folder_ / "absent.bin", kCounts), base::InputError);
}

// Cut off anywhere, longer, or with any byte of the header, the lengths or the photos changed so that it contradicts itself.
TEST_F(TracksFile, DamageIsFound) {
  WriteTracks(Points(), KeptPoints(), kPhotos, folder_ / "tracks.bin");
  const std::string whole = base::ReadFile(folder_ / "tracks.bin");
  const auto read = [&](const std::string& content) {
    std::ofstream(folder_ / "damaged.bin", std::ios::binary | std::ios::trunc) << content;
    return ReadTracks(folder_ / "damaged.bin", kCounts);
  };
  for (size_t length = 0; length < whole.size(); ++length) EXPECT_THROW(read(whole.substr(0, length)), base::InputError) << length;
  EXPECT_THROW(read(whole + "abcd"), base::InputError);
  for (size_t at = 0; at < whole.size(); ++at) {
    for (const char flip : {'\x01', '\x40', '\x80'}) {
      std::string damaged = whole;
      damaged[at] = static_cast<char>(damaged[at] ^ flip);
      // A changed photo may be another valid one; everything else must be refused.
      try {
        const SurveyTracks back = read(damaged);
        EXPECT_EQ(back.points.observations() + back.kept_points.observations(), 9U) << at;
        EXPECT_GE(at, 48U + 4U * 3);
      } catch (const base::InputError&) {
      }
    }
  }
  const auto with_number = [&](size_t at, int32_t number) {
    std::string damaged = whole;
    std::memcpy(damaged.data() + at, &number, sizeof(number));
    return damaged;
  };
  const size_t photos = 48 + 4 * 3;
  EXPECT_THROW(read(with_number(photos, -1)), base::InputError);
  EXPECT_THROW(read(with_number(photos, 2)), base::InputError) << "twice the same photo";
  EXPECT_THROW(read(with_number(photos + 8, 6)), base::InputError) << "there are six photos";
  EXPECT_THROW(read(with_number(48, 2)), base::InputError) << "an observation belongs to no point";
  EXPECT_THROW(read(with_number(48, 4)), base::InputError) << "tracks longer than all observations";
  // Counts whose sums are right, but only because they overflow.
  std::string overflowing = whole;
  const uint64_t huge[2] = {uint64_t{1} << 63U, (uint64_t{1} << 63U) + 9};
  std::memcpy(overflowing.data() + 32, huge, sizeof(huge));
  EXPECT_THROW(read(overflowing), base::InputError);
}

}  // namespace
}  // namespace skyquilt::survey
