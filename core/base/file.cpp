#include "core/base/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <system_error>

#include "core/base/errors.h"
#include "core/base/random.h"

namespace skyquilt::base {
namespace {

namespace fs = std::filesystem;

class Descriptor {
 public:
  Descriptor(const fs::path& file, int flags, mode_t mode = 0666) : value_(open(file.c_str(), flags | O_CLOEXEC, mode)) {}
  ~Descriptor() {
    if (value_ >= 0) close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int value() const { return value_; }
  // Network file systems report some write errors only here.
  int Close() {
    const int result = close(value_);
    value_ = -1;
    return result;
  }

 private:
  int value_;
};

std::string FixOf(int code) {
  switch (code) {
    case ENOSPC:
    case EDQUOT:
      return "Free some space or choose another folder with -o";
    case EACCES:
    case EPERM:
    case EROFS:
      return "Change the permissions, or choose another folder with -o if it is for output";
    case ENOENT:
    case ENOTDIR:
    case EISDIR:
      return "Check the path";
    case EIO:
      return "The disk or its connection has errors; check it before running the command again";
    default:
      return "Check the path and the disk";
  }
}

fs::path FolderOf(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

// A name that no other process or thread uses, in the same folder so that the rename stays on one file system.
fs::path TemporaryBeside(const fs::path& file) {
  return FolderOf(file) / ("." + file.filename().string() + ".tmp." + RandomToken());
}

// 0 or the error number. *created: whether there is now a file of this process.
int WriteAndSync(const fs::path& file, std::string_view content, bool* created) {
  Descriptor out(file, O_WRONLY | O_CREAT | O_EXCL);
  *created = out.value() >= 0;
  if (!*created) return errno;
  while (!content.empty()) {
    const ssize_t n = write(out.value(), content.data(), content.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    content.remove_prefix(static_cast<size_t>(n));
  }
  if (fsync(out.value()) != 0) return errno;
  return out.Close() == 0 ? 0 : errno;
}

}  // namespace

void ThrowFileError(const fs::path& file, const std::string& finding, int code) {
  throw InputError(file, finding + ": " + std::generic_category().message(code), FixOf(code));
}

std::string ReadFile(const fs::path& file) {
  const Descriptor in(file, O_RDONLY);
  if (in.value() < 0) ThrowFileError(file, "cannot open", errno);
  std::string content;
  struct stat status = {};
  if (fstat(in.value(), &status) == 0 && S_ISREG(status.st_mode)) content.reserve(static_cast<size_t>(status.st_size));
  std::array<char, 1 << 16> buffer;
  for (;;) {
    const ssize_t n = read(in.value(), buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) ThrowFileError(file, "cannot read", errno);
    if (n == 0) return content;
    content.append(buffer.data(), static_cast<size_t>(n));
  }
}

void WriteFileAtomically(const fs::path& file, std::string_view content) {
  const fs::path temporary = TemporaryBeside(file);
  bool created = false;
  int code = WriteAndSync(temporary, content, &created);
  if (code == 0 && rename(temporary.c_str(), file.c_str()) != 0) code = errno;
  if (code != 0) {
    if (created) unlink(temporary.c_str());
    ThrowFileError(file, "cannot write", code);
  }
  SyncPath(FolderOf(file));
}

void Rename(const fs::path& from, const fs::path& to) {
  if (rename(from.c_str(), to.c_str()) != 0) ThrowFileError(to, "cannot be renamed from " + from.string(), errno);
}

void Publish(const fs::path& from, const fs::path& to) {
  SyncPath(from);
  Rename(from, to);
  SyncPath(FolderOf(to));
}

void SyncPath(const fs::path& path) {
  const Descriptor descriptor(path, O_RDONLY);
  if (descriptor.value() < 0) ThrowFileError(path, "cannot open", errno);
  if (fsync(descriptor.value()) == 0) return;
  // Some file systems cannot sync a folder and return EINVAL; nothing more can be done there.
  if (errno == EINVAL || errno == ENOTSUP) return;
  ThrowFileError(path, "cannot write to disk", errno);
}

void RequireWritableFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) ThrowFileError(folder, "cannot create the folder", error.value());
  if (!fs::is_directory(folder)) throw InputError(folder, "is a file, but a folder is needed", "Choose another folder with -o");
  const fs::path probe = TemporaryBeside(folder / "probe");
  bool created = false;
  const int code = WriteAndSync(probe, "probe", &created);
  if (created) unlink(probe.c_str());
  if (code != 0) ThrowFileError(folder, "cannot write into the folder", code);
}

std::string HashHex(std::string_view bytes) {
  uint64_t hash = 14695981039346656037ULL;
  for (const char byte : bytes) {
    hash ^= static_cast<unsigned char>(byte);
    hash *= 1099511628211ULL;
  }
  std::string text(16, '0');
  for (size_t i = 16; i-- > 0; hash >>= 4U) text[i] = "0123456789abcdef"[hash & 15U];
  return text;
}

}  // namespace skyquilt::base
