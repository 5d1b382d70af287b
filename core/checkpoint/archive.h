// Stores named arrays and attributes in an HDF5 file, for checkpoints and scenes. A crash or a full disk never leaves an incomplete file, and damage
// is always noticed.
// Writing: write <file>.tmp.<host>.<process>, fsync, reopen and compare with memory, keep the previous file as <file>.prev, rename, fsync the folder.
// At any moment at least one complete file exists. The same content gives the same bytes.
// Format: the first 512 bytes (an HDF5 user block) are plain text: the kind of file, its length and the XXH64 digest of all bytes after them, so that
// a flipped bit is found before HDF5 opens the file. All datasets are chunked with fletcher32 checksums, for other HDF5 tools.
// One lock serialises all calls, because HDF5 is not thread-safe.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace skyquilt::checkpoint {

// How floats are stored in the file (core/base/half.h); all are read back as 32-bit floats.
enum class Precision { kFloat32, kBfloat16, kFloat16 };

// Collects arrays and attributes, then writes them with Commit. Put does not copy: its spans must stay valid until Commit.
class ArchiveWriter {
 public:
  // kind: the type of file ("block", "context", "scene"); version: the version of its content.
  ArchiveWriter(const std::string& kind, int version);
  ~ArchiveWriter();
  ArchiveWriter(ArchiveWriter&&) noexcept;

  // name: unique; may contain '/' for HDF5 groups. shape: empty = one-dimensional. Arrays may be empty.
  void Put(const std::string& name, std::span<const float> values, const std::vector<int64_t>& shape = {});
  void Put(const std::string& name, std::span<const double> values, const std::vector<int64_t>& shape = {});
  void Put(const std::string& name, std::span<const uint8_t> values, const std::vector<int64_t>& shape = {});
  void Put(const std::string& name, std::span<const int64_t> values, const std::vector<int64_t>& shape = {});
  // The writer takes over these values.
  void PutOwned(const std::string& name, std::vector<uint8_t> values);
  void PutOwned(const std::string& name, std::vector<int64_t> values);
  void PutOwned(const std::string& name, std::vector<float> values);
  // Copies an array of another archive. It is read only while it is written, so that merged archives need not fit in memory; the other file must not
  // change until Commit. Fastest when sorting the names keeps each file's arrays together. precision: for floats; other arrays keep their type.
  // Throws base::InputError as ArchiveReader does.
  void PutCopy(const std::string& name, const std::filesystem::path& file, const std::string& array, Precision precision = Precision::kFloat32);
  // Copies only a part of a one-dimensional array of floats, to save space. The array is divided into groups of `group` floats; a group is stored if
  // its bit in `keep` is set (the first group is the lowest bit of the first byte). The bits are stored too; PrunedFloats restores the full array.
  void PutPruned(const std::string& name, const std::filesystem::path& file, const std::string& array, std::vector<uint8_t> keep, int64_t group,
                 Precision precision = Precision::kFloat32);
  void SetAttribute(const std::string& name, const std::string& value);
  void SetAttribute(const std::string& name, double value);
  void SetAttribute(const std::string& name, int64_t value);
  void SetAttribute(const std::string& name, int value) { SetAttribute(name, static_cast<int64_t>(value)); }

  // Writes the file. Throws base::InputError (disk full, no permission, verification failed); an old file is then unchanged.
  void Commit(const std::filesystem::path& file) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

class ArchiveReader {
 public:
  // Opens a file and verifies its digest. Throws base::InputError with the reason: missing, not an archive, damaged, written by a newer program.
  explicit ArchiveReader(const std::filesystem::path& file);
  ~ArchiveReader();
  ArchiveReader(ArchiveReader&&) noexcept;

  const std::string& kind() const;
  int version() const;
  // Throws base::InputError that names both versions unless the content has this version.
  void RequireVersion(int expected) const;
  std::vector<std::string> Names() const;           // of arrays, sorted
  std::vector<std::string> AttributeNames() const;  // sorted
  bool Has(const std::string& name) const;
  bool HasAttribute(const std::string& name) const;
  std::vector<int64_t> Shape(const std::string& name) const;
  std::string TypeName(const std::string& name) const;  // "float32", "float64", "uint8", "int64", "bfloat16", "float16"
  // Arrays and attributes by name. Throw base::InputError when absent or of another type. Floats also reads 16-bit floats.
  std::vector<float> Floats(const std::string& name) const;
  // Only these entries of the first dimension, ascending and each once: all of their floats, in the order of `rows`. Not of 16-bit floats.
  std::vector<float> FloatRows(const std::string& name, std::span<const int64_t> rows) const;
  // Like Floats, but restores the full size of an array from PutPruned, with zeros for the groups that were not stored.
  std::vector<float> PrunedFloats(const std::string& name) const;
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

// `file` if it is a valid archive of this kind, else <file>.prev if that is one (with a warning), else an empty path, with the reasons in *why.
std::filesystem::path NewestUsable(const std::filesystem::path& file, const std::string& kind, std::string* why);

}  // namespace skyquilt::checkpoint
