#include "prepare/colmap_run.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/prepare/synthetic_flight.h"
#include "tests/support/error_of.h"

namespace skyquilt::prepare {
namespace {

TEST(ColmapProgress, IsReadFromItsOutput) {
  EXPECT_DOUBLE_EQ(ColmapLineProgress("Processed file [3/18]", 18), 3.0 / 18.0);
  EXPECT_DOUBLE_EQ(ColmapLineProgress("Matching block [1/2, 1/2] in 4.4s", 18), 0.0);
  EXPECT_DOUBLE_EQ(ColmapLineProgress("Matching block [2/2, 2/2]", 18), 0.75);
  EXPECT_DOUBLE_EQ(ColmapLineProgress("Matching image [84/167] in 0.2s", 167), 83.0 / 167.0);
  EXPECT_DOUBLE_EQ(ColmapLineProgress("Registering image #12 (7)", 18), 6.0 / 18.0);
  EXPECT_LT(ColmapLineProgress("  Name:            DJI_0018.JPG", 18), 0.0);
  EXPECT_LT(ColmapLineProgress("Registering image #", 18), 0.0);
}

// A fake COLMAP that records its calls, to test which steps are run again.
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
  const std::string error = InputErrorOf([&] { RunColmap(job, photos, options); });
  EXPECT_NE(error.find("colmap.log"), std::string::npos) << error;
  EXPECT_NE(error.find("no good initial pair"), std::string::npos) << error;
  write_fake("exit 0");
  EXPECT_THROW(RunColmap(job, photos, options), base::InputError);  // succeeded, but wrote no model
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
