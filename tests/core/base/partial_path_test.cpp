#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/output_file.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::base {
namespace {

namespace fs = std::filesystem;

TEST(PartialPath, HasItsNameOnlyWhenItIsPublished) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "film.mp4", "old");
  {
    const PartialPath film(folder / "film.mp4", folder / "film.partial.mp4");
    WriteFileAtomically(film.path(), "half");
  }
  EXPECT_EQ(ReadFile(folder / "film.mp4"), "old");
  EXPECT_FALSE(fs::exists(folder / "film.partial.mp4"));
  PartialPath film(folder / "film.mp4");
  WriteFileAtomically(film.path(), "new");
  film.Publish();
  EXPECT_EQ(ReadFile(folder / "film.mp4"), "new");
  EXPECT_FALSE(fs::exists(folder / "film.mp4.partial"));
}

TEST(PartialPath, AFolderIsMovedAsAWhole) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "tiles.partial" / "of a killed process");
  PartialPath tiles(folder / "tiles");
  EXPECT_FALSE(fs::exists(tiles.path()));
  fs::create_directory(tiles.path());
  WriteFileAtomically(tiles.path() / "1.glb", "tile");
  tiles.Publish();
  EXPECT_EQ(ReadFile(folder / "tiles" / "1.glb"), "tile");
  EXPECT_FALSE(fs::exists(folder / "tiles" / "of a killed process"));
}

TEST(PartialPath, WhatStandsInTheWayStaysAndIsNamed) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "taken" / "inner");
  {
    PartialPath file(folder / "taken");
    WriteFileAtomically(file.path(), "x");
    try {
      file.Publish();
      FAIL() << "a folder was replaced by a file";
    } catch (const InputError& error) {
      EXPECT_EQ(error.file(), folder / "taken");
    }
  }
  EXPECT_TRUE(fs::is_directory(folder / "taken" / "inner"));
  EXPECT_FALSE(fs::exists(folder / "taken.partial"));
  EXPECT_THROW(Rename(folder / "missing", folder / "new"), InputError);
}

}  // namespace
}  // namespace skyquilt::base
