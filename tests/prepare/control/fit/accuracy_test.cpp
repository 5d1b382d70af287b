#include <gtest/gtest.h>

#include <cmath>

#include "prepare/control/fit/fit_control.h"
#include "tests/prepare/control/fit/made_control.h"

namespace skyquilt::test {
namespace {

using survey::ControlUse;

struct Coverage {
  int n = 0, within = 0;
  double squares = 0.0;

  void Add(const survey::ControlPointFit& point) {
    for (int axis = 0; axis < 3; ++axis) {
      const double relative = point.error_m[axis] / point.sigma_m[axis];
      ASSERT_TRUE(std::isfinite(relative)) << point.label;
      ++n;
      within += std::abs(relative) <= 1.96 ? 1 : 0;
      squares += relative * relative;
    }
  }
  double Share() const { return static_cast<double>(within) / n; }
};

// Over many flights, points and marks with other noise: 95 % of the errors are within 1.96 of their stated sigmas.
TEST(ControlAccuracy, StatedSigmasCoverTheErrors) {
  base::ThreadPool threads(2);
  Coverage check, control;
  for (uint64_t trial = 0; trial < 30; ++trial) {
    ControlPlan plan{.survey = {.strips = 4, .per_strip = 5, .points_per_photo = 120, .gimbal_tags = false, .seed = 100 + trial},
                     .control = 6,
                     .check = 10,
                     .mark_noise_px = trial % 2 == 0 ? 0.5 : 0.25,
                     .own_frame = trial % 3 == 0,
                     .tags = trial % 3 != 0,
                     .seed = 500 + trial};
    MadeControl made = MakeControl(plan, threads);
    const prepare::control::PlacedByControl placed = prepare::control::FitControl(made.Job(), threads);
    ASSERT_TRUE(placed.fit.adjusted);
    for (const survey::ControlPointFit& point : placed.fit.points) {
      if (point.use == ControlUse::kCheck) check.Add(point);
      if (point.use == ControlUse::kControl) control.Add(point);
    }
  }
  RecordProperty("share_of_check_errors", std::to_string(check.Share()));
  EXPECT_GE(check.n, 850);
  EXPECT_NEAR(check.Share(), 0.95, 0.03) << "root mean square " << std::sqrt(check.squares / check.n);
  EXPECT_NEAR(control.Share(), 0.95, 0.04) << "root mean square " << std::sqrt(control.squares / control.n);
}

}  // namespace
}  // namespace skyquilt::test
