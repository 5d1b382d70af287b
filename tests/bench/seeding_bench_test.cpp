#include "bench/study/seeding_bench.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/errors.h"
#include "core/base/progress.h"
#include "tests/support/error_of.h"

namespace skyquilt::bench {
namespace {

camera::Camera SeedingCamera() {
  return {camera::CameraModel::kSimpleRadial, 1600, 1200, {1250.0, 800.0, 600.0, -0.02}};
}

// Lines of photos 80 m above hilly ground.
std::vector<simulate::PhotoPlan> SeedingFlight(int lines, int per_line) {
  std::vector<simulate::PhotoPlan> photos;
  for (int i = 0; i < lines * per_line; ++i) {
    simulate::PhotoPlan photo;
    photo.name = simulate::PhotoName(static_cast<size_t>(i));
    photo.tagged_position = {28.0 * (i / per_line), 18.0 * (i % per_line), 80.0 + i % 3};
    const double yaw_deg = i / per_line % 2 == 0 ? 2.0 : 181.0, pitch_deg = -89.0 + 0.5 * (i % 2);
    photo.cam_from_enu = simulate::PoseFromGimbal(photo.tagged_position, yaw_deg, pitch_deg, 0.0);
    photo.tagged_gimbal = simulate::GimbalAngles{yaw_deg, pitch_deg, 0.0};
    photo.relative_altitude_m = 80.0;
    photos.push_back(photo);
  }
  return photos;
}

std::vector<survey::ColmapPoint> PointsBelow(const camera::Camera& camera, const std::vector<simulate::PhotoPlan>& photos) {
  std::vector<survey::ColmapPoint> points;
  for (double x = -60.0; x < 150.0; x += 3.0) {
    for (double y = -60.0; y < 150.0; y += 3.0) {
      survey::ColmapPoint point;
      point.x_in_world = {x, y, 4.0 * std::sin(0.1 * x) * std::cos(0.07 * y)};
      for (size_t i = 0; i < photos.size(); ++i) {
        const auto pixel = camera.ImgFromCam(photos[i].cam_from_enu * point.x_in_world);
        const bool inside = pixel && pixel->minCoeff() > 0.0 && pixel->x() < camera.width && pixel->y() < camera.height;
        if (inside) point.image_ids.push_back(static_cast<uint32_t>(i + 1));
      }
      if (point.image_ids.size() >= 3) points.push_back(point);
    }
  }
  return points;
}

SimulatedTracks TracksWith(const TrackErrors& errors) {
  const std::vector<simulate::PhotoPlan> photos = SeedingFlight(4, 6);
  const geo::EnuFrame frame({47.0, 8.0, 400.0});
  return MakeTracks(SeedingCamera(), photos, PointsBelow(SeedingCamera(), photos), frame, errors);
}

// Features by their places, so that those of equal points can be found in another photo.
using Pixel = std::pair<float, float>;
Pixel PixelOf(const prepare::poses::SeedPhoto& photo, uint32_t feature) {
  return {photo.features[feature].x(), photo.features[feature].y()};
}

TEST(MakeTracks, MatchesTheSamePointsWithoutErrors) {
  const SimulatedTracks tracks = TracksWith({.noise_px = 0.0, .seen_share = 1.0, .wrong_share = 0.0, .focal_share = 0.0});
  const std::vector<simulate::PhotoPlan> photos = SeedingFlight(4, 6);
  const camera::Camera camera = SeedingCamera();
  // The point of every feature, by projecting all points again.
  std::vector<std::map<Pixel, size_t>> point_at(photos.size());
  const std::vector<survey::ColmapPoint> points = PointsBelow(camera, photos);
  for (size_t p = 0; p < points.size(); ++p) {
    for (const uint32_t id : points[p].image_ids) {
      const Eigen::Vector2f pixel = camera.ImgFromCam(photos[id - 1].cam_from_enu * points[p].x_in_world)->cast<float>();
      point_at[id - 1][{pixel.x(), pixel.y()}] = p;
    }
  }
  size_t n_matches = 0;
  for (const prepare::poses::PairMatches& pair : tracks.input.pairs) {
    EXPECT_LT(pair.image_a, pair.image_b);
    for (const auto& [a, b] : pair.features) {
      const size_t p = point_at[pair.image_a - 1].at(PixelOf(tracks.input.photos[pair.image_a - 1], a));
      EXPECT_EQ(p, point_at[pair.image_b - 1].at(PixelOf(tracks.input.photos[pair.image_b - 1], b)));
      ++n_matches;
    }
  }
  EXPECT_EQ(n_matches, tracks.n_matches);
  EXPECT_GT(n_matches, 10'000U);
  EXPECT_EQ(tracks.n_wrong, 0U);
}

TEST(MakeTracks, HasAsManyErrorsAsAskedFor) {
  const SimulatedTracks all = TracksWith({.noise_px = 0.0, .seen_share = 1.0, .wrong_share = 0.0, .focal_share = 0.0});
  const SimulatedTracks noisy = TracksWith({.noise_px = 0.5, .seen_share = 1.0, .wrong_share = 0.1, .focal_share = 0.03});
  ASSERT_EQ(noisy.n_features, all.n_features) << "errors must not change which points are seen";
  double squares = 0.0;
  for (size_t i = 0; i < all.input.photos.size(); ++i) {
    for (size_t f = 0; f < all.input.photos[i].features.size(); ++f)
      squares += (noisy.input.photos[i].features[f] - all.input.photos[i].features[f]).cast<double>().squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(0.5 * squares / static_cast<double>(all.n_features)), 0.5, 0.02);
  size_t differing = 0;
  for (size_t k = 0; k < all.input.pairs.size(); ++k) {
    for (size_t m = 0; m < all.input.pairs[k].features.size(); ++m)
      differing += noisy.input.pairs[k].features[m] != all.input.pairs[k].features[m] ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(differing) / static_cast<double>(all.n_matches), 0.1, 0.01);
  EXPECT_NEAR(noisy.input.cameras.at(1).camera.FocalX() / SeedingCamera().FocalX(), 1.03, 1e-9);
  const SimulatedTracks half = TracksWith({.seen_share = 0.5});
  EXPECT_NEAR(static_cast<double>(half.n_features) / static_cast<double>(all.n_features), 0.5, 0.03);
}

SeedingOptions HamletSeeding() {
  SeedingOptions options;
  options.photos = {12};
  options.simulate.place = "hamlet";
  options.simulate.image_width = 1600;
  options.features_per_photo = 400.0;
  options.errors.seen_share = 0.5;
  return options;
}

TEST(SeedingBench, PlacesAFlightWhateverTheThreads) {
  base::Progress::SetQuiet(true);
  const SeedingResult result = RunSeedingBench(HamletSeeding());
  ASSERT_EQ(result.rows.size(), 2U);
  for (const SeedingRow& row : result.rows) {
    EXPECT_EQ(row.failure, "");
    EXPECT_EQ(row.score.right, 12U);
    EXPECT_LT(row.score.position_m, 0.2);
    EXPECT_GT(row.seconds, 0.0);
    EXPECT_GE(row.peak_bytes, row.input_bytes);
    EXPECT_NEAR(row.features_per_photo, 400.0, 60.0);
  }
  EXPECT_EQ(result.rows[0].threads, 1);
  EXPECT_EQ(result.rows[1].threads, 2);
  EXPECT_EQ(result.rows[0].score.position_m, result.rows[1].score.position_m) << "bits depend on the threads";
}

TEST(SeedingBench, RefusesWhatItCannotMeasure) {
  SeedingOptions options = HamletSeeding();
  options.photos = {12, 12};
  EXPECT_NE(ErrorOf<base::UsageError>([&] { RunSeedingBench(options); }).find("--photos"), std::string::npos);
  options.photos = {9000};
  EXPECT_NE(ErrorOf<base::UsageError>([&] { RunSeedingBench(options); }).find("--photos 9000"), std::string::npos);
}

SeedingResult SeedingSample(double power) {
  SeedingResult result{.place = "hamlet", .errors = {}, .rows = {}};
  for (const int photos : {500, 1000, 2000}) {
    SeedingRow row{.photos = photos, .threads = 2, .seconds = 3.0 * std::pow(photos / 500.0, power), .input_bytes = 1e8, .peak_bytes = 2e8};
    row.score.n_photos = row.score.registered = row.score.right = static_cast<size_t>(photos);
    result.rows.push_back(row);
  }
  return result;
}

TEST(SeedingPage, SaysWhatIsMetAndWhatIsMissed) {
  const BenchPage good = SeedingPage(SeedingSample(1.05), "skyquilt bench seeding");
  ASSERT_EQ(good.verdicts.size(), 2U);
  for (const std::string& verdict : good.verdicts) EXPECT_TRUE(verdict.starts_with("Met")) << verdict;
  EXPECT_TRUE(SeedingPage(SeedingSample(1.3), "").verdicts[1].starts_with("Missed"));
  SeedingResult unfinished = SeedingSample(1.0);
  unfinished.rows.push_back(unfinished.rows.back());
  unfinished.rows.back().threads = 4;
  EXPECT_EQ(SeedingPage(unfinished, "").verdicts[1].find("4 threads"), std::string::npos) << "one size tells nothing of growth";
  SeedingResult wrong = SeedingSample(1.0);
  wrong.rows[1].score.right = 990;
  const std::string verdict = SeedingPage(wrong, "").verdicts[0];
  EXPECT_TRUE(verdict.starts_with("Missed")) << verdict;
  EXPECT_NE(verdict.find("990 of 1000 with 2 threads"), std::string::npos) << verdict;
}

}  // namespace
}  // namespace skyquilt::bench
