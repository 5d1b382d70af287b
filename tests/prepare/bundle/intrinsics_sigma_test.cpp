#include "prepare/bundle/intrinsics_sigma.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/linear/linear.h"
#include "prepare/bundle/camera_sample.h"
#include "prepare/bundle/entry_term.h"

namespace skyquilt::prepare::bundle {
namespace {

using Eigen::Index;

struct GridModel {
  survey::ColmapModel model;
  survey::ColmapObservations observations;
  double K1Sigma() const { return MeasureLensAccuracy(model, observations, 1).k1_sigma; }
  double FocalSigma() const { return MeasureLensAccuracy(model, observations, 1).focal_sigma; }
};

// `side` x `side` photos 15 m apart, 50 m above ground with `relief_m` of random height, looking straight down except that every third leans by
// `lean_deg`. Points every `spacing_m`; pixels with normal noise.
GridModel MakeGrid(const camera::Camera& camera, int side, double lean_deg, double relief_m, double spacing_m, double noise_px) {
  GridModel grid;
  base::Random random(5);
  grid.model.cameras[1] = camera;
  for (int i = 0; i < side * side; ++i) {
    survey::ColmapImage image;
    image.id = static_cast<uint32_t>(i + 1);
    image.camera_id = 1;
    image.name = "p" + std::to_string(1000 + i);
    const int row = i / side;
    const Eigen::Vector3d centre(15.0 * (i % side), 15.0 * row, 50.0);
    const double lean = i % 3 == 0 ? lean_deg * M_PI / 180.0 : 0.0;
    const Eigen::Vector3d axis(std::cos(2.0 * i), std::sin(2.0 * i), 0.0);
    image.cam_from_world.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(lean, axis)) * Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
    image.cam_from_world.translation = -(image.cam_from_world.rotation * centre);
    grid.model.images.push_back(image);
    grid.observations[image.id] = {};
  }
  const double size = 15.0 * side + 30.0;
  for (double x = -40.0; x < size; x += spacing_m) {
    for (double y = -40.0; y < size; y += spacing_m) {
      survey::ColmapPoint point;
      point.id = grid.model.points.size() + 100;
      point.x_in_world = Eigen::Vector3d(x, y, relief_m * random.Normal());
      for (const survey::ColmapImage& image : grid.model.images) {
        const auto pixel = camera.ImgFromCam(image.cam_from_world * point.x_in_world);
        if (!pixel || (pixel->array() < 0.0).any() || pixel->x() > camera.width || pixel->y() > camera.height) continue;
        grid.observations[image.id].push_back({point.id, *pixel + noise_px * Eigen::Vector2d{random.Normal(), random.Normal()}});
      }
      grid.model.points.push_back(point);
    }
  }
  return grid;
}

camera::Camera SimpleRadial() {
  return {camera::CameraModel::kSimpleRadial, 1000, 800, {900.0, 500.0, 400.0, -0.03}};
}

// Standard deviation of one of the camera's free parameters by the whole matrix of derivatives, its pseudo-inverse and nothing else.
double DenseSigma(const GridModel& grid, const std::vector<size_t>& free, size_t parameter) {
  struct Row {
    size_t image, point;
    Eigen::Vector2d pixel;
  };
  std::vector<Row> rows;
  std::vector<size_t> used;  // points seen by at least three photos
  for (size_t p = 0; p < grid.model.points.size(); ++p) {
    std::vector<Row> of_point;
    for (size_t i = 0; i < grid.model.images.size(); ++i) {
      for (const survey::ColmapObservation& o : grid.observations.at(grid.model.images[i].id)) {
        if (o.point_id == grid.model.points[p].id) of_point.push_back({i, used.size(), o.pixel});
      }
    }
    if (of_point.size() < 3) continue;
    used.push_back(p);
    rows.insert(rows.end(), of_point.begin(), of_point.end());
  }
  const size_t n_images = grid.model.images.size();
  const size_t n_unknowns = 6 * n_images + free.size() + 3 * used.size();
  const auto project = [&](const Row& row, const Eigen::VectorXd& x) {
    const geo::Rigid3d& pose = grid.model.images[row.image].cam_from_world;
    camera::Camera camera = grid.model.cameras.at(1);
    for (size_t k = 0; k < free.size(); ++k) camera.params[free[k]] += x[static_cast<Index>(6 * n_images + k)];
    const Eigen::Vector3d turn = x.segment<3>(static_cast<Index>(6 * row.image));
    const Eigen::Vector3d shift = x.segment<3>(static_cast<Index>(6 * row.image + 3));
    const Eigen::Vector3d point =
        grid.model.points[used[row.point]].x_in_world + x.segment<3>(static_cast<Index>(6 * n_images + free.size() + 3 * row.point));
    const Eigen::Matrix3d rotation =
        turn.norm() > 0.0 ? Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() : Eigen::Matrix3d::Identity();
    return camera.ImgFromCam(rotation * (pose.rotation * point) + pose.translation + shift).value();
  };
  Eigen::MatrixXd jacobian(2 * static_cast<Index>(rows.size()), static_cast<Index>(n_unknowns));
  double squares = 0.0;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(static_cast<Index>(n_unknowns));
  for (size_t r = 0; r < rows.size(); ++r) squares += (rows[r].pixel - project(rows[r], x)).squaredNorm();
  for (Index u = 0; u < x.size(); ++u) {
    const double step = u >= static_cast<Index>(6 * n_images + free.size()) ? 1e-4 : 1e-5;
    for (size_t r = 0; r < rows.size(); ++r) {
      x[u] = step;
      const Eigen::Vector2d ahead = project(rows[r], x);
      x[u] = -step;
      jacobian.block<2, 1>(2 * static_cast<Index>(r), u) = (ahead - project(rows[r], x)) / (2.0 * step);
      x[u] = 0.0;
    }
  }
  // The pseudo-inverse of J^T J with columns of length 1. Its seven smallest eigenvalues are those of moves, turns and a scaling of everything.
  const Eigen::VectorXd norms = jacobian.colwise().norm();
  jacobian *= norms.cwiseInverse().asDiagonal();
  const linear::EigenPairs<Eigen::Dynamic> eigen = linear::SymmetricEigen<Eigen::Dynamic>(jacobian.transpose() * jacobian);
  if (!eigen.found) return std::nan("");
  const auto at = static_cast<Index>(6 * n_images) + (std::find(free.begin(), free.end(), parameter) - free.begin());
  double variance = 0.0;
  for (Index i = 7; i < x.size(); ++i) variance += std::pow(eigen.vectors(at, i) / norms[at], 2) / eigen.values[i];
  return std::sqrt(variance * squares / (2.0 * static_cast<double>(rows.size()) - static_cast<double>(x.size() - 7)));
}

TEST(IntrinsicsSigma, IsThatOfTheWholeAdjustment) {
  const GridModel simple = MakeGrid(SimpleRadial(), 3, 15.0, 3.0, 9.0, 0.5);
  EXPECT_NEAR(simple.K1Sigma() / DenseSigma(simple, {0, 3}, 3), 1.0, 1e-6);
  EXPECT_NEAR(900.0 * simple.FocalSigma() / DenseSigma(simple, {0, 3}, 0), 1.0, 1e-4);
  // A principal point off the middle was adjusted too.
  camera::Camera opencv{camera::CameraModel::kOpencv, 1000, 800, {900.0, 905.0, 503.0, 396.0, -0.03, 0.01, 1e-3, -2e-3}};
  const GridModel all = MakeGrid(opencv, 3, 15.0, 3.0, 9.0, 0.5);
  EXPECT_NEAR(all.K1Sigma() / DenseSigma(all, {0, 1, 2, 3, 4, 5, 6, 7}, 4), 1.0, 1e-6);
  camera::Camera fisheye{camera::CameraModel::kOpencvFisheye, 1000, 800, {900.0, 905.0, 500.0, 400.0, -0.03, 0.01, 1e-3, -2e-3}};
  const GridModel theta = MakeGrid(fisheye, 3, 15.0, 3.0, 9.0, 0.5);
  EXPECT_NEAR(theta.K1Sigma() / DenseSigma(theta, {0, 1, 4, 5, 6, 7}, 4), 1.0, 1e-6);
  camera::Camera radial_fisheye{camera::CameraModel::kRadialFisheye, 1000, 800, {900.0, 500.0, 400.0, -0.03, 0.01}};
  const GridModel two = MakeGrid(radial_fisheye, 3, 15.0, 3.0, 9.0, 0.5);
  EXPECT_NEAR(two.K1Sigma() / DenseSigma(two, {0, 3, 4}, 3), 1.0, 1e-6);
}

TEST(IntrinsicsSigma, FlatNadirFlightsDetermineTheLensWorse) {
  const auto sigma = [](double lean_deg) { return MakeGrid(SimpleRadial(), 6, lean_deg, 0.0, 5.0, 0.5).K1Sigma(); };
  const double oblique = sigma(20.0);
  const double nearly_nadir = sigma(2.0);
  EXPECT_GT(nearly_nadir, 8.0 * oblique);
  EXPECT_LT(nearly_nadir, 20.0 * oblique);
  // Exactly parallel cameras at one height: a bent ground, tilts and heights of the cameras explain any k1 (James and Robson, 2014).
  const double nadir = sigma(0.0);
  EXPECT_GT(nadir, 1e3 * oblique);
  EXPECT_TRUE(std::isfinite(nadir));
}

// Photos that look straight down leave focal length and height open together; leaning ones tell them apart.
TEST(IntrinsicsSigma, FlatNadirFlightsDetermineTheFocalLengthWorse) {
  const auto sigma = [](double lean_deg) { return MakeGrid(SimpleRadial(), 6, lean_deg, 0.0, 5.0, 0.5).FocalSigma(); };
  const double oblique = sigma(20.0), nearly_nadir = sigma(2.0);
  EXPECT_LT(oblique, 0.01);
  EXPECT_GT(nearly_nadir, 5.0 * oblique);
  const double nadir = sigma(0.0);
  EXPECT_GT(nadir, 0.5);
  EXPECT_TRUE(std::isfinite(nadir));
}

TEST(IntrinsicsSigma, DoesNotDependOnTheFrame) {
  GridModel grid = MakeGrid(SimpleRadial(), 4, 10.0, 2.0, 8.0, 0.5);
  const double before = grid.K1Sigma();
  const geo::Similarity3d other{0.02, Eigen::Quaterniond(0.6, -0.3, 0.5, 0.2).normalized(), Eigen::Vector3d(3.0, -2.0, 10.0)};
  for (survey::ColmapImage& image : grid.model.images) image.cam_from_world = geo::TransformCameraWorld(image.cam_from_world, other);
  for (survey::ColmapPoint& point : grid.model.points) point.x_in_world = other * point.x_in_world;
  EXPECT_NEAR(grid.K1Sigma() / before, 1.0, 1e-6);
}

TEST(IntrinsicsSigma, GrowsWithTheNoise) {
  const LensAccuracy little = [] {
    const GridModel grid = MakeGrid(SimpleRadial(), 4, 10.0, 2.0, 8.0, 0.2);
    return MeasureLensAccuracy(grid.model, grid.observations, 1);
  }();
  const GridModel grid = MakeGrid(SimpleRadial(), 4, 10.0, 2.0, 8.0, 0.8);
  const LensAccuracy much = MeasureLensAccuracy(grid.model, grid.observations, 1);
  EXPECT_NEAR(much.k1_sigma / little.k1_sigma, 4.0, 0.01);
  EXPECT_NEAR(much.focal_sigma / little.focal_sigma, 4.0, 0.01);
  EXPECT_NEAR(much.sigma0_px / little.sigma0_px, 4.0, 0.01);
  EXPECT_EQ(much.n_photos, 16);
}

TEST(IntrinsicsSigma, IsUnknownWhenNothingCanBeSaid) {
  const auto unknown = [](const GridModel& grid) {
    EXPECT_EQ(std::isnan(grid.FocalSigma()), std::isnan(grid.K1Sigma()));
    return std::isnan(grid.K1Sigma());
  };
  EXPECT_FALSE(unknown(MakeGrid(SimpleRadial(), 3, 10.0, 2.0, 10.0, 0.5)));
  // Projections of the points, not measurements.
  EXPECT_TRUE(unknown(MakeGrid(SimpleRadial(), 3, 10.0, 2.0, 10.0, 0.0)));
  // No distortion that was adjusted.
  EXPECT_TRUE(unknown(MakeGrid({camera::CameraModel::kPinhole, 1000, 800, {900.0, 900.0, 500.0, 400.0}}, 3, 10.0, 2.0, 10.0, 0.5)));
  EXPECT_TRUE(unknown(MakeGrid({camera::CameraModel::kSimpleRadial, 1000, 800, {900.0, 500.0, 400.0, 0.0}}, 3, 10.0, 2.0, 10.0, 0.5)));
  EXPECT_TRUE(unknown(MakeGrid(SimpleRadial(), 1, 0.0, 2.0, 10.0, 0.5)));
  GridModel grid = MakeGrid(SimpleRadial(), 3, 10.0, 2.0, 10.0, 0.5);
  EXPECT_TRUE(std::isnan(MeasureLensAccuracy(grid.model, grid.observations, 2).k1_sigma));
  grid.model.points.clear();
  EXPECT_TRUE(unknown(grid));
  grid = MakeGrid(SimpleRadial(), 3, 10.0, 2.0, 10.0, 0.5);
  grid.observations.clear();
  EXPECT_TRUE(unknown(grid));
  EXPECT_TRUE(unknown({}));
  // All photos at one place: points have no depth.
  grid = MakeGrid(SimpleRadial(), 3, 0.0, 0.0, 10.0, 0.5);
  for (survey::ColmapImage& image : grid.model.images) image.cam_from_world = grid.model.images[4].cam_from_world;
  EXPECT_FALSE(std::isinf(grid.K1Sigma()));
}

size_t CountPlaced(const CameraSample& sample) {
  return static_cast<size_t>(
      std::count_if(sample.bundle.photos.begin(), sample.bundle.photos.end(), [](const BundlePhoto& photo) { return photo.placed; }));
}

size_t CountPoints(const CameraSample& sample) {
  return static_cast<size_t>(std::count(sample.bundle.has_point.begin(), sample.bundle.has_point.end(), 1));
}

TEST(CameraSample, TakesPhotosFromTheMiddleAndPointsEvenly) {
  const GridModel grid = MakeGrid(SimpleRadial(), 6, 0.0, 2.0, 5.0, 0.5);
  const CameraSample whole = SelectSample(grid.model, grid.observations, 1, 100, 100000);
  EXPECT_EQ(CountPlaced(whole), 36U);
  EXPECT_EQ(whole.share_of_points, 1.0);
  const CameraSample part = SelectSample(grid.model, grid.observations, 1, 20, 100);
  EXPECT_EQ(CountPlaced(part), 20U);
  EXPECT_EQ(part.bundle.photos.front().centre, grid.model.images[8].cam_from_world.OriginInSource());
  EXPECT_LE(CountPoints(part), 100U);
  EXPECT_GT(CountPoints(part), 90U);
  EXPECT_LT(part.share_of_points, 0.5);
}

TEST(CameraSample, KeepsTheLargestConnectedGroup) {
  GridModel grid = MakeGrid(SimpleRadial(), 4, 0.0, 2.0, 5.0, 0.5);
  // The first three photos see points of their own, the fourth sees nothing.
  const size_t n_points = grid.model.points.size();
  for (size_t p = 0; p < n_points; ++p) {
    survey::ColmapPoint point = grid.model.points[p];
    point.id += 100000;
    grid.model.points.push_back(point);
  }
  for (uint32_t id = 1; id <= 3; ++id) {
    for (survey::ColmapObservation& o : grid.observations[id]) o.point_id += 100000;
  }
  grid.observations[4].clear();
  const CameraSample selected = SelectSample(grid.model, grid.observations, 1, 100, 100000);
  EXPECT_EQ(CountPlaced(selected), 12U);
  EXPECT_GT(CountPoints(selected), 0U);
  for (uint32_t t = 0; t < selected.bundle.tracks.size(); ++t) {
    if (selected.bundle.has_point[t] == 0) continue;
    uint32_t sightings = 0;
    for (uint32_t e = selected.bundle.tracks.first[t]; e < selected.bundle.tracks.first[t + 1]; ++e) sightings += Counts(selected.bundle, e) ? 1 : 0;
    ASSERT_GE(sightings, 3U);
  }
  EXPECT_TRUE(std::isfinite(grid.K1Sigma()));
}

}  // namespace
}  // namespace skyquilt::prepare::bundle
