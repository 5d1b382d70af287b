#include "tour/export/script_data.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "tests/support/limited_file_size.h"
#include "tests/tour/export/sample_tour_project.h"

namespace skyquilt::tour {
namespace {

// RFC 4648, section 10.
TEST(Base64, IsThatOfTheStandard) {
  const std::pair<const char*, const char*> vectors[] = {
      {"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}, {"fooba", "Zm9vYmE="}, {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : vectors) EXPECT_EQ(Base64(bytes), text);
  EXPECT_EQ(Base64(std::string("\xfb\xff\xbe\0", 4)), "+/++AA==");
}

TEST(ScriptData, HasTheSizeThatWasForetold) {
  const TemporaryFolder folder;
  // Also around the pieces in which files are read.
  for (const size_t n : {0U, 1U, 2U, 3U, 4U, 1000U, (3U << 18U) - 1U, 3U << 18U, (3U << 18U) + 1U, (3U << 19U) + 2U}) {
    std::string content(n, '\0');
    for (size_t i = 0; i < n; ++i) content[i] = static_cast<char>(i * 37 + i / 251);
    base::WriteFileAtomically(folder / "file", content);
    const int64_t bytes = WriteScriptOf(folder / "data", "tiles/a-1_b.glb", folder / "file");
    EXPECT_EQ(bytes, ScriptBytes("tiles/a-1_b.glb", static_cast<int64_t>(n)));
    EXPECT_EQ(bytes, static_cast<int64_t>(std::filesystem::file_size(folder / "data/tiles/a-1_b.glb.js")));
    EXPECT_EQ(ContentOf(folder.path(), "tiles/a-1_b.glb"), content);
    EXPECT_EQ(WriteScript(folder / "data", "same", content), ScriptBytes("same", static_cast<int64_t>(n)));
    EXPECT_EQ(ContentOf(folder.path(), "same"), content);
  }
}

TEST(ScriptData, NamesNeedNoEscapes) {
  for (const char* name : {"", "/a", "../a", "a/../b", "a\"", "a b", "a\n", "\xc3\xa9", "a\\b"})
    EXPECT_THROW(RequireDataName(name), std::logic_error);
}

TEST(ScriptData, AFullDiskLeavesNothing) {
  const TemporaryFolder folder;
  {
    const LimitedFileSize full(1000);
    EXPECT_THROW(WriteScript(folder.path(), "a", std::string(5'000'000, 'x')), base::InputError);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace skyquilt::tour
