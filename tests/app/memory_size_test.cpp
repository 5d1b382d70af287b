#include "app/settings/memory_size.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"

namespace skyquilt::app {
namespace {

TEST(MemorySize, ReadsWhatPeopleWrite) {
  EXPECT_DOUBLE_EQ(ParseBytes("2GiB"), 2147483648.0);
  EXPECT_DOUBLE_EQ(ParseBytes("2 gib"), 2147483648.0);
  EXPECT_DOUBLE_EQ(ParseBytes("1.5G"), 1610612736.0);
  EXPECT_DOUBLE_EQ(ParseBytes("1500MB"), 1.5e9);
  EXPECT_DOUBLE_EQ(ParseBytes("4096"), 4096.0);
  EXPECT_EQ(FormatGib(ParseBytes("2GiB")), "2");
  EXPECT_EQ(FormatGib(ParseBytes("512MiB")), "0.5");
}

TEST(MemorySize, RefusesNonsense) {
  for (const char* text : {"", "GiB", "two", "2XB", "-1G", "0", "1.2.3G", "nan", "inf", "1e9", "2 G B x", "."}) {
    EXPECT_THROW(ParseBytes(text), base::UsageError) << "'" << text << "'";
  }
}

}  // namespace
}  // namespace skyquilt::app
