// HDF5 identifiers that close themselves, one lock for the library, and its last error as text. Private to this room's .cpp files;
// spelled with plain integers so that hdf5.h stays in those (hdf5_handle.cpp asserts that they are the library's types).
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

// Holds the library's lock and silences its own error printing.
class HdfLock {
 public:
  HdfLock();

 private:
  std::lock_guard<std::recursive_mutex> lock_;
};

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
  // False if closing failed, as it does when buffered data meets a full disk.
  bool Close() {
    if (id_ < 0) return true;
    return closer_(std::exchange(id_, -1)) >= 0;
  }

 private:
  HdfId id_ = -1;
  Closer closer_ = nullptr;
};

// The innermost description on the library's error stack.
std::string HdfErrorText();

// The element types of an archive.
enum class ElementType { kFloat32, kFloat64, kUint8, kInt64, kBfloat16, kFloat16 };
size_t ElementBytes(ElementType type);
const char* ElementName(ElementType type);
HdfId FileType(ElementType type);    // little-endian, never closed
HdfId MemoryType(ElementType type);  // native, never closed

// File access: format of HDF5 1.10 (checksummed metadata), no file locks (parallel file systems often lack them).
Handle FileAccess();
// rank 0 is not used; `shape` has at least one dimension.
Handle SimpleSpace(const std::vector<HdfSize>& shape);

}  // namespace skyquilt::checkpoint
