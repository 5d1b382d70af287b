// A fixture for tests that write files: a temporary folder for each test.
//   using Suite = InTemporaryFolder;
//   TEST_F(Suite, Name) { ... folder_ / "file" ... }
#pragma once

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace skyquilt {

class InTemporaryFolder : public ::testing::Test {
 protected:
  const TemporaryFolder folder_;
};

}  // namespace skyquilt
