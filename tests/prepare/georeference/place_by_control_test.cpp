#include "prepare/georeference/place_by_control.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"

namespace skyquilt::test {
namespace {

using survey::ControlUse;

// Points over 200 m with a bowl of so much depth in their heights; used ones show it when they are left out.
survey::ControlFit BentFit(double dome_m) {
  base::Random random(3);
  survey::ControlFit fit;
  for (int i = 0; i < 24; ++i) {
    survey::ControlPointFit point;
    point.label = "T" + std::to_string(i);
    point.use = i % 2 == 0 ? ControlUse::kControl : ControlUse::kCheck;
    point.given_in_enu = {random.Uniform(-100.0, 100.0), random.Uniform(-100.0, 100.0), 0.0};
    const double square = point.given_in_enu.head<2>().squaredNorm() / (100.0 * 100.0);
    const Eigen::Vector3d error(0.0, 0.0, -dome_m * square + 0.01 * random.Normal());
    point.error_m = point.use == ControlUse::kControl ? Eigen::Vector3d::Zero() : error;
    if (point.use == ControlUse::kControl) point.left_out_error_m = error;
    point.gsd_m = 0.02;
    fit.points.push_back(point);
  }
  return fit;
}

TEST(PlaceByControl, ADomeIsReportedBeyondItsNoise) {
  const std::vector<survey::Problem> problems = prepare::georeference::BentByControl(BentFit(0.3));
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems.front().code, "control_dome");
  EXPECT_NE(problems.front().finding.find("high"), std::string::npos) << problems.front().finding;
  EXPECT_NE(prepare::georeference::BentByControl(BentFit(-0.3)).front().finding.find("low"), std::string::npos);
  EXPECT_TRUE(prepare::georeference::BentByControl(BentFit(0.0)).empty());
  EXPECT_TRUE(prepare::georeference::BentByControl(BentFit(0.02)).empty());  // about a pixel
}

TEST(PlaceByControl, WrongAndUnseenPointsSayNothingOfADome) {
  survey::ControlFit fit = BentFit(0.3);
  for (size_t i = 0; i < fit.points.size(); ++i) {
    if (i >= 8) fit.points[i].use = i % 2 == 0 ? ControlUse::kRejected : ControlUse::kUnseen;
  }
  EXPECT_TRUE(prepare::georeference::BentByControl(fit).empty());
}

TEST(PlaceByControl, WithoutAFileNothingChanges) {
  base::ThreadPool threads(1);
  survey::ColmapModel model;
  std::vector<prepare::input::PreparedPhoto> photos;
  prepare::georeference::Georeference georeference;
  georeference.ok = true;
  const prepare::georeference::PlaceOptions options;
  const survey::ControlFit fit = prepare::georeference::PlaceByControl({options, {}, {}}, model, photos, georeference, threads);
  EXPECT_TRUE(fit.points.empty());
  EXPECT_TRUE(georeference.ok);
}

}  // namespace
}  // namespace skyquilt::test
