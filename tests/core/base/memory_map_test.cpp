#include "core/base/memory_map.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::base {
namespace {

std::string Text(const MemoryMap& map) {
  return {map.bytes().begin(), map.bytes().end()};
}

TEST(MemoryMap, ShowsTheWholeFile) {
  const TemporaryFolder folder;
  const std::string content = std::string(10000, 'a') + "end";
  WriteFileAtomically(folder.path() / "file", content);
  EXPECT_EQ(Text(MemoryMap(folder.path() / "file")), content);
}

TEST(MemoryMap, StaysValidWhenItsFileIsReplaced) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder.path() / "file", "first");
  const MemoryMap map(folder.path() / "file");
  WriteFileAtomically(folder.path() / "file", "second, and longer");
  EXPECT_EQ(Text(map), "first");
}

TEST(MemoryMap, MovesItsView) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder.path() / "one", "1");
  WriteFileAtomically(folder.path() / "two", "22");
  MemoryMap one(folder.path() / "one");
  MemoryMap target(folder.path() / "two");
  target = std::move(one);
  EXPECT_EQ(Text(target), "1");
  const MemoryMap last(std::move(target));
  EXPECT_EQ(Text(last), "1");
}

TEST(MemoryMap, ReadsBytesWithoutMappingThem) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "file", "abcdef");
  const MemoryMap map(folder / "file");
  uint8_t bytes[3];
  map.ReadAt(2, bytes);
  EXPECT_EQ(std::string(bytes, bytes + 3), "cde");
  EXPECT_THROW(map.ReadAt(4, bytes), InputError);
}

TEST(MemoryMap, EmptyFileIsAnEmptySpan) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder.path() / "empty", "");
  EXPECT_TRUE(MemoryMap(folder.path() / "empty").bytes().empty());
  EXPECT_TRUE(MemoryMap().bytes().empty());
}

TEST(MemoryMap, RefusesMissingFilesAndFolders) {
  const TemporaryFolder folder;
  EXPECT_THROW(MemoryMap(folder.path() / "missing"), InputError);
  EXPECT_THROW(MemoryMap{folder.path()}, InputError);
}

}  // namespace
}  // namespace skyquilt::base
