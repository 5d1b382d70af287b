#include "coordinator/planning/needs.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "tests/support/error_of.h"

namespace skyquilt::coordinator {
namespace {

WorkSize SomePhotos() {
  WorkSize size;
  size.photos = 167;
  size.held_out = 21;
  size.photo_pixels = 12e6;
  size.photo_width = 4000;
  size.surface_pixels = 200e6;
  size.threads = 2;
  return size;
}

TEST(Needs, LargerTablesNeedMoreMemory) {
  Settings settings;
  const Needs of_default = NeedsOf(SomePhotos(), settings);
  EXPECT_LT(of_default.least_memory, of_default.memory);
  settings.partition.max_log2_table_size = 19;
  EXPECT_GT(NeedsOf(SomePhotos(), settings).memory, of_default.memory);
  // Blocks are known: there is nothing to guess.
  WorkSize known = SomePhotos();
  known.log2_table_size = 15;
  EXPECT_EQ(NeedsOf(known, settings).memory, NeedsOf(known, settings).least_memory);
}

TEST(Needs, DecodedPhotosAreTheLeastOfTheDisk) {
  Settings settings;
  const double reduced = NeedsOf(SomePhotos(), settings).disk;
  EXPECT_GT(reduced, 167.0 * 750e3 * 3.0);
  settings.run.image_width = 0;
  EXPECT_GT(NeedsOf(SomePhotos(), settings).disk, reduced + 167.0 * 11e6 * 3.0);
}

TEST(Needs, WhatCannotWorkIsRefused) {
  const Needs needs{.memory = 3e9, .least_memory = 1e9, .disk = 5e9};
  EXPECT_NO_THROW(RequireRoom(needs, {.memory_limit = 4e9, .disk = 6e9}, "out"));
  EXPECT_NO_THROW(RequireRoom(needs, {.memory_limit = 2e9, .disk = 6e9}, "out"));  // a warning
  EXPECT_THROW(RequireRoom(needs, {.memory_limit = 0.5e9, .disk = 6e9}, "out"), base::UsageError);
  const std::string message = ErrorOf<base::InputError>([&] { RequireRoom(needs, {.memory_limit = 4e9, .disk = 1e9}, "out"); });
  EXPECT_NE(message.find("out"), std::string::npos);
  EXPECT_NE(message.find("free disk"), std::string::npos);
}

TEST(Needs, AFolderThatDoesNotExistYetHasTheDiskOfItsParent) {
  const Room room = RoomFor(std::filesystem::temp_directory_path() / "not" / "there" / "yet", {});
  EXPECT_GT(room.disk, 0.0);
  EXPECT_GT(room.memory_limit, 0.0);
}

}  // namespace
}  // namespace skyquilt::coordinator
