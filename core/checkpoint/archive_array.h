// Arrays on their way into an archive, also those of other archives and those stored with fewer bits. Private to this room's .cpp files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/checkpoint/archive.h"
#include "core/checkpoint/hdf5_handle.h"

namespace skyquilt::checkpoint {

struct Array {
  ElementType type = ElementType::kUint8;  // in the file
  const void* data = nullptr;
  std::vector<HdfSize> shape;
  size_t n_bytes = 0;                 // in the file
  std::filesystem::path copied_from;  // instead of data: an array of another archive
  std::string copied_array;
  std::span<const uint8_t> keep;  // of a copy: one bit for each `group` floats; group 0: all are kept
  int64_t group = 0;
};

// Names of what PutKept stores beside an array.
inline std::string KeepBitsName(const std::string& name) {
  return name + "_keep";
}
inline std::string KeepSizesName(const std::string& name) {
  return name + "_keep_sizes";
}
inline bool IsKept(std::span<const uint8_t> keep, int64_t group) {
  return (keep[static_cast<size_t>(group / 8)] >> static_cast<unsigned>(group % 8) & 1U) != 0;
}
int64_t CountKept(std::span<const uint8_t> keep, int64_t groups);
// Kept groups to their places among `total` numbers, zero elsewhere.
std::vector<float> Spread(const std::vector<float>& kept, std::span<const uint8_t> keep, int64_t group, int64_t total);

// ElementName and its inverse for what TypeName gave.
ElementType ElementOf(const std::string& name);
// What an array becomes when floats are to have this precision.
ElementType StoredAs(ElementType type, Precision precision);
bool IsShortFloat(ElementType type);

// An archive's array as the bytes that a file with this element type holds: floats are shortened when the type is a short float.
std::vector<std::byte> AsStored(const ArchiveReader& reader, const std::string& name, ElementType type);
std::vector<float> FloatsOf(const std::vector<uint16_t>& stored, ElementType type);

// Arrays of other archives; one file is open and one array in memory at a time.
class Copies {
 public:
  const ArchiveReader& Reader(const std::filesystem::path& file);
  // The array's bytes as they are stored; good until the next call.
  const void* Data(const Array& array);

 private:
  std::filesystem::path file_;
  std::unique_ptr<ArchiveReader> reader_;
  std::vector<std::byte> bytes_;
};

}  // namespace skyquilt::checkpoint
