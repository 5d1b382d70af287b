#include "core/base/memory_map.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::base {
namespace {

using MemoryMapTest = InTemporaryFolder;

std::string Text(const MemoryMap& map) {
  return {map.bytes().begin(), map.bytes().end()};
}

TEST_F(MemoryMapTest, ShowsTheWholeFile) {
  const std::string content = std::string(10000, 'a') + "end";
  WriteFileAtomically(folder_.path() / "file", content);
  EXPECT_EQ(Text(MemoryMap(folder_.path() / "file")), content);
}

TEST_F(MemoryMapTest, StaysValidWhenItsFileIsReplaced) {
  WriteFileAtomically(folder_.path() / "file", "first");
  const MemoryMap map(folder_.path() / "file");
  WriteFileAtomically(folder_.path() / "file", "second, and longer");
  EXPECT_EQ(Text(map), "first");
}

TEST_F(MemoryMapTest, MovesItsView) {
  WriteFileAtomically(folder_.path() / "one", "1");
  WriteFileAtomically(folder_.path() / "two", "22");
  MemoryMap one(folder_.path() / "one");
  MemoryMap target(folder_.path() / "two");
  target = std::move(one);
  EXPECT_EQ(Text(target), "1");
  const MemoryMap last(std::move(target));
  EXPECT_EQ(Text(last), "1");
}

TEST_F(MemoryMapTest, ReadsBytesWithoutMappingThem) {
  WriteFileAtomically(folder_ / "file", "abcdef");
  const MemoryMap map(folder_ / "file");
  uint8_t bytes[3];
  map.ReadAt(2, bytes);
  EXPECT_EQ(std::string(bytes, bytes + 3), "cde");
  EXPECT_THROW(map.ReadAt(4, bytes), InputError);
}

TEST_F(MemoryMapTest, EmptyFileIsAnEmptySpan) {
  WriteFileAtomically(folder_.path() / "empty", "");
  EXPECT_TRUE(MemoryMap(folder_.path() / "empty").bytes().empty());
  EXPECT_TRUE(MemoryMap().bytes().empty());
}

TEST_F(MemoryMapTest, RefusesMissingFilesAndFolders) {
  EXPECT_THROW(MemoryMap(folder_.path() / "missing"), InputError);
  EXPECT_THROW(MemoryMap{folder_.path()}, InputError);
}

}  // namespace
}  // namespace skyquilt::base
