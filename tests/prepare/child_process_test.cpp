#include "prepare/child_process.h"

#include <gtest/gtest.h>

#include <csignal>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "prepare/colmap_run.h"
#include "tests/prepare/synthetic_flight.h"

namespace skyquilt::prepare {
namespace {

ChildProcess Shell(const TemporaryFolder& folder, const std::string& script) {
  ChildProcess child;
  child.program = FindProgram("sh");
  child.arguments = {"-c", script};
  child.log = folder / "log";
  return child;
}

TEST(ChildProcess, ReportsStatusLinesAndLog) {
  const TemporaryFolder folder;
  std::vector<std::string> lines;
  ChildProcess child = Shell(folder, "echo one; echo \"$SKYQUILT_X\" >&2; printf three; exit 7");
  child.environment = {"SKYQUILT_X=two words"};
  child.on_line = [&](const std::string& line) { lines.push_back(line); };
  EXPECT_EQ(RunChild(child), 7);
  EXPECT_EQ(lines, (std::vector<std::string>{"one", "two words", "three"}));
  EXPECT_NE(base::ReadFile(folder / "log").find("two words"), std::string::npos);
  EXPECT_EQ(RunChild(Shell(folder, "kill -9 $$")), 128 + SIGKILL);
}

TEST(ChildProcess, CancellingEndsTheChildAndWhatItStarted) {
  const TemporaryFolder folder;
  ChildProcess child = Shell(folder, "sleep 600 & echo $!; wait");
  std::string grandchild;
  child.on_line = [&](const std::string& line) {
    grandchild = line;
    base::RequestCancel();
  };
  EXPECT_THROW(RunChild(child), base::Interrupted);
  base::ClearCancel();
  // Its number is gone, or it is a corpse that nobody has collected yet.
  const std::string stat = "/proc/" + grandchild + "/stat";
  bool ended = false;
  for (int i = 0; i < 100 && !ended; ++i) {
    const std::string text = std::filesystem::exists(stat) ? base::ReadFile(stat) : ") Z";
    ended = text.find(") Z") != std::string::npos || text.find(") X") != std::string::npos;
    if (!ended) RunChild(Shell(folder, "sleep 0.05"));
  }
  EXPECT_TRUE(ended);
}

TEST(ChildProcess, MissingProgramsAreNotFound) {
  EXPECT_TRUE(FindProgram("no-such-program-anywhere").empty());
  EXPECT_TRUE(FindProgram("/no/such/program").empty());
  EXPECT_FALSE(FindProgram("sh").empty());
}

TEST(ColmapProgress, IsReadFromItsOutput) {
  EXPECT_DOUBLE_EQ(ColmapLineProgress("Processed file [3/18]", 18), 3.0 / 18.0);
  EXPECT_DOUBLE_EQ(ColmapLineProgress("Matching block [1/2, 1/2] in 4.4s", 18), 0.0);
  EXPECT_DOUBLE_EQ(ColmapLineProgress("Matching block [2/2, 2/2]", 18), 0.75);
  EXPECT_DOUBLE_EQ(ColmapLineProgress("Matching image [84/167] in 0.2s", 167), 83.0 / 167.0);
  EXPECT_DOUBLE_EQ(ColmapLineProgress("Registering image #12 (7)", 18), 6.0 / 18.0);
  EXPECT_LT(ColmapLineProgress("  Name:            DJI_0018.JPG", 18), 0.0);
  EXPECT_LT(ColmapLineProgress("Registering image #", 18), 0.0);
}

// A stand-in for COLMAP that notes its calls: what matters is which steps are run again.
TEST(ColmapRun, FinishedStepsAreSkippedAndFailuresNameTheLog) {
  const TemporaryFolder folder;
  const test::Flight flight = test::MakeFlight({47.0, 8.0, 400.0});
  test::WriteFlight(flight, folder.path());
  std::vector<PhotoFile> photos;
  for (const test::FlightPhoto& photo : flight.photos) photos.push_back({photo.name, 64, 48, photo.tags});
  const std::filesystem::path fake = folder / "colmap";
  const auto write_fake = [&](const std::string& mapper) {
    base::WriteFileAtomically(
        fake, "#!/bin/sh\necho $1 >> " + (folder / "calls").string() +
                  "\nwhile [ $# -gt 0 ]; do case $1 in --output_path) out=$2;; --database_path) : >> \"$2\";; mapper) m=1;; esac; shift; done\n"
                  "if [ -n \"$m\" ]; then " +
                  mapper + "; fi\n");
    std::filesystem::permissions(fake, std::filesystem::perms::owner_all);
  };
  PrepareOptions options;
  options.colmap = fake.string();
  const ColmapJob job{folder / "images", {}, folder / "work", 1};

  write_fake("echo no good initial pair; exit 1");
  try {
    RunColmap(job, photos, options);
    FAIL() << "no error";
  } catch (const base::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("colmap.log"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("no good initial pair"), std::string::npos);
  }
  write_fake("exit 0");
  EXPECT_THROW(RunColmap(job, photos, options), base::InputError);  // succeeded, yet left no model
  EXPECT_EQ(base::ReadFile(folder / "calls"), "feature_extractor\nexhaustive_matcher\nmapper\nmapper\n");

  options.max_features = 500;
  EXPECT_THROW(RunColmap(job, photos, options), base::InputError);
  EXPECT_EQ(base::ReadFile(folder / "calls"),
            "feature_extractor\nexhaustive_matcher\nmapper\nmapper\nfeature_extractor\nexhaustive_matcher\nmapper\n");

  options.colmap = "no-such-colmap";
  EXPECT_THROW(RunColmap(job, photos, options), base::InputError);
}

}  // namespace
}  // namespace skyquilt::prepare
