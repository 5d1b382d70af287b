#include "app/settings/duration.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"

namespace skyquilt::app {
namespace {

TEST(Duration, ReadsWhatPeopleWrite) {
  EXPECT_DOUBLE_EQ(ParseDurationSeconds("90s"), 90.0);
  EXPECT_DOUBLE_EQ(ParseDurationSeconds("10min"), 600.0);
  EXPECT_DOUBLE_EQ(ParseDurationSeconds("10 min"), 600.0);
  EXPECT_DOUBLE_EQ(ParseDurationSeconds("1h30m"), 5400.0);
  EXPECT_DOUBLE_EQ(ParseDurationSeconds("1H 30M 5S"), 5405.0);
  EXPECT_DOUBLE_EQ(ParseDurationSeconds("2.5h"), 9000.0);
  EXPECT_DOUBLE_EQ(ParseDurationSeconds("1d"), 86400.0);
  EXPECT_DOUBLE_EQ(ParseDurationSeconds("600"), 600.0);
  EXPECT_DOUBLE_EQ(ParseDurationSeconds("1:30"), 90.0);
  EXPECT_DOUBLE_EQ(ParseDurationSeconds("1:30:00"), 5400.0);
}

TEST(Duration, RefusesNonsense) {
  for (const char* text : {"",     " ",       "ten",  "10 minuten", "-5min", "0",   "0s",
                           "1h30", "30m1h",   "5m5m", "1e9",        "nan",   "inf", "10min!",
                           "1:75", "1:2:3:4", ":",    "5.5.5s",     ".",     "s",   "99999999999999999999s"}) {
    EXPECT_THROW(ParseDurationSeconds(text), base::UsageError) << "'" << text << "'";
  }
}

}  // namespace
}  // namespace skyquilt::app
