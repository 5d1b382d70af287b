// RAII for HDF5 identifiers, the lock of the library, and its last error as text. Private to core/checkpoint. Uses plain integer types, so that only
// .cpp files include hdf5.h (hdf5_handle.cpp asserts that they are the library's types).
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace skyquilt::checkpoint {

using HdfId = int64_t;               // hid_t
using HdfSize = unsigned long long;  // hsize_t

// Holds the library's lock while it exists, and turns off the library's own error messages.
class HdfLock {
 public:
  HdfLock();

 private:
  std::lock_guard<std::recursive_mutex> lock_;
};

// Owns an identifier and closes it with its closing function (H5Fclose, H5Dclose, ...).
class Handle {
 public:
  using Closer = int (*)(HdfId);
  Handle() = default;
  Handle(HdfId id, Closer closer) : id_(id), closer_(closer) {}
  ~Handle() { Close(); }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), closer_(other.closer_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(closer_, other.closer_);
    return *this;
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  bool Valid() const { return id_ >= 0; }
  HdfId id() const { return id_; }
  // False if closing failed, for instance because buffered data cannot be written to a full disk.
  bool Close() {
    if (id_ < 0) return true;
    return closer_(std::exchange(id_, -1)) >= 0;
  }

 private:
  HdfId id_ = -1;
  Closer closer_ = nullptr;
};

// The most specific message on the library's error stack.
std::string HdfErrorText();

// The element types of an archive.
enum class ElementType { kFloat32, kFloat64, kUint8, kInt64, kBfloat16, kFloat16 };
size_t ElementBytes(ElementType type);
const char* ElementName(ElementType type);
// HDF5 types for the file (little-endian) and for memory (native); do not close them.
HdfId FileType(ElementType type);
HdfId MemoryType(ElementType type);

// File access properties: format of HDF5 1.10 (metadata with checksums), no file locks (many parallel file systems do not support them).
Handle FileAccess();
// Dataspace of an array; `shape` has at least one dimension.
Handle SimpleSpace(const std::vector<HdfSize>& shape);

}  // namespace skyquilt::checkpoint
