#include "core/base/file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "core/base/errors.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::base {
namespace {

using FileTest = InTemporaryFolder;

namespace fs = std::filesystem;

size_t CountEntries(const fs::path& folder) {
  return static_cast<size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST_F(FileTest, ContentIsReadBackUnchanged) {
  const fs::path file = folder_.path() / "bytes";
  for (const size_t size : {size_t{0}, size_t{1}, size_t{65536}, size_t{200003}}) {
    std::string content(size, '\0');
    for (size_t i = 0; i < size; ++i) content[i] = static_cast<char>(i * 31 % 256);
    WriteFileAtomically(file, content);
    EXPECT_EQ(ReadFile(file), content);
  }
  EXPECT_EQ(CountEntries(folder_.path()), 1U) << "temporary files were left behind";
}

TEST_F(FileTest, ErrorsNameTheFileAndHowToFixIt) {
  const fs::path missing = folder_.path() / "nowhere" / "file.txt";
  const auto error = Caught<InputError>([&] { ReadFile(missing); });
  ASSERT_TRUE(error) << "a missing file was read";
  EXPECT_EQ(error->file(), missing);
  EXPECT_NE(std::string(error->what()).find(missing.string()), std::string::npos);
  EXPECT_NE(std::string(error->what()).find("Check the path"), std::string::npos);
  EXPECT_THROW(WriteFileAtomically(missing, "x"), InputError);
  EXPECT_THROW(ReadFile(folder_.path()), InputError);
  EXPECT_THROW(SyncPath(missing), InputError);
}

// Two containers on one disk have processes of the same number.
TEST_F(FileTest, TemporaryNamesDoNotDependOnTheProcessAlone) {
  const fs::path file = folder_.path() / "file";
  for (int i = 0; i < 50; ++i) std::ofstream(folder_.path() / (".file.tmp." + std::to_string(getpid()) + "." + std::to_string(i))) << "another's";
  WriteFileAtomically(file, "mine");
  EXPECT_EQ(ReadFile(file), "mine");
  EXPECT_EQ(CountEntries(folder_.path()), 51U) << "a file that another process made was removed";
}

TEST_F(FileTest, AFolderIsNotReplacedByAFile) {
  fs::create_directories(folder_.path() / "taken" / "inner");
  EXPECT_THROW(WriteFileAtomically(folder_.path() / "taken", "x"), InputError);
  EXPECT_TRUE(fs::is_directory(folder_.path() / "taken" / "inner"));
  EXPECT_EQ(CountEntries(folder_.path()), 1U);
}

// A limit on the file size makes write() fail half-way, like a full disk.
void WriteBeyondTheLimit(const fs::path& file) {
  signal(SIGXFSZ, SIG_IGN);
  const struct rlimit limit = {100000, 100000};
  setrlimit(RLIMIT_FSIZE, &limit);
  try {
    WriteFileAtomically(file, std::string(300000, 'n'));
  } catch (const InputError&) {
    std::_Exit(7);
  }
  std::_Exit(0);
}

TEST(FileDeathTest, FailedWriteKeepsTheOldFile) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "kept";
  WriteFileAtomically(file, "old");
  EXPECT_EXIT(WriteBeyondTheLimit(file), testing::ExitedWithCode(7), "");
  EXPECT_EQ(ReadFile(file), "old");
  EXPECT_EQ(CountEntries(folder.path()), 1U) << "temporary files were left behind";
}

TEST_F(FileTest, WritableFolderIsCreatedAndLeftEmpty) {
  const fs::path deep = folder_.path() / "a" / "b" / "c";
  RequireWritableFolder(deep);
  EXPECT_TRUE(fs::is_directory(deep));
  EXPECT_EQ(CountEntries(deep), 0U);
  WriteFileAtomically(deep / "file", "x");
  EXPECT_THROW(RequireWritableFolder(deep / "file"), InputError);
  EXPECT_THROW(RequireWritableFolder(deep / "file" / "below"), InputError);
}

TEST_F(FileTest, FolderWithoutPermissionIsRefused) {
  if (geteuid() == 0) GTEST_SKIP() << "the superuser may write everywhere";
  fs::permissions(folder_.path(), fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_THROW(RequireWritableFolder(folder_.path()), InputError);
  fs::permissions(folder_.path(), fs::perms::owner_all);
}

// Published test vectors of 64-bit FNV-1a (draft-eastlake-fnv, appendix C).
TEST(HashHex, MatchesPublishedVectors) {
  EXPECT_EQ(HashHex(""), "cbf29ce484222325");
  EXPECT_EQ(HashHex("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(HashHex("foobar"), "85944171f73967e8");
}

TEST(Check, NamesConditionAndLine) {
  EXPECT_NO_THROW(SKYQUILT_CHECK(1 + 1 == 2, "fine"));
  const std::string text = ErrorOf<std::logic_error>([&] { SKYQUILT_CHECK(1 + 1 == 3, "two against three"); });
  for (const char* part : {"1 + 1 == 3", "file_test.cpp", "two against three"}) EXPECT_NE(text.find(part), std::string::npos) << text;
}

}  // namespace
}  // namespace skyquilt::base
