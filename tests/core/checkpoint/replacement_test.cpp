// Replacing an archive by a new one: at any moment, even after a kill or with a full disk, a complete file exists.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/system.h"
#include "core/checkpoint/archive.h"
#include "tests/support/error_of.h"
#include "tests/support/limited_file_size.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::checkpoint {
namespace {

void Commit(const std::filesystem::path& file, int64_t step, size_t n_values = 1000) {
  const std::vector<float> values(n_values, static_cast<float>(step));
  ArchiveWriter writer("block", 1);
  writer.Put("values", values);
  writer.SetAttribute("step", step);
  writer.Commit(file);
}

int64_t StepOf(const std::filesystem::path& file) {
  const ArchiveReader reader(file);
  const std::vector<float> values = reader.Floats("values");
  for (const float value : values) EXPECT_EQ(value, static_cast<float>(reader.IntAttribute("step")));
  return reader.IntAttribute("step");
}

class Replacement : public testing::Test {
 protected:
  void Damage(const std::filesystem::path& file) const {
    std::string bytes = base::ReadFile(file);
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 4);
    std::ofstream(file, std::ios::binary) << bytes;
  }
  size_t FilesInFolder() const {
    size_t n = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder_.path())) ++n;
    return n;
  }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "block.h5";
  std::filesystem::path previous_ = folder_.path() / "block.h5.prev";
};

TEST_F(Replacement, KeepsThePreviousFile) {
  Commit(file_, 1);
  EXPECT_EQ(FilesInFolder(), 1U);
  Commit(file_, 2);
  Commit(file_, 3);
  EXPECT_EQ(StepOf(file_), 3);
  EXPECT_EQ(StepOf(previous_), 2);
  EXPECT_EQ(FilesInFolder(), 2U);
}

TEST_F(Replacement, NewestUsableFallsBack) {
  std::string why;
  EXPECT_TRUE(NewestUsable(file_, "block", &why).empty());
  EXPECT_NE(why.find("does not exist"), std::string::npos);
  Commit(file_, 1);
  Commit(file_, 2);
  EXPECT_EQ(NewestUsable(file_, "block", &why), file_);
  EXPECT_TRUE(NewestUsable(file_, "scene", &why).empty());
  EXPECT_NE(why.find("kind 'block'"), std::string::npos);
  Damage(file_);
  EXPECT_EQ(NewestUsable(file_, "block", &why), previous_);
  Damage(previous_);
  EXPECT_TRUE(NewestUsable(file_, "block", &why).empty());
  EXPECT_NE(why.find("block.h5: is damaged"), std::string::npos) << why;
  EXPECT_NE(why.find("block.h5.prev: is damaged"), std::string::npos) << why;
}

TEST_F(Replacement, WorksOverADamagedFile) {
  Commit(file_, 1);
  Commit(file_, 2);
  Damage(file_);
  Commit(file_, 3);
  EXPECT_EQ(StepOf(file_), 3);
}

TEST_F(Replacement, LeftoversOfAKilledWriterDoNoHarm) {
  Commit(file_, 1);
  const pid_t killed = fork();
  if (killed == 0) _exit(0);
  waitpid(killed, nullptr, 0);
  const std::string left = file_.string() + ".tmp." + base::HostName() + "." + std::to_string(killed);
  std::ofstream(left) << "half a file";
  std::ofstream(left + ".prev") << "half a file";
  const std::string at_work = file_.string() + ".tmp.another-host.1";
  std::ofstream(at_work) << "half a file";
  Commit(file_, 2);
  EXPECT_EQ(StepOf(file_), 2);
  EXPECT_EQ(StepOf(previous_), 1);
  EXPECT_EQ(FilesInFolder(), 3U);
  // The temporary file of a host that has not written for long.
  std::filesystem::last_write_time(at_work, std::filesystem::file_time_type::clock::now() - std::chrono::hours(2));
  Commit(file_, 3);
  EXPECT_EQ(FilesInFolder(), 2U);
}

// Runs in a separate process, to test also what HDF5 does when a process ends.
TEST_F(Replacement, AFullDiskAtAnyByteKeepsTheOldFile) {
  Commit(file_, 1);
  const pid_t child = fork();
  if (child == 0) {
    Commit(folder_.path() / "whole.h5", 2, 1000000);
    const auto n_whole = static_cast<rlim_t>(std::filesystem::file_size(folder_.path() / "whole.h5"));
    std::filesystem::remove(folder_.path() / "whole.h5");
    std::vector<rlim_t> limits = {0, 100, 511, 512, 560, 1024, 4096, 1000000, n_whole - 1};
    for (rlim_t i = 1; i < 30; ++i) {
      limits.push_back(i * 97);
      limits.push_back(n_whole - i * 211);
      limits.push_back(n_whole * i / 30);
    }
    int status = 0;
    for (const rlim_t limit : limits) {
      const std::string message = InputErrorOf([&] {
        const LimitedFileSize small(limit);
        Commit(file_, 2, 1000000);
      });
      if (message.find("block.h5") == std::string::npos || StepOf(file_) != 1 || FilesInFolder() != 1) {
        std::fprintf(stderr, "limit %lu of %lu: '%s'\n", static_cast<unsigned long>(limit), static_cast<unsigned long>(n_whole), message.c_str());
        status = 1;
      }
    }
    Commit(file_, 3, 1000000);
    if (StepOf(file_) != 3) status = 1;
    std::exit(status);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  EXPECT_EQ(StepOf(file_), 3);
}

TEST_F(Replacement, AMissingFolderIsNamed) {
  EXPECT_NE(InputErrorOf([&] { Commit(folder_.path() / "absent/block.h5", 1); }).find("absent/block.h5"), std::string::npos);
}

TEST_F(Replacement, SurvivesAKillAtAnyMoment) {
  Commit(file_, 1, 200000);
  for (int i = 0; i < 12; ++i) {
    const int64_t at_least = StepOf(NewestUsable(file_, "block", nullptr));
    const pid_t child = fork();
    if (child == 0) {
      for (int64_t step = at_least + 1;; ++step) Commit(file_, step, 200000);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(15 + 7 * i));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
    std::string why;
    ASSERT_EQ(NewestUsable(file_, "block", &why), file_) << why;
    EXPECT_GE(StepOf(file_), at_least);
  }
}

}  // namespace
}  // namespace skyquilt::checkpoint
