#include "core/base/memory_map.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::base {

void MemoryMap::ReleasePages() const {
  // Only a hint: when it is refused, the system drops the pages by itself when memory is short.
  if (data_ != nullptr) static_cast<void>(madvise(const_cast<uint8_t*>(data_), size_, MADV_DONTNEED));
}

MemoryMap::MemoryMap(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) ThrowFileError(file, "cannot open", errno);
  struct stat status = {};
  if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
    const int code = S_ISDIR(status.st_mode) ? EISDIR : EINVAL;
    close(descriptor);
    ThrowFileError(file, "cannot map into memory", code);
  }
  const auto size = static_cast<size_t>(status.st_size);
  if (size > 0) {
    void* address = mmap(nullptr, size, PROT_READ, MAP_SHARED, descriptor, 0);
    if (address == MAP_FAILED) {
      const int code = errno;
      close(descriptor);
      ThrowFileError(file, "cannot map into memory", code);
    }
    data_ = static_cast<const uint8_t*>(address);
    size_ = size;
  }
  descriptor_ = descriptor;
  file_ = file;
}

MemoryMap::~MemoryMap() {
  if (data_ != nullptr) munmap(const_cast<uint8_t*>(data_), size_);
  if (descriptor_ >= 0) close(descriptor_);
}

void MemoryMap::ReadAt(size_t offset, std::span<uint8_t> to) const {
  for (size_t done = 0; done < to.size();) {
    const ssize_t n = pread(descriptor_, to.data() + done, to.size() - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) ThrowFileError(file_, "cannot read", errno);
    if (n == 0) throw InputError(file_, "became shorter while it was in use", "Run the command again");
    done += static_cast<size_t>(n);
  }
}

MemoryMap::MemoryMap(MemoryMap&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)),
      size_(std::exchange(other.size_, 0)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      file_(std::move(other.file_)) {}

MemoryMap& MemoryMap::operator=(MemoryMap&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(file_, other.file_);
  return *this;
}

}  // namespace skyquilt::base
