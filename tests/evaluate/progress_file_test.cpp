#include "evaluate/progress_file.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/checkpoint/digest.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate {
namespace {

class ProgressFiles : public ::testing::Test {
 protected:
  ProgressFiles() { base::SetLogLevel(base::LogLevel::kError); }  // every refusal would be a line
  ~ProgressFiles() override { base::SetLogLevel(base::LogLevel::kInfo); }

  void Write(const std::string& key) const {
    ProgressFile(path_, key).Write(0, [](base::BytePacker* out) { out->Add(std::vector<double>{1.0, 2.0}); });
  }
  // Whether the file was used. One that was not must be gone.
  bool Used(const std::string& key) const {
    std::vector<double> values;
    const bool used = ProgressFile(path_, key).Read([&](base::ByteUnpacker* in) { in->Take(&values); });
    EXPECT_EQ(used, std::filesystem::exists(path_));
    EXPECT_TRUE(!used || values == std::vector<double>({1.0, 2.0}));
    return used;
  }
  // Without waiting for the disk, as there are hundreds.
  void Put(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }
  // With the digest that belongs to it.
  void Replace(std::string content) const {
    checkpoint::Digest digest;
    digest.Update({reinterpret_cast<const uint8_t*>(content.data()), content.size()});
    base::BytePacker end;
    end.Add(digest.Value());
    Put(content + end.bytes());
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "progress.bin";
};

TEST_F(ProgressFiles, AreReadBackUntilRemoved) {
  EXPECT_FALSE(Used("a"));
  Write("a");
  EXPECT_TRUE(Used("a"));
  EXPECT_TRUE(Used("a"));
  ProgressFile(path_, "a").Remove();
  EXPECT_FALSE(Used("a"));
}

TEST_F(ProgressFiles, OfAnotherKeyAreNotUsed) {
  for (const char* other : {"", "A", "ab", "b"}) {
    Write("a");
    EXPECT_FALSE(Used(other)) << other;
  }
}

TEST_F(ProgressFiles, DamageAtAnyByteIsFound) {
  Write("key");
  const std::string whole = base::ReadFile(path_);
  for (size_t i = 0; i < whole.size(); ++i) {
    for (const int flipped : {0x01, 0x80, 0xFF}) {
      std::string damaged = whole;
      damaged[i] = static_cast<char>(damaged[i] ^ flipped);
      Put(damaged);
      EXPECT_FALSE(Used("key")) << "byte " << i;
    }
    Put(whole.substr(0, i));
    EXPECT_FALSE(Used("key")) << "cut to " << i;
  }
  Put(whole + '\0');
  EXPECT_FALSE(Used("key"));
  Put(whole);
  EXPECT_TRUE(Used("key"));
}

TEST_F(ProgressFiles, OfAnotherVersionOrKindOrLengthAreNotUsed) {
  Write("key");
  const std::string whole = base::ReadFile(path_);
  const std::string content = whole.substr(0, whole.size() - sizeof(uint64_t));
  Replace(content);
  EXPECT_TRUE(Used("key"));
  std::string newer = content;
  ++newer[ProgressFile::kMagic.size()];
  Replace(newer);
  EXPECT_FALSE(Used("key"));
  std::string other_kind = content;
  ++other_kind[0];
  Replace(other_kind);
  EXPECT_FALSE(Used("key"));
  Replace(content + "x");
  EXPECT_FALSE(Used("key"));
  Replace(content.substr(0, content.size() - 1));
  EXPECT_FALSE(Used("key"));
}

TEST_F(ProgressFiles, WhatTheCallerRefusesIsNotUsed) {
  Write("key");
  EXPECT_FALSE(ProgressFile(path_, "key").Read([](base::ByteUnpacker* in) { in->Fail(); }));
  EXPECT_FALSE(std::filesystem::exists(path_));
}

}  // namespace
}  // namespace skyquilt::evaluate
