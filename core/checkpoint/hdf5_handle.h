// HDF5 identifiers that close themselves, one lock for the library, and its last error as text. Private to this room's .cpp files.
#pragma once

#include <hdf5.h>

#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace skyquilt::checkpoint {

// Holds the library's lock and silences its own error printing.
class HdfLock {
 public:
  HdfLock();

 private:
  std::lock_guard<std::mutex> lock_;
};

class Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  Handle() = default;
  Handle(hid_t id, Closer closer) : id_(id), closer_(closer) {}
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
  hid_t id() const { return id_; }
  // False if closing failed, as it does when buffered data meets a full disk.
  bool Close() {
    if (id_ < 0) return true;
    return closer_(std::exchange(id_, -1)) >= 0;
  }

 private:
  hid_t id_ = -1;
  Closer closer_ = nullptr;
};

// The innermost description on the library's error stack.
std::string HdfErrorText();

// The element types of an archive.
enum class ElementType { kFloat32, kFloat64, kUint8, kInt64 };
size_t ElementBytes(ElementType type);
const char* ElementName(ElementType type);
hid_t FileType(ElementType type);    // little-endian, never closed
hid_t MemoryType(ElementType type);  // native, never closed

// File access: format of HDF5 1.10 (checksummed metadata), no file locks (parallel file systems often lack them).
Handle FileAccess();
// rank 0 is not used; `shape` has at least one dimension.
Handle SimpleSpace(const std::vector<hsize_t>& shape);

}  // namespace skyquilt::checkpoint
