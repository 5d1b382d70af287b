#include "prepare/georeference/tags/track.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/prepare/georeference/lawnmower_photos.h"

namespace skyquilt::prepare::georeference {
namespace {

using Eigen::Vector3d;

input::PreparedPhoto At(const Vector3d& position, std::optional<double> time_s) {
  input::PreparedPhoto photo = test::PreparedAt(position, {}, {});
  photo.file.tags.capture_time_s = time_s;
  return photo;
}

void ExpectAt(const TrackPoint& point, const Vector3d& position, const Vector3d& velocity) {
  EXPECT_LT((point.position - position).norm(), 1e-12) << point.position.transpose();
  EXPECT_LT((point.velocity - velocity).norm(), 1e-12) << point.velocity.transpose();
}

TEST(Track, IsStraightBetweenPhotosAndBeyondTheEnds) {
  // Not in the order of time.
  const std::vector<input::PreparedPhoto> photos = {At({30.0, 0.0, 5.0}, 14.0), At({0.0, 0.0, 5.0}, 10.0), At({10.0, 0.0, 5.0}, 12.0),
                                                    At({30.0, 8.0, 5.0}, 16.0)};
  const Track track(photos, {0, 0, 0, 0});
  EXPECT_EQ(track.order(), (std::vector<size_t>{1, 2, 0, 3}));
  EXPECT_TRUE(track.timed());
  const Vector3d slow(5.0, 0.0, 0.0), fast(10.0, 0.0, 0.0), north(0.0, 4.0, 0.0);
  ExpectAt(track.Before(0, 0.0), {30.0, 0.0, 5.0}, fast);  // the line just flown
  ExpectAt(track.Before(0, 0.5), {25.0, 0.0, 5.0}, fast);
  ExpectAt(track.Before(0, 3.0), {5.0, 0.0, 5.0}, slow);
  ExpectAt(track.Before(0, -1.0), {30.0, 4.0, 5.0}, north);
  ExpectAt(track.Before(1, 0.0), {0.0, 0.0, 5.0}, slow);
  ExpectAt(track.Before(1, 2.0), {-10.0, 0.0, 5.0}, slow);
  ExpectAt(track.Before(3, -2.0), {30.0, 16.0, 5.0}, north);
}

TEST(Track, DoesNotRunFromOneFlightToTheNext) {
  const std::vector<input::PreparedPhoto> photos = {At({0.0, 0.0, 0.0}, 0.0), At({2.0, 0.0, 0.0}, 1.0), At({100.0, 0.0, 0.0}, 2.0),
                                                    At({100.0, 3.0, 0.0}, 3.0)};
  const Track track(photos, {0, 0, 1, 1});
  ExpectAt(track.Before(2, 0.5), {100.0, -1.5, 0.0}, {0.0, 3.0, 0.0});
  ExpectAt(track.Before(1, -0.5), {3.0, 0.0, 0.0}, {2.0, 0.0, 0.0});
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(track.Phase(i), i % 2 == 0 ? -0.5 : 0.5);
}

TEST(Track, PhotosOfTheSameSecondStayApart) {
  const std::vector<input::PreparedPhoto> photos = {At({0.0, 0.0, 0.0}, 0.0), At({4.0, 0.0, 0.0}, 2.0), At({5.0, 0.0, 0.0}, 2.0),
                                                    At({8.0, 0.0, 0.0}, 4.0)};
  const Track track(photos, {0, 0, 0, 0});
  ExpectAt(track.Before(1, 0.0), {4.0, 0.0, 0.0}, {2.0, 0.0, 0.0});
  ExpectAt(track.Before(2, 0.0), {5.0, 0.0, 0.0}, {2.0, 0.0, 0.0});
  EXPECT_EQ(track.Phase(1), 0.0);
  EXPECT_EQ(track.Phase(2), 0.0);

  std::vector<input::PreparedPhoto> same = photos;
  for (input::PreparedPhoto& photo : same) photo.file.tags.capture_time_s = 7.0;
  const Track still(same, {0, 0, 0, 0});
  EXPECT_FALSE(still.timed());
  ExpectAt(still.Before(3, 1.0), {8.0, 0.0, 0.0}, Vector3d::Zero());
  for (size_t i = 0; i < 4; ++i) EXPECT_NEAR(still.Phase(i), static_cast<double>(i) / 3.0 - 0.5, 1e-15);
}

TEST(Track, PhotosWithoutTimeDoNotMove) {
  std::vector<input::PreparedPhoto> photos = {At({0.0, 0.0, 0.0}, 0.0), At({9.0, 9.0, 9.0}, std::nullopt), At({3.0, 0.0, 0.0}, 3.0)};
  const Track track(photos, {0, 0, 0});
  EXPECT_FALSE(track.timed());  // two of three have a time
  EXPECT_EQ(track.order(), (std::vector<size_t>{0, 2, 1}));
  ExpectAt(track.Before(1, 1.0), {9.0, 9.0, 9.0}, Vector3d::Zero());
  ExpectAt(track.Before(2, 1.0), {2.0, 0.0, 0.0}, {1.0, 0.0, 0.0});
  EXPECT_EQ(track.Phase(1), 0.0);

  for (input::PreparedPhoto& photo : photos) photo.file.tags.capture_time_s.reset();
  const Track by_name(photos, {0, 0, 0});
  EXPECT_EQ(by_name.order(), (std::vector<size_t>{0, 1, 2}));
  for (size_t i = 0; i < 3; ++i) EXPECT_EQ(by_name.Phase(i), 0.5 * static_cast<double>(i) - 0.5);
  EXPECT_EQ(Track({photos[0]}, {0}).Phase(0), 0.0);
  EXPECT_TRUE(Track({}, {}).order().empty());
}

TEST(Track, AHoveringCameraTellsNoLag) {
  std::vector<input::PreparedPhoto> photos;
  photos.reserve(10);
  for (int i = 0; i < 10; ++i) photos.push_back(At({i < 7 ? 0.0 : i, 0.0, 0.0}, i));
  EXPECT_FALSE(Track(photos, std::vector<int>(10, 0)).timed());
  for (int i = 0; i < 10; ++i) photos[static_cast<size_t>(i)] = At({i < 4 ? 0.0 : i, 0.0, 0.0}, i);
  EXPECT_TRUE(Track(photos, std::vector<int>(10, 0)).timed());
}

}  // namespace
}  // namespace skyquilt::prepare::georeference
