#include "core/base/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::base {

namespace {

constexpr size_t kBufferBytes = 1 << 20;

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& target) : target_(target), partial_(target.string() + ".partial") {
  // A new file rather than an old one made empty: another process may still have the old one open.
  unlink(partial_.c_str());
  descriptor_ = open(partial_.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) ThrowFileError(target_, "cannot be created", errno);
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) close(descriptor_);
  if (!published_) unlink(partial_.c_str());
}

void OutputFile::Append(std::span<const uint8_t> bytes) {
  if (buffer_.size() + bytes.size() > kBufferBytes) Flush();
  if (bytes.size() >= kBufferBytes) {
    Write(bytes, written_);
    written_ += bytes.size();
    return;
  }
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
}

void OutputFile::Append(std::string_view text) {
  Append(std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()));
}

void OutputFile::WriteAt(uint64_t offset, std::span<const uint8_t> bytes) {
  Flush();
  SKYQUILT_CHECK(offset + bytes.size() <= written_, "WriteAt beyond the end of " + partial_.string());
  Write(bytes, offset);
}

void OutputFile::AppendContentOf(OutputFile* other) {
  other->Flush();
  std::vector<uint8_t> block(std::min<uint64_t>(8 * kBufferBytes, other->written_));
  for (uint64_t at = 0; at < other->written_;) {
    ThrowIfCancelled();
    const auto wanted = static_cast<size_t>(std::min<uint64_t>(block.size(), other->written_ - at));
    const ssize_t n = pread(other->descriptor_, block.data(), wanted, static_cast<off_t>(at));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) ThrowFileError(other->partial_, "cannot read", errno);
    if (n == 0) throw InputError(other->partial_, "became shorter while it was in use", "Run the command again");
    Append(std::span<const uint8_t>(block.data(), static_cast<size_t>(n)));
    at += static_cast<uint64_t>(n);
  }
}

void OutputFile::Sync() {
  SKYQUILT_CHECK(descriptor_ >= 0, partial_.string() + " was closed before");
  Flush();
  if (fsync(descriptor_) != 0) ThrowFileError(target_, "cannot write to disk", errno);
}

void OutputFile::Complete() {
  if (descriptor_ < 0) return;
  Sync();
  buffer_ = {};
  const int descriptor = descriptor_;
  descriptor_ = -1;
  // Network file systems report some write errors only here.
  if (close(descriptor) != 0) ThrowFileError(target_, "cannot write to disk", errno);
}

void OutputFile::Publish(const std::filesystem::path& target) {
  SKYQUILT_CHECK(descriptor_ < 0, partial_.string() + " is not complete");
  Rename(partial_, target);
  published_ = true;
}

void OutputFile::Flush() {
  if (buffer_.empty()) return;
  Write(buffer_, written_);
  written_ += buffer_.size();
  buffer_.clear();
}

void OutputFile::Write(std::span<const uint8_t> bytes, uint64_t offset) {
  SKYQUILT_CHECK(descriptor_ >= 0, partial_.string() + " was closed before");
  while (!bytes.empty()) {
    const ssize_t n = pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) ThrowFileError(target_, "cannot write", errno);
    bytes = bytes.subspan(static_cast<size_t>(n));
    offset += static_cast<uint64_t>(n);
  }
}

PartialPath::PartialPath(std::filesystem::path target, std::filesystem::path partial) : target_(std::move(target)), partial_(std::move(partial)) {
  std::error_code error;
  std::filesystem::remove_all(partial_, error);
  if (error) ThrowFileError(partial_, "is of an earlier call and cannot be removed", error.value());
}

PartialPath::~PartialPath() {
  std::error_code ignored;
  if (!published_) std::filesystem::remove_all(partial_, ignored);
}

void PartialPath::Publish() {
  base::Publish(partial_, target_);
  published_ = true;
}

}  // namespace skyquilt::base
