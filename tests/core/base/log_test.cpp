#include "core/base/log.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::base {
namespace {

TEST(Log, FileReceivesLaterMessages) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "log.txt";
  WriteFileAtomically(file, "before\n");
  testing::internal::CaptureStderr();
  InitLog(false, "rank 1");
  base::LogInfo("too early");
  AddLogFile(file);
  base::LogWarning("in both");
  base::LogDebug("hidden");
  const std::string shown = testing::internal::GetCapturedStderr();
  InitLog(false);
  const std::string kept = ReadFile(file);
  EXPECT_TRUE(kept.starts_with("before\n")) << kept;
  EXPECT_EQ(kept.find("too early"), std::string::npos);
  EXPECT_NE(kept.find("rank 1 warning: in both"), std::string::npos) << kept;
  EXPECT_NE(shown.find("too early"), std::string::npos);
  EXPECT_NE(shown.find("in both"), std::string::npos);
  EXPECT_EQ((shown + kept).find("hidden"), std::string::npos);
}

TEST(Log, VerboseShowsDebug) {
  testing::internal::CaptureStderr();
  InitLog(true);
  base::LogDebug("shown");
  InitLog(false);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("debug: shown"), std::string::npos);
}

TEST(Log, UnusableFileIsAnInputError) {
  const TemporaryFolder folder;
  InitLog(false);
  EXPECT_THROW(AddLogFile(folder.path()), InputError);
}

}  // namespace
}  // namespace skyquilt::base
