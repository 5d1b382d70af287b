#include "evaluate/page/time_axis.h"

#include <gtest/gtest.h>

namespace skyquilt::evaluate::page {
namespace {

TEST(TimeAxis, IsInMinutesWhateverTheOrder) {
  const TimeAxis axis = AxisOfTimes({120.0, 0.0, 60.0});
  EXPECT_EQ(axis.x, (std::vector<double>{2.0, 0.0, 1.0}));
  EXPECT_EQ(axis.label, "flight time (min)");
}

TEST(TimeAxis, ShortensLongPauses) {
  const TimeAxis axis = AxisOfTimes({0.0, 60.0, 86400.0, 86460.0});
  ASSERT_EQ(axis.x.size(), 4U);
  EXPECT_NEAR(axis.x[2], 2.0, 1e-9);
  EXPECT_NEAR(axis.x[3], 3.0, 1e-9);
  EXPECT_NE(axis.label.find("pauses of more than 10 min"), std::string::npos);
}

TEST(TimeAxis, CountsPhotosWithoutTimes) {
  EXPECT_EQ(AxisOfNames(3).x, (std::vector<double>{1.0, 2.0, 3.0}));
  EXPECT_NE(AxisOfNames(3).label.find("names"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::evaluate::page
