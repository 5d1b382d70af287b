#include "core/base/log.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log_file.h"
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

TEST(Log, FileOfOneProjectDoesNotReceiveTheNext) {
  const TemporaryFolder folder;
  testing::internal::CaptureStderr();
  InitLog(false);
  {
    const LogFile first(folder.path() / "first.txt");
    LogInfo("of the first");
  }
  {
    const LogFile second(folder.path() / "second.txt");
    LogInfo("of the second");
  }
  LogInfo("of none");
  EXPECT_NE(testing::internal::GetCapturedStderr().find("of none"), std::string::npos);
  const std::string first = ReadFile(folder.path() / "first.txt"), second = ReadFile(folder.path() / "second.txt");
  EXPECT_NE(first.find("of the first"), std::string::npos) << first;
  EXPECT_NE(second.find("of the second"), std::string::npos) << second;
  EXPECT_EQ(first.find("of the second"), std::string::npos) << first;
  EXPECT_EQ(second.find("of none"), std::string::npos) << second;
  EXPECT_THROW(LogFile{folder.path()}, InputError);
}

TEST(Log, FormatsWhatItsLevelLetsThrough) {
  testing::internal::CaptureStderr();
  InitLog(false);
  EXPECT_EQ(GetLogLevel(), LogLevel::kInfo);
  LogInfo("{} of {:.1f}", 2, 3.0);
  LogInfo("{as it is}");
  SetLogLevel(LogLevel::kWarning);
  EXPECT_EQ(GetLogLevel(), LogLevel::kWarning);
  LogInfo("no {}", "news");
  LogError("{} left", "nothing");
  const std::string shown = testing::internal::GetCapturedStderr();
  InitLog(false);
  EXPECT_NE(shown.find("info: 2 of 3.0"), std::string::npos) << shown;
  EXPECT_NE(shown.find("info: {as it is}"), std::string::npos) << shown;
  EXPECT_EQ(shown.find("news"), std::string::npos) << shown;
  EXPECT_NE(shown.find("error: nothing left"), std::string::npos) << shown;
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
