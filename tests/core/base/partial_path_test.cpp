#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/output_file.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::base {
namespace {

using PartialPathTest = InTemporaryFolder;

namespace fs = std::filesystem;

TEST_F(PartialPathTest, HasItsNameOnlyWhenItIsPublished) {
  WriteFileAtomically(folder_ / "film.mp4", "old");
  {
    const PartialPath film(folder_ / "film.mp4", folder_ / "film.partial.mp4");
    WriteFileAtomically(film.path(), "half");
  }
  EXPECT_EQ(ReadFile(folder_ / "film.mp4"), "old");
  EXPECT_FALSE(fs::exists(folder_ / "film.partial.mp4"));
  PartialPath film(folder_ / "film.mp4");
  WriteFileAtomically(film.path(), "new");
  film.Publish();
  EXPECT_EQ(ReadFile(folder_ / "film.mp4"), "new");
  EXPECT_FALSE(fs::exists(folder_ / "film.mp4.partial"));
}

TEST_F(PartialPathTest, AFolderIsMovedAsAWhole) {
  fs::create_directories(folder_ / "tiles.partial" / "of a killed process");
  PartialPath tiles(folder_ / "tiles");
  EXPECT_FALSE(fs::exists(tiles.path()));
  fs::create_directory(tiles.path());
  WriteFileAtomically(tiles.path() / "1.glb", "tile");
  tiles.Publish();
  EXPECT_EQ(ReadFile(folder_ / "tiles" / "1.glb"), "tile");
  EXPECT_FALSE(fs::exists(folder_ / "tiles" / "of a killed process"));
}

TEST_F(PartialPathTest, WhatStandsInTheWayStaysAndIsNamed) {
  fs::create_directories(folder_ / "taken" / "inner");
  {
    PartialPath file(folder_ / "taken");
    WriteFileAtomically(file.path(), "x");
    const auto error = Caught<InputError>([&] { file.Publish(); });
    ASSERT_TRUE(error) << "a folder was replaced by a file";
    EXPECT_EQ(error->file(), folder_ / "taken");
  }
  EXPECT_TRUE(fs::is_directory(folder_ / "taken" / "inner"));
  EXPECT_FALSE(fs::exists(folder_ / "taken.partial"));
  EXPECT_THROW(Rename(folder_ / "missing", folder_ / "new"), InputError);
}

}  // namespace
}  // namespace skyquilt::base
