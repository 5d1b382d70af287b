#include "prepare/control/fit/fit_control.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/errors.h"
#include "core/geo/enu_frame.h"
#include "tests/prepare/control/fit/made_control.h"

namespace skyquilt::test {
namespace {

using namespace prepare::control;
using survey::ControlUse;

base::ThreadPool& Threads() {
  static base::ThreadPool threads(2);
  return threads;
}

struct Rmse {
  double horizontal_m = 0.0, vertical_m = 0.0, gsd_m = 0.0;
  int n = 0;
};

Rmse RmseOf(const survey::ControlFit& fit, ControlUse use) {
  Rmse rmse;
  for (const survey::ControlPointFit& point : fit.points) {
    if (point.use != use) continue;
    rmse.horizontal_m += point.error_m.head<2>().squaredNorm();
    rmse.vertical_m += point.error_m.z() * point.error_m.z();
    rmse.gsd_m += point.gsd_m;
    ++rmse.n;
  }
  rmse.horizontal_m = std::sqrt(rmse.horizontal_m / rmse.n);
  rmse.vertical_m = std::sqrt(rmse.vertical_m / rmse.n);
  rmse.gsd_m /= rmse.n;
  return rmse;
}

const survey::Problem* FindProblem(const PlacedByControl& placed, const std::string& code) {
  for (const survey::Problem& problem : placed.problems) {
    if (problem.code == code) return &problem;
  }
  return nullptr;
}

void ExpectAccurate(const PlacedByControl& placed, int n_check) {
  const Rmse rmse = RmseOf(placed.fit, ControlUse::kCheck);
  EXPECT_EQ(rmse.n, n_check);
  EXPECT_NEAR(rmse.gsd_m, 0.064, 0.004);
  EXPECT_LT(rmse.horizontal_m, rmse.gsd_m);
  EXPECT_LT(rmse.vertical_m, 1.5 * rmse.gsd_m);
  EXPECT_TRUE(placed.fit.placed);
  EXPECT_TRUE(placed.fit.adjusted);
  for (const survey::Problem& problem : placed.problems) ADD_FAILURE() << problem.code << ": " << problem.finding;
}

TEST(FitControl, PlacesASurveyOfWhichNothingElseIsKnown) {
  MadeControl made = MakeControl({.own_frame = true, .tags = false}, Threads());
  const PlacedByControl placed = FitControl(made.Job(), Threads());
  ExpectAccurate(placed, 10);
  EXPECT_NEAR(placed.scale, 1.0 / 0.037, 0.5);
  // The lens, bent by nothing but tags before, is the true one; so are the poses and the points of the model.
  EXPECT_NEAR(made.model.cameras.begin()->second.FocalX(), made.true_focal_px, 3.0);
  const geo::EnuFrame frame(placed.origin), truth(kMadeOrigin);
  double worst_m = 0.0;
  for (size_t i = 0; i < made.true_poses.size(); ++i) {
    const Eigen::Vector3d centre = made.model.images[i].cam_from_world.OriginInSource();
    worst_m = std::max(worst_m, (truth.EnuFromGeodetic(frame.GeodeticFromEnu(centre)) - made.true_poses[i].OriginInSource()).norm());
  }
  EXPECT_LT(worst_m, 0.5);
  std::map<uint64_t, Eigen::Vector3d> place;
  for (const survey::ColmapPoint& point : made.model.points) place.emplace(point.id, point.x_in_world);
  double sum = 0.0, n = 0.0;
  for (const survey::ColmapImage& image : made.model.images) {
    for (const survey::ColmapObservation& observation : made.observations.at(image.id)) {
      const auto pixel = made.model.cameras.at(image.camera_id).ImgFromCam(image.cam_from_world * place.at(observation.point_id));
      ASSERT_TRUE(pixel);
      sum += (*pixel - observation.pixel).norm();
      n += 1.0;
    }
  }
  EXPECT_LT(sum / n, 0.8);
  EXPECT_LT(placed.accuracy.horizontal_m, 0.03);
  EXPECT_GT(placed.accuracy.horizontal_m, 0.001);
  EXPECT_LT(placed.accuracy.vertical_m, 0.08);
}

TEST(FitControl, TagsThatAreOffBy20MetresDoNotPull) {
  MadeControl made = MakeControl({.tag_shift_m = {16.0, -12.0, 20.0}}, Threads());
  ExpectAccurate(FitControl(made.Job(), Threads()), 10);
}

TEST(FitControl, NamesAPointThatIsWrongByFiveMetres) {
  for (const Eigen::Vector3d& by : {Eigen::Vector3d(5.0, 0.0, 0.0), Eigen::Vector3d(0.0, 0.0, -5.0), Eigen::Vector3d(0.4, 0.0, 0.0)}) {
    MadeControl made = MakeControl({.own_frame = true, .tags = false}, Threads());
    Displace(made.control.points[3], by);
    const PlacedByControl placed = FitControl(made.Job(), Threads());
    const survey::Problem* problem = FindProblem(placed, "control_point_wrong");
    ASSERT_NE(problem, nullptr) << by.transpose();
    EXPECT_NE(problem->finding.find("'T4'"), std::string::npos) << problem->finding;
    EXPECT_NE(problem->advice.find("line 5"), std::string::npos) << problem->advice;
    EXPECT_EQ(placed.problems.size(), 1U);
    EXPECT_EQ(placed.fit.points[3].use, ControlUse::kRejected);
    EXPECT_LT((placed.fit.points[3].error_m + by).norm(), 0.2);
    EXPECT_LT(RmseOf(placed.fit, ControlUse::kCheck).horizontal_m, 0.064);
  }
}

TEST(FitControl, NamesAWrongMark) {
  for (const int marks : {3, 5}) {
    for (const double off_px : {12.0, 60.0}) {
      MadeControl made = MakeControl({.marks = marks, .own_frame = true, .tags = false}, Threads());
      made.control.points[2].marks[1].pixel += Eigen::Vector2d(off_px, -off_px);
      const PlacedByControl placed = FitControl(made.Job(), Threads());
      const survey::ControlPointFit& point = placed.fit.points[2];
      EXPECT_EQ(point.use, ControlUse::kControl);
      ASSERT_EQ(point.marks.size(), static_cast<size_t>(marks));
      for (size_t k = 0; k < point.marks.size(); ++k) EXPECT_EQ(point.marks[k].used, k != 1) << marks << " marks, " << off_px << " px, mark " << k;
      EXPECT_NEAR(point.marks[1].error_px, std::sqrt(2.0) * off_px, 4.0);
      const survey::Problem* problem = FindProblem(placed, "control_mark_wrong");
      ASSERT_NE(problem, nullptr);
      EXPECT_NE(problem->finding.find("'T3' on " + point.marks[1].photo), std::string::npos) << problem->finding;
      EXPECT_LT(RmseOf(placed.fit, ControlUse::kCheck).horizontal_m, 0.064);
    }
  }
}

TEST(FitControl, FewPointsOrPointsOnOneLineAreRefusedOrOnlyCompared) {
  MadeControl few = MakeControl({.control = 5, .check = 3}, Threads());
  for (size_t i = 2; i < 5; ++i) few.control.points[i].marks.resize(1);
  const auto message = [](MadeControl& made) {
    try {
      FitControl(made.Job(), Threads());
    } catch (const base::InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(message(few).find("targets.txt: only 2 control points can be used: T1, T2"), std::string::npos) << message(few);

  MadeControl line = MakeControl({.control = 5, .check = 3}, Threads());
  const geo::EnuFrame frame(kMadeOrigin);
  for (size_t i = 0; i < 5; ++i) {
    // All on the line y = 56, z = 0, marked where it shows.
    const Eigen::Vector3d x(10.0 + 15.0 * static_cast<double>(i), 56.0, 0.0);
    line.control.points[i].place = frame.GeodeticFromEnu(x);
    line.control.points[i].marks.clear();
    for (size_t k = 0; k < line.photos.size() && line.control.points[i].marks.size() < 5; ++k) {
      const auto pixel =
          camera::Camera{camera::CameraModel::kOpencv, 1600, 1200, {1250.0, 1250.0, 800.0, 600.0, -0.03, 0.01, 3e-4, -2e-4}}.ImgFromCam(
              line.true_poses[k] * x);
      if (pixel && pixel->minCoeff() > 0.0 && pixel->x() < 1600.0 && pixel->y() < 1200.0) {
        line.control.points[i].marks.push_back({line.photos[k].file.name, *pixel, 0});
      }
    }
  }
  EXPECT_NE(message(line).find("on one line"), std::string::npos) << message(line);

  for (MadeControl* made : {&few, &line}) {
    const Eigen::Vector3d before = made->model.points.front().x_in_world;
    ControlJob job = made->Job();
    geo::Similarity3d shift;
    for (size_t k = 0; k < made->true_poses.size(); ++k) {
      const Eigen::Vector3d between = made->true_poses[k].OriginInSource() - made->model.images[k].cam_from_world.OriginInSource();
      shift.translation += between / static_cast<double>(made->true_poses.size());
    }
    job.otherwise = PlaceWithoutControl{kMadeOrigin, shift, {0.5, 0.5, 0.5, 1.0, 1.0}, false};
    const PlacedByControl compared = FitControl(job, Threads());
    EXPECT_FALSE(compared.fit.placed);
    EXPECT_EQ(made->model.points.front().x_in_world, before);
    EXPECT_TRUE(compared.problems.front().about_place);
    EXPECT_EQ(compared.problems.front().code, made == &few ? "control_too_few" : "control_on_line");
    EXPECT_EQ(compared.fit.points[0].use, ControlUse::kCheck);
    EXPECT_LT(compared.fit.points[0].error_m.norm(), 5.0);
    EXPECT_GT(compared.fit.points[0].sigma_m.x(), 0.7);
  }
}

TEST(FitControl, PointsWithoutHeightCountHorizontally) {
  MadeControl made = MakeControl({.own_frame = true, .tags = false}, Threads());
  for (const size_t i : {0U, 2U, 3U, 5U, 7U, 9U}) made.control.points[i].place.height_m = std::numeric_limits<double>::quiet_NaN();
  Displace(made.control.points[5], {0.0, 5.0, 0.0});
  const PlacedByControl placed = FitControl(made.Job(), Threads());
  const Rmse rmse = RmseOf(placed.fit, ControlUse::kCheck);
  EXPECT_LT(rmse.horizontal_m, rmse.gsd_m);
  EXPECT_LT(rmse.vertical_m, 2.0 * rmse.gsd_m);
  EXPECT_EQ(placed.fit.points[5].use, ControlUse::kRejected);
  EXPECT_TRUE(std::isnan(placed.fit.points[0].error_m.z()));
  EXPECT_TRUE(std::isfinite(placed.fit.points[0].error_m.x()));
  EXPECT_TRUE(std::isnan(placed.fit.points[0].given_in_enu.z()));
}

TEST(FitControl, WithoutObservationsOrWithAnotherLensASimilarityRemains) {
  for (const bool other_lens : {false, true}) {
    MadeControl made = MakeControl({.own_frame = true, .tags = false}, Threads());
    if (other_lens) {
      for (auto& [id, camera] : made.model.cameras) {
        camera.model = camera::CameraModel::kFullOpencv;
        camera.params.insert(camera.params.end(), {0.0, 0.0, 0.0, 0.0});
      }
    } else {
      made.observations.clear();
    }
    const PlacedByControl placed = FitControl(made.Job(), Threads());
    EXPECT_TRUE(placed.fit.placed);
    EXPECT_FALSE(placed.fit.adjusted);
    ASSERT_NE(FindProblem(placed, "control_not_adjusted"), nullptr);
    const Rmse rmse = RmseOf(placed.fit, ControlUse::kCheck);
    EXPECT_EQ(rmse.n, 10);
    EXPECT_LT(rmse.horizontal_m, 0.5);
    EXPECT_LT(rmse.vertical_m, 1.0);
    EXPECT_TRUE(std::isfinite(placed.fit.points[0].left_out_error_m.x()));
  }
}

TEST(FitControl, IsTheSameWithAnyNumberOfThreads) {
  MadeControl made = MakeControl({}, Threads());
  MadeControl again = made;
  base::ThreadPool one(1);
  const PlacedByControl a = FitControl(made.Job(), Threads()), b = FitControl(again.Job(), one);
  for (size_t i = 0; i < made.model.images.size(); ++i) {
    EXPECT_EQ(made.model.images[i].cam_from_world.translation, again.model.images[i].cam_from_world.translation);
  }
  for (size_t i = 0; i < a.fit.points.size(); ++i) {
    EXPECT_EQ(a.fit.points[i].error_m, b.fit.points[i].error_m);
    EXPECT_EQ(a.fit.points[i].sigma_m, b.fit.points[i].sigma_m);
  }
}

// What is predicted of a point that is left out is what comes out when it is.
TEST(FitControl, LeftOutErrorsAreThoseOfAdjustmentsWithoutThePoint) {
  MadeControl made = MakeControl({.own_frame = true, .tags = false}, Threads());
  MadeControl with = made;
  const PlacedByControl placed = FitControl(with.Job(), Threads());
  for (const size_t i : {0U, 4U, 8U}) {
    MadeControl without = made;
    without.control.points[i].check = true;
    const PlacedByControl refit = FitControl(without.Job(), Threads());
    const survey::ControlPointFit &predicted = placed.fit.points[i], &found = refit.fit.points[i];
    EXPECT_EQ(found.use, ControlUse::kCheck);
    // The refit also finds other accuracies of features and marks, and other curvature.
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(predicted.left_out_error_m[axis], found.error_m[axis], 0.3 * found.sigma_m[axis]) << predicted.label << ", axis " << axis;
      EXPECT_GT(std::abs(found.error_m[axis] - predicted.error_m[axis]), 0.0);
    }
  }
}

}  // namespace
}  // namespace skyquilt::test
