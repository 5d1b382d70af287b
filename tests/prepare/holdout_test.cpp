#include "prepare/holdout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/image/image.h"
#include "prepare/prepare.h"
#include "tests/prepare/synthetic_flight.h"

namespace skyquilt::prepare {
namespace {

survey::Survey Photos(int n) {
  survey::Survey survey;
  for (int i = 0; i < n; ++i) {
    survey::Photo photo;
    photo.name = "p" + std::to_string(i) + ".jpg";
    survey.photos.push_back(photo);
  }
  survey.unregistered = {"lost.jpg"};
  return survey;
}

std::vector<int> TestIndices(const std::string& holdout, int n) {
  survey::Survey survey = Photos(n);
  MarkHoldout(ParseHoldout(holdout), survey);
  std::vector<int> indices;
  for (int i = 0; i < n; ++i) {
    if (survey.photos[static_cast<size_t>(i)].is_test) indices.push_back(i);
  }
  return indices;
}

TEST(Holdout, CountsRegisteredPhotosInNameOrder) {
  EXPECT_EQ(TestIndices("every:8", 18), (std::vector<int>{0, 8, 16}));
  EXPECT_EQ(TestIndices("every:5:3", 10), (std::vector<int>{3, 8}));
  EXPECT_EQ(TestIndices("none", 4), (std::vector<int>{}));
  EXPECT_EQ(TestIndices("every:8", 0), (std::vector<int>{}));
}

// Three shots of two views each and one photo alone.
std::vector<std::string> HeldOutOfShots(const std::string& holdout) {
  survey::Survey survey;
  std::map<std::string, std::string> shots;
  for (const std::string view : {"view0/", "view1/"}) {
    for (const std::string shot : {"a.jpg", "b.jpg", "c.jpg"}) {
      survey.photos.emplace_back().name = view + shot;
      shots.emplace(view + shot, shot);
    }
  }
  survey.photos.emplace_back().name = "z.jpg";
  MarkHoldout(ParseHoldout(holdout), shots, survey);
  std::vector<std::string> names;
  for (const survey::Photo& photo : survey.photos) {
    if (photo.is_test) names.push_back(photo.name);
  }
  return names;
}

TEST(Holdout, PhotosOfOneShotAreHeldOutTogether) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(HeldOutOfShots("every:3"), (Names{"view0/a.jpg", "view1/a.jpg", "z.jpg"}));
  EXPECT_EQ(HeldOutOfShots("every:4:1"), (Names{"view0/b.jpg", "view1/b.jpg"}));
  EXPECT_EQ(HeldOutOfShots("none"), Names{});
  const TemporaryFolder folder;
  // By the shot, or by one of its photos.
  base::WriteFileAtomically(folder / "list.txt", "b.jpg\nview1/c.jpg\n");
  EXPECT_EQ(HeldOutOfShots("list:" + (folder / "list.txt").string()), (Names{"view0/b.jpg", "view0/c.jpg", "view1/b.jpg", "view1/c.jpg"}));
  base::WriteFileAtomically(folder / "list.txt", "a.jpg\nb.jpg\nc.jpg\nz.jpg\n");
  EXPECT_THROW(HeldOutOfShots("list:" + (folder / "list.txt").string()), base::UsageError);
}

TEST(Holdout, NonsenseIsAUsageError) {
  for (const char* text :
       {"", "every", "every:", "every:0", "every:1", "every:-8", "every:8:8", "every:8:-1", "every:8x", "every:8:", "list:", "some", "none "}) {
    EXPECT_THROW(ParseHoldout(text), base::UsageError) << text;
  }
}

TEST(Holdout, AListNamesPhotos) {
  const TemporaryFolder folder;
  base::WriteFileAtomically(folder / "list.txt", "# comment\n\n p1.jpg \r\nlost.jpg\np3.jpg");
  EXPECT_EQ(TestIndices("list:" + (folder / "list.txt").string(), 5), (std::vector<int>{1, 3}));
  base::WriteFileAtomically(folder / "list.txt",
                            "\xEF\xBB\xBF"
                            "D:\\flight\\P1.JPG\r\np3\n");
  EXPECT_EQ(TestIndices("list:" + (folder / "list.txt").string(), 5), (std::vector<int>{1, 3}));
  base::WriteFileAtomically(folder / "list.txt", "p1.jpg\nnever_seen.jpg\n");
  EXPECT_THROW(TestIndices("list:" + (folder / "list.txt").string(), 5), base::InputError);
  EXPECT_THROW(TestIndices("list:" + (folder / "absent.txt").string(), 5), base::InputError);
}

TEST(Holdout, SomethingMustRemainToTrainOn) {
  EXPECT_THROW(TestIndices("every:2", 1), base::UsageError);
}

// What held-out photos show, where they are and which points they observed.
enum class HeldOut { kGiven, kOther };

// A survey in its exact frame, so that nothing but points and lines is computed from the photos. Photos 0, 8 and 16 (images 1, 9 and 17) are those
// that are held out by default.
survey::Survey PrepareFlight(HeldOut held_out, const std::string& holdout, const std::filesystem::path& folder) {
  constexpr int kWidth = 160, kHeight = 120, kStripe = 20;
  test::Flight flight = test::MakeFlight({47.0, 8.0, 400.0});
  flight.model.cameras[1] = {camera::CameraModel::kPinhole, kWidth, kHeight, {150.0, 150.0, kWidth / 2.0, kHeight / 2.0}};
  const bool other = held_out == HeldOut::kOther;
  for (size_t i = 0; i < flight.photos.size(); ++i) {
    geo::Rigid3d& pose = flight.model.images[i].cam_from_world;
    pose.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
    const Eigen::Vector3d moved = other && i % 8 == 0 ? Eigen::Vector3d(6.0, -4.0, 9.0) : Eigen::Vector3d::Zero();
    pose.translation = -(pose.rotation * (flight.photos[i].centre_in_enu + moved));
  }
  for (size_t i = 0; i < flight.model.points.size(); ++i) {
    survey::ColmapPoint& point = flight.model.points[i];
    const geo::Similarity3d& a = flight.model_from_enu;
    point.x_in_world = a.rotation.conjugate() * (point.x_in_world - a.translation) / a.scale;
    const std::vector<std::vector<uint32_t>> given = {{1, 2, 3}, {1, 9, 17}, {2, 3, 4, 9}}, changed = {{2, 3}, {9}, {2, 3, 4}};
    point.image_ids = (other ? changed : given)[i % 3];
  }
  test::WriteFlight(flight, folder);
  for (size_t i = 0; i < flight.photos.size(); ++i) {
    image::Image8 stripes(kWidth, kHeight, 3);
    const int slope = other && i % 8 == 0 ? 1 : 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) std::fill_n(stripes.At(x, y), 3, static_cast<uint8_t>((x + slope * y) / kStripe % 2 == 0 ? 60 : 200));
    }
    const std::filesystem::path file = folder / "images" / flight.photos[i].name;
    image::SaveJpeg(stripes, file, 95);
    survey::WritePhotoTags(flight.photos[i].tags, file);
  }
  base::WriteFileAtomically(folder / "simulate.json", R"({"origin":{"latitude_deg":47.0,"longitude_deg":8.0,"height_m":400.0},"exact_frame":true})");
  PrepareOptions options;
  options.holdout = holdout;
  base::ThreadPool threads(2);
  return Prepare({folder, {}, folder / "out"}, options, threads);
}

TEST(Holdout, HeldOutPhotosLeaveNoTraceInPointsHeightsAndDirections) {
  const TemporaryFolder one, two;
  const survey::Survey given = PrepareFlight(HeldOut::kGiven, "every:8", one.path());
  const survey::Survey other = PrepareFlight(HeldOut::kOther, "every:8", two.path());
  ASSERT_TRUE(given.photos[8].is_test);
  EXPECT_NE(other.photos[8].cam_from_enu.translation, given.photos[8].cam_from_enu.translation);
  EXPECT_GT(given.points.size(), 300U);
  ASSERT_EQ(other.points.size(), given.points.size());
  for (size_t i = 0; i < given.points.size(); ++i) {
    EXPECT_EQ(other.points[i].x_in_enu, given.points[i].x_in_enu);
    EXPECT_EQ(other.points[i].track_length, given.points[i].track_length);
  }
  EXPECT_EQ(other.tracks, given.tracks);
  for (size_t i = 0; i < given.photos.size(); ++i) {
    if (given.photos[i].is_test) continue;
    EXPECT_EQ(other.photos[i].agl_m, given.photos[i].agl_m) << i;
  }
  EXPECT_EQ(given.directions.photos, 17);
  EXPECT_GT(given.directions.lines, 50);
  EXPECT_EQ(other.directions.photos, given.directions.photos);
  EXPECT_EQ(other.directions.lines, given.directions.lines);
  EXPECT_EQ(other.directions.histogram, given.directions.histogram);
}

TEST(Holdout, WithNoneHeldOutAllPhotosCount) {
  const TemporaryFolder one, two;
  const survey::Survey given = PrepareFlight(HeldOut::kGiven, "none", one.path());
  const survey::Survey other = PrepareFlight(HeldOut::kOther, "none", two.path());
  EXPECT_NE(other.points.size(), given.points.size());
  EXPECT_EQ(given.directions.photos, 20);
  EXPECT_NE(other.directions.histogram, given.directions.histogram);
}

}  // namespace
}  // namespace skyquilt::prepare
