#include "core/base/output_file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::base {
namespace {

using OutputFileTest = InTemporaryFolder;

// Pieces of the sizes given, shorter and longer than the file's buffer.
std::string AppendPieces(const std::vector<size_t>& sizes, OutputFile& file) {
  std::string all;
  for (const size_t size : sizes) {
    std::string piece(size, '\0');
    for (size_t i = 0; i < size; ++i) piece[i] = static_cast<char>((all.size() + i) * 31 % 251);
    file.Append(piece);
    all += piece;
    EXPECT_EQ(file.size(), all.size());
  }
  return all;
}

TEST_F(OutputFileTest, PiecesAreReadBackInTheirOrder) {
  OutputFile file(folder_ / "made");
  const std::string all = AppendPieces({0, 1, 1000, 1 << 20, 7, 3 << 20, (1 << 20) - 1, 2}, file);
  file.Complete();
  file.Publish();
  EXPECT_TRUE(ReadFile(folder_ / "made") == all);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "made.partial"));
}

TEST_F(OutputFileTest, AfterSyncAllPiecesSoFarAreInTheFile) {
  OutputFile file(folder_ / "made");
  std::string all = AppendPieces({5, 100}, file);
  file.Sync();
  EXPECT_EQ(ReadFile(folder_ / "made.partial"), all);
  file.Append(std::string_view("end"));
  file.Complete();
  file.Publish();
  EXPECT_EQ(ReadFile(folder_ / "made"), all + "end");
}

TEST_F(OutputFileTest, HasItsNameOnlyWhenItIsPublished) {
  WriteFileAtomically(folder_ / "made", "old");
  {
    OutputFile file(folder_ / "made");
    AppendPieces({10}, file);
    file.Complete();
    EXPECT_EQ(ReadFile(folder_ / "made"), "old");
    EXPECT_THROW(file.Sync(), std::logic_error);
  }
  // Nobody published it.
  EXPECT_EQ(ReadFile(folder_ / "made"), "old");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "made.partial"));
}

TEST_F(OutputFileTest, AnUnfinishedFileOfAKilledRunIsReplaced) {
  WriteFileAtomically(folder_ / "made.partial", std::string(100, 'x'));
  OutputFile file(folder_ / "made");
  file.Append(std::string_view("new"));
  file.Complete();
  file.Publish();
  EXPECT_EQ(ReadFile(folder_ / "made"), "new");
}

TEST_F(OutputFileTest, AFolderThatIsMissingIsNamed) {
  const auto error = Caught<InputError>([&] { OutputFile file(folder_ / "nowhere/made"); });
  ASSERT_TRUE(error) << "a file was made in a folder that does not exist";
  EXPECT_EQ(error->file(), folder_ / "nowhere/made");
}

// A limit on the file size makes write() fail half-way, like a full disk.
void AppendBeyondTheLimit(const std::filesystem::path& target) {
  signal(SIGXFSZ, SIG_IGN);
  const struct rlimit limit = {100000, 100000};
  setrlimit(RLIMIT_FSIZE, &limit);
  try {
    OutputFile file(target);
    file.Append(std::string(300000, 'n'));
    file.Complete();
    file.Publish();
  } catch (const InputError&) {
    std::_Exit(7);
  }
  std::_Exit(0);
}

TEST(OutputFileDeathTest, AFullDiskKeepsTheOldFile) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "made", "old");
  EXPECT_EXIT(AppendBeyondTheLimit(folder / "made"), testing::ExitedWithCode(7), "");
  EXPECT_EQ(ReadFile(folder / "made"), "old");
  EXPECT_FALSE(std::filesystem::exists(folder / "made.partial"));
}

}  // namespace
}  // namespace skyquilt::base
