#include "odm/dataset_lock.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <optional>
#include <string>
#include <thread>

#include "core/base/file.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::odm {
namespace {

TEST(DatasetLock, TheSecondWaitsForTheFirst) {
  const TemporaryFolder folder;
  std::optional<DatasetLock> first(folder.path());
  EXPECT_EQ(base::ReadFile(folder / "odm.lock"), std::to_string(getpid()));
  std::atomic<bool> released = false, early = false, got = false;
  std::thread second([&] {
    const DatasetLock lock(folder.path());
    early = !released;
    got = true;
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_FALSE(got);
  released = true;
  first.reset();
  second.join();
  EXPECT_TRUE(got);
  EXPECT_FALSE(early);
}

TEST(DatasetLock, WaitsOnlyUntilItIsCancelled) {
  const TemporaryFolder folder;
  const DatasetLock first(folder.path());
  ExpectStopsWhenAsked([&] { const DatasetLock second(folder.path()); });
}

TEST(DatasetLock, NeedsAFolder) {
  const TemporaryFolder folder;
  const std::string error = InputErrorOf([&] { const DatasetLock lock(folder / "missing"); });
  EXPECT_NE(error.find("odm.lock"), std::string::npos) << error;
}

}  // namespace
}  // namespace skyquilt::odm
