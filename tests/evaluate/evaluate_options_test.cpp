#include "evaluate/evaluate_options.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/base/errors.h"

namespace skyquilt::evaluate {
namespace {

TEST(EvaluateOptions, AreRefusedOutOfRange) {
  EXPECT_NO_THROW(EvaluateOptions{}.Check());
  for (int EvaluateOptions::*count : {&EvaluateOptions::image_width, &EvaluateOptions::max_photos, &EvaluateOptions::report_photos}) {
    EvaluateOptions options;
    options.*count = 0;
    EXPECT_NO_THROW(options.Check());
    options.*count = -1;
    EXPECT_THROW(options.Check(), base::UsageError);
  }
  EvaluateOptions narrow;
  narrow.report_image_width = 15;
  EXPECT_THROW(narrow.Check(), base::UsageError);
  for (const double stops : {-10.5, 11.0, std::numeric_limits<double>::quiet_NaN()}) {
    EvaluateOptions options;
    options.normal_stops = stops;
    EXPECT_THROW(options.Check(), base::UsageError) << stops;
  }
}

}  // namespace
}  // namespace skyquilt::evaluate
