// Arrays that ArchiveWriter is about to write: from memory or from other archives, whole or in part, possibly as 16-bit floats. Private to
// core/checkpoint.
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
  std::filesystem::path copied_from;  // the other archive, if the array is a copy; data is then null
  std::string copied_array;           // its name there
  std::span<const uint8_t> keep;      // for a copy: the groups to store, one bit each
  int64_t group = 0;                  // floats per group; 0: store all
};

// Names of the two arrays that PutPruned stores in addition.
inline std::string KeepBitsName(const std::string& name) {
  return name + "_keep";
}
inline std::string KeepSizesName(const std::string& name) {
  return name + "_keep_sizes";
}
inline bool IsStored(std::span<const uint8_t> keep, int64_t group) {
  return (keep[static_cast<size_t>(group / 8)] >> static_cast<unsigned>(group % 8) & 1U) != 0;
}
int64_t CountStored(std::span<const uint8_t> keep, int64_t groups);
// Puts the kept groups at their places in an array of `total` floats, with zeros elsewhere.
std::vector<float> Spread(const std::vector<float>& kept, std::span<const uint8_t> keep, int64_t group, int64_t total);

// The inverse of ElementName.
ElementType ElementOf(const std::string& name);
// The type in the file of an array that is stored with this precision.
ElementType StoredAs(ElementType type, Precision precision);
bool IsShortFloat(ElementType type);

// The bytes of an archive's array when stored as this element type: floats are converted if it is a 16-bit float.
std::vector<std::byte> AsStored(const ArchiveReader& reader, const std::string& name, ElementType type);
std::vector<float> FloatsOf(const std::vector<uint16_t>& stored, ElementType type);

// Reads arrays of other archives; keeps one file open and one array in memory at a time.
class Copies {
 public:
  const ArchiveReader& Reader(const std::filesystem::path& file);
  // The bytes to store; valid until the next call.
  const void* Data(const Array& array);

 private:
  std::filesystem::path file_;
  std::unique_ptr<ArchiveReader> reader_;
  std::vector<std::byte> bytes_;
};

}  // namespace skyquilt::checkpoint
