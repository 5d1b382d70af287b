#include "merge/look.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/errors.h"
#include "core/checkpoint/archive.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::merge {
namespace {

TEST(Look, IsReadWithItsWeights) {
  EXPECT_TRUE(ParseLook("").empty());
  EXPECT_TRUE(ParseLook("  ").empty());
  const std::vector<LookPart> one = ParseLook(" sun_10 ");
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(one[0].name, "sun_10");
  EXPECT_EQ(one[0].weight, 1.0);
  const std::vector<LookPart> two = ParseLook("a:b/1.jpg:0.25, noon:0");
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(two[0].name, "a:b/1.jpg");
  EXPECT_EQ(two[0].weight, 0.25);
  EXPECT_EQ(two[1].name, "noon");
  for (const char* bad : {"a:", "a:x", "a:-1", "a:nan", "a:inf", ":1", "a,,b", "a:0,b:0", "a:1x"}) {
    EXPECT_THROW(ParseLook(bad), base::UsageError) << bad;
  }
}

class LookFile : public testing::Test {
 protected:
  std::filesystem::path Write(const std::vector<float>& codes, const std::vector<uint8_t>& names) const {
    checkpoint::ArchiveWriter writer("block", 1);
    writer.Put("appearance/codes", codes, {static_cast<int64_t>(codes.size() / 2), 2});
    writer.Put("appearance/names", names);
    writer.Commit(folder_ / "block.h5");
    return folder_ / "block.h5";
  }
  TemporaryFolder folder_;
};

TEST_F(LookFile, IsTheWeightedMeanOfItsCodes) {
  const std::filesystem::path file = Write({1.0F, 2.0F, 5.0F, -2.0F, 0.5F, 0.25F}, {'a', 0, 'b', 'c', 0, 0});
  EXPECT_EQ(CodeOfLook(ParseLook("a"), file), (std::vector<float>{1.0F, 2.0F}));
  EXPECT_EQ(CodeOfLook(ParseLook("bc:3"), file), (std::vector<float>{5.0F, -2.0F}));
  EXPECT_EQ(CodeOfLook(ParseLook("a:0.5,bc:0.5"), file), (std::vector<float>{3.0F, 0.0F}));
  EXPECT_EQ(CodeOfLook(ParseLook("a:3,bc:1"), file), (std::vector<float>{2.0F, 1.0F}));
  try {
    CodeOfLook(ParseLook("noon"), file);
    FAIL() << "an unknown name";
  } catch (const base::UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("there are codes of a, bc"), std::string::npos) << error.what();
  }
}

TEST_F(LookFile, NeedsCodes) {
  EXPECT_THROW(CodeOfLook(ParseLook("a"), Write({1.0F, 2.0F}, {'a', 0, 'b', 0})), base::InputError);
  checkpoint::ArchiveWriter writer("block", 1);
  writer.Commit(folder_ / "none.h5");
  EXPECT_THROW(CodeOfLook(ParseLook("a"), folder_ / "none.h5"), base::UsageError);
}

}  // namespace
}  // namespace skyquilt::merge
