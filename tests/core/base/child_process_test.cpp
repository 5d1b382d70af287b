#include "core/base/child_process.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <csignal>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::base {
namespace {

using ChildProcessTest = InTemporaryFolder;
using RunLoggedTest = InTemporaryFolder;

Command Shell(const std::string& script) {
  return {FindProgram("sh"), {"-c", script}};
}

// True when the process no longer exists, or is a zombie.
bool HasEnded(const std::string& process) {
  const std::string stat = "/proc/" + process + "/stat";
  const std::string text = std::filesystem::exists(stat) ? ReadFile(stat) : ") Z";
  return text.find(") Z") != std::string::npos || text.find(") X") != std::string::npos;
}

TEST_F(RunLoggedTest, ReportsStatusLinesAndLog) {
  std::vector<std::string> lines;
  Command command = Shell("echo one; echo \"$SKYQUILT_X\" >&2; printf '\\n\\rthree'; exit 7");
  command.environment = {"SKYQUILT_X=two words"};
  EXPECT_EQ(RunLogged(command, folder_ / "log", [&](const std::string& line) { lines.push_back(line); }), 7);
  EXPECT_EQ(lines, (std::vector<std::string>{"one", "two words", "three"}));
  const std::string log = ReadFile(folder_ / "log");
  EXPECT_NE(log.find("two words"), std::string::npos);
  EXPECT_NE(log.find("# exit status 7\n"), std::string::npos);
  EXPECT_EQ(RunLogged(Shell("kill -9 $$"), folder_ / "log", {}), 128 + SIGKILL);
}

TEST_F(RunLoggedTest, AFileThatCannotBeExecutedHasStatus127) {
  WriteFileAtomically(folder_ / "script", "#!/no/such/interpreter\n");
  std::filesystem::permissions(folder_ / "script", std::filesystem::perms::owner_all);
  EXPECT_EQ(RunLogged({FindProgram((folder_ / "script").string()), {}}, folder_ / "log", {}), 127);
}

TEST_F(RunLoggedTest, CancellingEndsTheProgramAndItsChildren) {
  std::string grandchild;
  EXPECT_THROW(RunLogged(Shell("sleep 600 & echo $!; wait"), folder_ / "log",
                         [&](const std::string& line) {
                           grandchild = line;
                           RequestCancel();
                         }),
               Interrupted);
  ClearCancel();
  bool ended = false;
  for (int i = 0; i < 100 && !ended; ++i) {
    ended = HasEnded(grandchild);
    if (!ended) RunLogged(Shell("sleep 0.05"), folder_ / "log", {});
  }
  EXPECT_TRUE(ended);
}

TEST(FindProgram, IsEmptyForMissingPrograms) {
  EXPECT_TRUE(FindProgram("no-such-program-anywhere").empty());
  EXPECT_TRUE(FindProgram("/no/such/program").empty());
  EXPECT_FALSE(FindProgram("sh").empty());
}

TEST_F(ChildProcessTest, ReadsWhatIsWrittenToIt) {
  // More than a socket's buffer.
  const std::vector<uint8_t> bytes(3'000'000, 'x');
  ChildProcess child = ChildProcess::StartWriting(Shell("cat > '" + (folder_ / "copy").string() + "'"));
  EXPECT_TRUE(child.Send(bytes));
  EXPECT_TRUE(child.Send(std::vector<uint8_t>{'y'}));
  EXPECT_EQ(child.Wait().Text("cat"), "");
  EXPECT_EQ(ReadFile(folder_ / "copy"), std::string(bytes.size(), 'x') + "y");
}

TEST_F(ChildProcessTest, ReportsThatTheProgramEndedAndHow) {
  const std::vector<uint8_t> bytes(3'000'000, 'x');
  ChildProcess failing = ChildProcess::StartWriting(Shell("exit 3"));
  EXPECT_FALSE(failing.Send(bytes));
  EXPECT_EQ(failing.Wait().Text("sh"), "sh ended with status 3");
  ChildProcess killed = ChildProcess::StartWriting(Shell("kill -9 $$"));
  EXPECT_FALSE(killed.Send(bytes));
  EXPECT_EQ(killed.Wait().Text("sh"), "sh was ended by signal 9");
}

TEST_F(ChildProcessTest, IsKilledByTheDestructor) {
  std::string number;
  {
    ChildProcess child = ChildProcess::StartReading(Shell("echo $$; exec sleep 600"));
    while (number.find('\n') == std::string::npos && child.Receive(&number)) {
    }
  }
  ASSERT_FALSE(number.empty());
  number.pop_back();
  EXPECT_TRUE(HasEnded(number));
}

TEST_F(ChildProcessTest, ReportsWhyAFileCannotBeExecuted) {
  WriteFileAtomically(folder_ / "text", "no program\n");
  const auto error = Caught<StartError>([&] { ChildProcess::StartWriting({folder_ / "text", {}}); });
  ASSERT_TRUE(error) << "no error";
  EXPECT_EQ(error->missing(), StartError::Missing::kProgram);
  EXPECT_EQ(error->code(), EACCES);
}

}  // namespace
}  // namespace skyquilt::base
