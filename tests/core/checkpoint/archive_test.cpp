#include "core/checkpoint/archive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <numeric>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/random.h"
#include "core/checkpoint/digest.h"
#include "core/checkpoint/user_block.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"
#include "tests/support/sanitizer.h"

#ifdef SKYQUILT_ADDRESS_SANITIZER
// HDF5 1.10 leaks memory when metadata is damaged.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libhdf5";
}
#endif

namespace skyquilt::checkpoint {
namespace {

using Archive = InTemporaryFolder;
using ArchiveCopies = InTemporaryFolder;
using ArchiveReaderTest = InTemporaryFolder;

void WriteBytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

// All that an archive can contain: special values, several chunks, groups, empty arrays.
struct Content {
  std::vector<float> table;
  std::vector<double> matrix = {1.0, -0.0, 1e-300, std::numeric_limits<double>::infinity(), 5.0, 6.0};
  std::vector<uint8_t> bits = {0, 1, 255};
  std::vector<int64_t> numbers = {std::numeric_limits<int64_t>::min(), -1, std::numeric_limits<int64_t>::max()};
  std::vector<float> none;
  std::string text = "[train]\nrate = 0.01  # \xC3\xA4\n";

  explicit Content(size_t n_table = 1000) : table(n_table) {
    base::Random random(7);
    for (float& value : table) value = static_cast<float>(random.Normal());
    if (!table.empty()) table[0] = std::numeric_limits<float>::quiet_NaN();
  }

  ArchiveWriter Writer() const {
    ArchiveWriter writer("block", 3);
    writer.Put("table/level0", table);
    writer.Put("table/moments/first", matrix, {2, 3});
    writer.Put("occupancy", bits, {1, 3, 1});
    writer.Put("random", numbers);
    writer.Put("none", none);
    writer.SetAttribute("config", text);
    writer.SetAttribute("empty", std::string());
    writer.SetAttribute("rate", 0.1);
    writer.SetAttribute("step", int64_t{1} << 60);
    writer.SetAttribute("small", 5);
    return writer;
  }
};

// Updates length and digest in the user block after a change of the bytes.
void Resign(std::string* bytes) {
  Digest digest;
  digest.Update({reinterpret_cast<const uint8_t*>(bytes->data()) + kUserBlockBytes, bytes->size() - kUserBlockBytes});
  const std::string block = UserBlockText("block", 3, {bytes->size(), digest.Value()});
  bytes->replace(0, kUserBlockBytes, block);
}

template <typename T>
bool SameBits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool Holds(const ArchiveReader& reader, const Content& content) {
  return reader.kind() == "block" && reader.version() == 3 && SameBits(reader.Floats("table/level0"), content.table) &&
         SameBits(reader.Doubles("table/moments/first"), content.matrix) && SameBits(reader.Bytes("occupancy"), content.bits) &&
         SameBits(reader.Ints("random"), content.numbers) && reader.Floats("none").empty() && reader.StringAttribute("config") == content.text &&
         reader.StringAttribute("empty").empty() && reader.DoubleAttribute("rate") == 0.1 && reader.IntAttribute("step") == int64_t{1} << 60 &&
         reader.IntAttribute("small") == 5;
}

TEST_F(Archive, KeepsEveryBit) {
  const std::filesystem::path file = folder_.path() / "block.h5";
  for (const size_t n : {size_t{0}, size_t{1}, size_t{1000}, size_t{1500001}}) {  // none, one, some, several chunks with an incomplete last one
    const Content content(n);
    content.Writer().Commit(file);
    const ArchiveReader reader(file);
    EXPECT_TRUE(Holds(reader, content)) << n;
    EXPECT_EQ(reader.Shape("table/level0"), (std::vector<int64_t>{static_cast<int64_t>(n)}));
  }
}

TEST_F(Archive, ReadsTheRowsThatAreAskedFor) {
  // Larger than a chunk.
  constexpr int64_t kRows = 700, kEach = 2 * 500;
  std::vector<float> values(static_cast<size_t>(kRows * kEach));
  for (size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
  ArchiveWriter writer("context", 1);
  writer.Put("bands", values, {kRows, 2, 500});
  writer.Commit(folder_ / "a.h5");
  const ArchiveReader reader(folder_ / "a.h5");
  for (const std::vector<int64_t>& rows : {std::vector<int64_t>{}, {0}, {699}, {0, 1, 2, 5, 300, 301, 698, 699}}) {
    std::vector<float> expected;
    for (const int64_t row : rows) expected.insert(expected.end(), values.begin() + row * kEach, values.begin() + (row + 1) * kEach);
    EXPECT_EQ(reader.FloatRows("bands", rows), expected);
  }
  std::vector<int64_t> all(static_cast<size_t>(kRows));
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(reader.FloatRows("bands", all), reader.Floats("bands"));
  EXPECT_THROW(reader.FloatRows("bands", std::vector<int64_t>{1, 1}), std::logic_error);
  EXPECT_THROW(reader.FloatRows("bands", std::vector<int64_t>{700}), std::logic_error);
  EXPECT_THROW(reader.FloatRows("none", std::vector<int64_t>{0}), base::InputError);
}

TEST_F(Archive, ListsItsContent) {
  const Content content;
  content.Writer().Commit(folder_.path() / "a.h5");
  const ArchiveReader reader(folder_.path() / "a.h5");
  EXPECT_EQ(reader.Names(), (std::vector<std::string>{"none", "occupancy", "random", "table/level0", "table/moments/first"}));
  EXPECT_EQ(reader.AttributeNames(), (std::vector<std::string>{"config", "empty", "rate", "small", "step"}));
  EXPECT_EQ(reader.Shape("table/moments/first"), (std::vector<int64_t>{2, 3}));
  EXPECT_EQ(reader.Shape("occupancy"), (std::vector<int64_t>{1, 3, 1}));
  EXPECT_EQ(reader.TypeName("occupancy"), "uint8");
  EXPECT_EQ(reader.TypeName("none"), "float32");
  EXPECT_TRUE(reader.Has("random"));
  EXPECT_FALSE(reader.Has("table"));
  EXPECT_TRUE(reader.HasAttribute("rate"));
  EXPECT_FALSE(reader.HasAttribute("skyquilt.kind"));
}

TEST_F(Archive, HoldsLongTextsAndManyAttributes) {
  ArchiveWriter writer("context", 1);
  const std::string text(300000, 'x');
  writer.SetAttribute("long", text);
  for (int i = 0; i < 200; ++i) writer.SetAttribute("attribute" + std::to_string(i), i);
  writer.Commit(folder_.path() / "a.h5");
  const ArchiveReader reader(folder_.path() / "a.h5");
  EXPECT_EQ(reader.StringAttribute("long"), text);
  EXPECT_EQ(reader.IntAttribute("attribute199"), 199);
}

TEST_F(Archive, SameContentGivesTheSameBytes) {
  Content().Writer().Commit(folder_.path() / "a.h5");
  Content().Writer().Commit(folder_.path() / "b.h5");
  EXPECT_EQ(base::ReadFile(folder_.path() / "a.h5"), base::ReadFile(folder_.path() / "b.h5"));
}

TEST_F(Archive, RefusesNamesThatAreAbsentOrOfAnotherType) {
  Content().Writer().Commit(folder_.path() / "a.h5");
  const ArchiveReader reader(folder_.path() / "a.h5");
  EXPECT_NE(InputErrorOf([&] { reader.Floats("absent"); }).find("no array 'absent'"), std::string::npos);
  EXPECT_NE(InputErrorOf([&] { reader.Doubles("table/level0"); }).find("float32 where float64"), std::string::npos);
  EXPECT_NE(InputErrorOf([&] { reader.IntAttribute("absent"); }).find("no attribute"), std::string::npos);
  EXPECT_NE(InputErrorOf([&] { reader.IntAttribute("rate"); }).find("not as a whole number"), std::string::npos);
}

TEST_F(Archive, MisuseIsABug) {
  const std::vector<float> values(6);
  ArchiveWriter writer("block", 1);
  writer.Put("a/b", values);
  EXPECT_THROW(writer.Put("a/b", values), std::logic_error);
  EXPECT_THROW(writer.Put("a", values), std::logic_error);
  EXPECT_THROW(writer.Put("a/b/c", values), std::logic_error);
  EXPECT_THROW(writer.Put("/x", values), std::logic_error);
  EXPECT_THROW(writer.Put("", values), std::logic_error);
  EXPECT_THROW(writer.Put("x", values, {2, 2}), std::logic_error);
  EXPECT_THROW(writer.Put("x", values, {-1, -6}), std::logic_error);
  EXPECT_THROW(writer.SetAttribute("skyquilt.kind", 1), std::logic_error);
}

TEST_F(ArchiveReaderTest, NamesTheReasonWhyAFileIsNoArchive) {
  const std::filesystem::path file = folder_.path() / "a.h5";
  const auto message = [&](const std::string& bytes) {
    WriteBytes(file, bytes);
    return InputErrorOf([&] { const ArchiveReader reader(file); });
  };
  EXPECT_NE(InputErrorOf([&] { const ArchiveReader reader(folder_.path() / "absent.h5"); }).find("does not exist"), std::string::npos);
  EXPECT_NE(InputErrorOf([&] { const ArchiveReader reader(folder_.path()); }).find("is not a file"), std::string::npos);
  EXPECT_NE(message("").find("is not a Skyquilt archive"), std::string::npos);
  EXPECT_NE(message("some text").find("is not a Skyquilt archive"), std::string::npos);
  EXPECT_NE(message("\x89HDF\r\n\x1A\n and more").find("HDF5 file that Skyquilt did not write"), std::string::npos);
  EXPECT_NE(message("SKYQUILT ARCHIVE 2\n" + std::string(600, '\0')).find("newer Skyquilt"), std::string::npos);
}

TEST_F(ArchiveReaderTest, NoticesEveryFlippedBit) {
  const std::filesystem::path file = folder_.path() / "a.h5";
  const Content content;
  content.Writer().Commit(file);
  const std::string good = base::ReadFile(file);
  base::Random random(2024);
  for (int i = 0; i < 300; ++i) {
    std::string bad = good;
    // A third of the flips are in the first 1.5 kB, with the user block and HDF5's header.
    const size_t at = random.Below(static_cast<uint32_t>(i % 3 == 0 ? 1536 : bad.size()));
    bad[at] = static_cast<char>(bad[at] ^ (1 << random.Below(8)));
    WriteBytes(file, bad);
    EXPECT_NE(InputErrorOf([&] { const ArchiveReader reader(file); }), "") << "flip at " << at;
  }
}

TEST_F(ArchiveReaderTest, NoticesEveryTruncationAndAddition) {
  const std::filesystem::path file = folder_.path() / "a.h5";
  Content().Writer().Commit(file);
  const std::string good = base::ReadFile(file);
  base::Random random(2025);
  for (int i = 0; i < 40; ++i) {
    const size_t n = i < 3 ? good.size() - 1 - static_cast<size_t>(i) : random.Below(static_cast<uint32_t>(good.size()));
    WriteBytes(file, good.substr(0, n));
    EXPECT_NE(InputErrorOf([&] { const ArchiveReader reader(file); }), "") << "cut to " << n;
  }
  WriteBytes(file, good + '\0');
  EXPECT_NE(InputErrorOf([&] { const ArchiveReader reader(file); }), "");
}

// Damage with a matching digest, as from a bug in a program: HDF5's checks and ours give an error or the right content, never a crash.
TEST_F(ArchiveReaderTest, SurvivesDamageBehindAValidDigest) {
  const std::filesystem::path file = folder_.path() / "a.h5";
  const Content content;
  content.Writer().Commit(file);
  const std::string good = base::ReadFile(file);
  base::Random random(2026);
  int n_refused = 0;
  for (int i = 0; i < 100; ++i) {
    std::string bad = good;
    const size_t at = 512 + random.Below(static_cast<uint32_t>(bad.size() - 512));
    bad[at] = static_cast<char>(bad[at] ^ (1 << random.Below(8)));
    Resign(&bad);
    WriteBytes(file, bad);
    try {
      const ArchiveReader reader(file);
      EXPECT_TRUE(Holds(reader, content)) << "flip at " << at;
    } catch (const base::InputError&) {
      ++n_refused;
    }
  }
  EXPECT_GT(n_refused, 50);
}

TEST_F(ArchiveCopies, ArraysOfOtherFilesAreStoredLikeThoseInMemory) {
  const Content content(300'000);
  content.Writer().Commit(folder_ / "part.h5");
  const auto joined = [&](bool copied) {
    ArchiveWriter writer("scene", 1);
    writer.SetAttribute("parts", 1);
    for (const char* name : {"table/level0", "table/moments/first", "occupancy", "random", "none"}) {
      if (copied) writer.PutCopy("0/" + std::string(name), folder_ / "part.h5", name);
    }
    if (!copied) {
      writer.Put("0/table/level0", content.table);
      writer.Put("0/table/moments/first", content.matrix, {2, 3});
      writer.Put("0/occupancy", content.bits, {1, 3, 1});
      writer.Put("0/random", content.numbers);
      writer.Put("0/none", content.none);
    }
    const std::filesystem::path file = folder_ / (copied ? "copied.h5" : "put.h5");
    writer.Commit(file);
    return base::ReadFile(file);
  };
  EXPECT_TRUE(joined(true) == joined(false));
}

TEST_F(ArchiveCopies, FloatsMayBeStoredIn16Bits) {
  const Content content(300'000);
  content.Writer().Commit(folder_ / "part.h5");
  uintmax_t bytes[3] = {};
  for (const Precision precision : {Precision::kFloat32, Precision::kBfloat16, Precision::kFloat16}) {
    const auto which = static_cast<size_t>(precision);
    const std::filesystem::path file = folder_ / ("short" + std::to_string(which) + ".h5");
    ArchiveWriter writer("scene", 1);
    for (const char* name : {"table/level0", "table/moments/first", "occupancy", "none"}) writer.PutCopy(name, folder_ / "part.h5", name, precision);
    writer.Commit(file);
    bytes[which] = std::filesystem::file_size(file);
    const ArchiveReader reader(file);
    EXPECT_EQ(reader.TypeName("table/level0"), (std::vector<std::string>{"float32", "bfloat16", "float16"})[which]);
    EXPECT_EQ(reader.TypeName("table/moments/first"), "float64");
    EXPECT_EQ(reader.Bytes("occupancy"), content.bits);
    EXPECT_TRUE(reader.Floats("none").empty());
    const std::vector<float> table = reader.Floats("table/level0");
    ASSERT_EQ(table.size(), content.table.size());
    const float error = std::vector<float>{0.0F, 0x1p-8F, 0x1p-11F}[which];
    EXPECT_TRUE(std::isnan(table[0]));
    for (size_t i = 1; i < table.size(); ++i) ASSERT_NEAR(table[i], content.table[i], error * std::abs(content.table[i]) + 1e-7F) << i;
    // A copy in another archive keeps them unchanged.
    ArchiveWriter again("scene", 1);
    again.PutCopy("t", file, "table/level0");
    again.Commit(folder_ / "again.h5");
    const std::vector<float> same = ArchiveReader(folder_ / "again.h5").Floats("t");
    EXPECT_EQ(std::memcmp(same.data(), table.data(), table.size() * sizeof(float)), 0);
  }
  EXPECT_LT(static_cast<double>(bytes[1]), 0.55 * static_cast<double>(bytes[0]));
  EXPECT_EQ(bytes[1], bytes[2]);
}

TEST_F(ArchiveCopies, KeepOnlyTheChosenGroups) {
  base::Random random(3);
  std::vector<float> values(4 * 1001);
  for (float& value : values) value = random.Uniform() - 0.5F;
  ArchiveWriter part("block", 1);
  part.Put("grid", values);
  part.Commit(folder_ / "part.h5");
  std::vector<uint8_t> keep(126, 0);
  for (const uint32_t group : {0U, 7U, 8U, 500U, 1000U}) keep[group / 8] = static_cast<uint8_t>(keep[group / 8] | 1U << group % 8);
  for (const Precision precision : {Precision::kFloat32, Precision::kBfloat16}) {
    ArchiveWriter writer("scene", 1);
    writer.PutPruned("grid", folder_ / "part.h5", "grid", keep, 4, precision);
    writer.PutPruned("nothing", folder_ / "part.h5", "grid", std::vector<uint8_t>(126, 0), 4, precision);
    writer.Commit(folder_ / "kept.h5");
    const ArchiveReader reader(folder_ / "kept.h5");
    EXPECT_EQ(reader.Shape("grid"), std::vector<int64_t>{20});
    const std::vector<float> back = reader.PrunedFloats("grid");
    ASSERT_EQ(back.size(), values.size());
    for (size_t i = 0; i < back.size(); ++i) {
      const bool kept = (keep[i / 32] >> (i / 4) % 8 & 1U) != 0;
      ASSERT_NEAR(back[i], kept ? values[i] : 0.0F, precision == Precision::kFloat32 ? 0.0 : 0x1p-9) << i;
    }
    EXPECT_EQ(reader.PrunedFloats("nothing"), std::vector<float>(values.size(), 0.0F));
  }
  // Arrays stored whole are read whole.
  EXPECT_EQ(ArchiveReader(folder_ / "part.h5").PrunedFloats("grid"), values);
  ArchiveWriter writer("scene", 1);
  EXPECT_THROW(writer.PutPruned("a", folder_ / "part.h5", "grid", keep, 3), std::logic_error);
  EXPECT_THROW(writer.PutPruned("a", folder_ / "part.h5", "grid", {1}, 4), std::logic_error);
  EXPECT_THROW(writer.PutPruned("a", folder_ / "part.h5", "absent", keep, 4), base::InputError);
}

TEST_F(ArchiveCopies, BitsThatDoNotMatchTheStoredGroupsAreRefused) {
  const auto refused = [&](const std::vector<float>& kept, const std::vector<uint8_t>& bits, const std::vector<int64_t>& sizes) {
    ArchiveWriter writer("scene", 1);
    writer.Put("grid", kept);
    writer.Put("grid_keep", bits);
    writer.Put("grid_keep_sizes", sizes);
    writer.Commit(folder_ / "foreign.h5");
    EXPECT_THROW(ArchiveReader(folder_ / "foreign.h5").PrunedFloats("grid"), base::InputError);
  };
  refused({1, 2, 3, 4}, {3}, {4, 32});
  refused({1, 2, 3, 4}, {1}, {4, 64});
  refused({1, 2, 3, 4}, {1}, {4, 30});
  refused({1, 2, 3, 4}, {1}, {0, 32});
  refused({1, 2, 3, 4}, {1}, {-4, -32});
  refused({1, 2, 3, 4}, {1}, {4});
}

TEST_F(ArchiveCopies, NamesMissingFilesAndArrays) {
  Content(10).Writer().Commit(folder_ / "part.h5");
  ArchiveWriter writer("scene", 1);
  EXPECT_THROW(writer.PutCopy("a", folder_ / "absent.h5", "random"), base::InputError);
  EXPECT_THROW(writer.PutCopy("a", folder_ / "part.h5", "absent"), base::InputError);
  // The source file is removed before Commit: nothing is written.
  writer.PutCopy("a", folder_ / "part.h5", "random");
  writer.PutCopy("b", folder_ / "part.h5", "occupancy");
  ArchiveWriter other("scene", 1);
  Content(10).Writer().Commit(folder_ / "second.h5");
  other.PutCopy("a", folder_ / "part.h5", "random");
  other.PutCopy("b", folder_ / "second.h5", "random");
  std::filesystem::remove(folder_ / "part.h5");
  EXPECT_THROW(other.Commit(folder_ / "joined.h5"), base::InputError);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "joined.h5"));
}

}  // namespace
}  // namespace skyquilt::checkpoint
