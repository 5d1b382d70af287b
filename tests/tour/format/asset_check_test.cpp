// Pictures and names of assets.
#include "tour/format/asset_check.h"

#include <gtest/gtest.h>

#include "tests/support/error_of.h"
#include "tests/tour/format/sample_assets.h"

namespace skyquilt::tour {
namespace {

// Why these bytes are not of this type; empty when they are.
std::string WhyNot(AssetType type, const std::string& bytes) {
  return ErrorOf<base::Refused>([&] { CheckAsset(type, BytesOf(bytes)); });
}

TEST(AssetName, IsADigestAndAType) {
  const std::string digest = base::Sha256Hex(std::string_view("x"));
  for (const char* extension : {"glb", "png", "jpg"}) {
    const auto name = ParseAssetName(digest + "." + extension);
    ASSERT_TRUE(name);
    EXPECT_EQ(name->digest, digest);
    EXPECT_EQ(name->File(), digest + "." + extension);
  }
  std::string upper = digest;
  upper[0] = 'A';
  for (const std::string& wrong :
       {std::string(), digest, digest + ".gif", digest + ".GLB", digest + ".jpeg", digest + ".glb/", "/" + digest + ".glb", "../" + digest + ".glb",
        digest.substr(1) + ".glb", digest + "0.glb", upper + ".glb", digest + "/glb", "." + digest.substr(1) + ".glb", digest + ".gl\0"}) {
    EXPECT_FALSE(ParseAssetName(wrong)) << wrong;
  }
}

TEST(AssetCheck, ContentDecidesTheType) {
  const std::pair<AssetType, std::string> files[] = {{AssetType::kGlb, SampleGlb()}, {AssetType::kPng, SamplePng()}, {AssetType::kJpg, SampleJpg()}};
  for (const auto& [type, ignored] : files) {
    for (const auto& [other, bytes] : files) EXPECT_EQ(WhyNot(type, bytes).empty(), type == other) << Extension(type) << " " << Extension(other);
    for (const char* bytes : {"", "G", "<svg onload=alert(1)>", "<!DOCTYPE html><script>", "GIF89a", "%PDF-1.7", "MZ"}) {
      EXPECT_NE(WhyNot(type, bytes), "") << Extension(type) << " " << bytes;
    }
  }
}

TEST(AssetCheck, NoPictureEndsEarly) {
  for (const auto& [type, whole] : {std::pair(AssetType::kPng, SamplePng()), std::pair(AssetType::kJpg, SampleJpg())}) {
    ASSERT_EQ(WhyNot(type, whole), "");
    for (size_t length = 0; length < whole.size(); ++length) EXPECT_NE(WhyNot(type, whole.substr(0, length)), "") << Extension(type) << " " << length;
  }
}

TEST(AssetCheck, NoByteOfAPngIsChanged) {
  const std::string whole = SamplePng();
  for (size_t i = 0; i < whole.size(); ++i) {
    std::string changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ 0x10);
    EXPECT_NE(WhyNot(AssetType::kPng, changed), "") << i;
  }
}

// Files that are two things at once.
TEST(AssetCheck, NothingStandsBeforeOrAfterAPicture) {
  const std::string page = "<html><script>alert(1)</script></html>";
  EXPECT_NE(WhyNot(AssetType::kPng, SamplePng() + page), "");
  EXPECT_NE(WhyNot(AssetType::kPng, page + SamplePng()), "");
  EXPECT_NE(WhyNot(AssetType::kJpg, page + SampleJpg()), "");
  EXPECT_EQ(WhyNot(AssetType::kJpg, SampleJpg() + SampleJpg()), "") << "cameras write previews there";
}

// A header alone, with its right checksum.
std::string PngHeader(uint32_t width, uint32_t height) {
  std::string png = SamplePng(4, 4);
  for (unsigned i = 0; i < 4; ++i) {
    png[16 + i] = static_cast<char>(width >> (24 - 8 * i) & 255U);
    png[20 + i] = static_cast<char>(height >> (24 - 8 * i) & 255U);
  }
  uint32_t crc = 0xFFFFFFFFU;
  for (size_t i = 12; i < 29; ++i) {
    crc ^= static_cast<unsigned char>(png[i]);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1U ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  crc = ~crc;
  for (unsigned i = 0; i < 4; ++i) png[29 + i] = static_cast<char>(crc >> (24 - 8 * i) & 255U);
  return png;
}

TEST(AssetCheck, PicturesHaveASaneSize) {
  EXPECT_EQ(WhyNot(AssetType::kPng, PngHeader(16384, 1)), "");
  for (const auto& [width, height] :
       {std::pair(16385U, 1U), std::pair(1U, 16385U), std::pair(0U, 1U), std::pair(1U, 0U), std::pair(UINT32_MAX, 1U)}) {
    const std::string reason = WhyNot(AssetType::kPng, PngHeader(width, height));
    EXPECT_TRUE(reason.find("16384") != std::string::npos || reason.find("is 0") != std::string::npos) << width << " x " << height << ": " << reason;
  }
  std::string jpg = SampleJpg();
  const size_t frame = jpg.find("\xFF\xC0");
  ASSERT_NE(frame, std::string::npos);
  jpg[frame + 7] = '\x7F';
  EXPECT_NE(WhyNot(AssetType::kJpg, jpg).find("16384"), std::string::npos);
  jpg = SampleJpg();
  jpg[frame + 1] = '\xC3';
  EXPECT_NE(WhyNot(AssetType::kJpg, jpg).find("browsers"), std::string::npos) << "lossless JPEG";
}

}  // namespace
}  // namespace skyquilt::tour
