// Named arrays and attributes in one HDF5 file that is complete or absent.
// Writing: everything to <file>.tmp.<host>.<process>, flush, close, fsync, reopened and compared with memory, previous file kept as <file>.prev,
// rename, fsync of the folder. At every moment at least one complete file is there. Same content gives the same bytes. Every dataset is chunked with
// fletcher32 (so any HDF5 tool notices damage); the first 512 bytes, an HDF5 user block, say in plain text what the file is, its length and the XXH64
// digest of all bytes after them, so that a flipped bit anywhere is found before HDF5 sees the file. Calls are serialised by one lock, for HDF5 is
// not thread-safe.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace skyquilt::checkpoint {

// How an array of floats is kept in a file (core/base/half.h). Read back, all are floats.
enum class Precision { kFloat32, kBfloat16, kFloat16 };

// Collects by copy-free reference: spans given to Put must live until Commit.
class ArchiveWriter {
 public:
  // kind: what the file is ("block", "context", "scene"); version: of that kind's layout.
  ArchiveWriter(const std::string& kind, int version);
  ~ArchiveWriter();
  ArchiveWriter(ArchiveWriter&&) noexcept;

  // name may hold '/' for groups. shape empty: one-dimensional. Arrays of zero elements are legal. A name may be used once.
  void Put(const std::string& name, std::span<const float> values, const std::vector<int64_t>& shape = {});
  void Put(const std::string& name, std::span<const double> values, const std::vector<int64_t>& shape = {});
  void Put(const std::string& name, std::span<const uint8_t> values, const std::vector<int64_t>& shape = {});
  void Put(const std::string& name, std::span<const int64_t> values, const std::vector<int64_t>& shape = {});
  // The archive keeps these itself.
  void PutOwned(const std::string& name, std::vector<uint8_t> values);
  void PutOwned(const std::string& name, std::vector<int64_t> values);
  // An array of another archive, read when it is needed and not kept: what is joined need not fit in memory. The other file must stay as it is
  // until Commit. Throws base::InputError as ArchiveReader does; fastest when the names sort so that each file's arrays stand together.
  // precision: floats are kept with this one; other arrays stay what they are.
  void PutCopy(const std::string& name, const std::filesystem::path& file, const std::string& array, Precision precision = Precision::kFloat32);
  // The same without what nobody needs: of every `group` numbers of a one-dimensional array of floats the first decides by its bit in `keep` (the
  // first group in the lowest bit of the first byte). KeptFloats brings the array back; the bits are stored beside it.
  void PutKept(const std::string& name, const std::filesystem::path& file, const std::string& array, std::vector<uint8_t> keep, int64_t group,
               Precision precision = Precision::kFloat32);
  void SetAttribute(const std::string& name, const std::string& value);
  void SetAttribute(const std::string& name, double value);
  void SetAttribute(const std::string& name, int64_t value);
  void SetAttribute(const std::string& name, int value) { SetAttribute(name, static_cast<int64_t>(value)); }

  // Throws base::InputError (disk full, no permission, verification failed); the old file is untouched then.
  void Commit(const std::filesystem::path& file) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

class ArchiveReader {
 public:
  // Opens and verifies checksums and digest. Throws base::InputError with the reason: not HDF5, not ours, damaged.
  explicit ArchiveReader(const std::filesystem::path& file);
  ~ArchiveReader();
  ArchiveReader(ArchiveReader&&) noexcept;

  const std::string& kind() const;
  int version() const;
  // Throws base::InputError when the layout is of another version than the program's, naming both.
  void RequireVersion(int expected) const;
  std::vector<std::string> Names() const;           // of arrays, sorted
  std::vector<std::string> AttributeNames() const;  // sorted
  bool Has(const std::string& name) const;
  bool HasAttribute(const std::string& name) const;
  std::vector<int64_t> Shape(const std::string& name) const;
  std::string TypeName(const std::string& name) const;  // "float32", "float64", "uint8", "int64", "bfloat16", "float16"
  // Throw base::InputError when absent or of another type. Floats also gives those of 16 bits.
  std::vector<float> Floats(const std::string& name) const;
  // An array stored by PutKept, zero where nothing was kept; any other as Floats gives it.
  std::vector<float> KeptFloats(const std::string& name) const;
  std::vector<double> Doubles(const std::string& name) const;
  std::vector<uint8_t> Bytes(const std::string& name) const;
  std::vector<int64_t> Ints(const std::string& name) const;
  std::string StringAttribute(const std::string& name) const;
  double DoubleAttribute(const std::string& name) const;
  int64_t IntAttribute(const std::string& name) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// `file` if it opens and verifies, else <file>.prev if that does (with a warning), else empty with the reasons in *why.
std::filesystem::path NewestUsable(const std::filesystem::path& file, const std::string& kind, std::string* why);

}  // namespace skyquilt::checkpoint
