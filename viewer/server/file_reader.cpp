#include "viewer/server/file_reader.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

namespace skyquilt::viewer::server {

std::optional<FileReader> FileReader::Open(const std::filesystem::path& file) {
  // Non-blocking, so that opening a named pipe does not wait for its writer.
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return {};
  FileReader reader(descriptor, 0);
  struct stat status {};
  if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) return {};
  reader.left_ = static_cast<uint64_t>(status.st_size);
  return reader;
}

FileReader::~FileReader() {
  if (descriptor_ >= 0) close(descriptor_);
}

FileReader::FileReader(FileReader&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)), left_(std::exchange(other.left_, 0)) {}

FileReader& FileReader::operator=(FileReader&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(left_, other.left_);
  return *this;
}

bool FileReader::Read(std::string& bytes) {
  bytes.resize(std::min<uint64_t>(left_, 64U << 10U));
  size_t filled = 0;
  while (filled < bytes.size()) {
    const ssize_t got = read(descriptor_, bytes.data() + filled, bytes.size() - filled);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    filled += static_cast<size_t>(got);
  }
  left_ -= filled;
  return true;
}

}  // namespace skyquilt::viewer::server
