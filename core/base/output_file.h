// Files and folders that are either complete or missing under their final name: they are made as <name>.partial and renamed when complete.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace skyquilt::base {

// A file that is written piece by piece, so that memory does not grow with it.
class OutputFile {
 public:
  // Replaces an older partial file. Throws InputError, as do all other functions (disk full, no permission).
  explicit OutputFile(const std::filesystem::path& target);
  ~OutputFile();  // removes the partial file unless it was published
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void Append(std::span<const uint8_t> bytes);
  void Append(std::string_view text);
  // Replaces bytes that were appended before.
  void WriteAt(uint64_t offset, std::span<const uint8_t> bytes);
  // Appends all that the other file holds so far. Throws Interrupted when cancelled.
  void AppendContentOf(OutputFile* other);
  uint64_t size() const { return written_ + buffer_.size(); }

  // Waits until everything so far is on disk. Called now and then while a large file grows, it spares Complete a long wait.
  void Sync();
  // Waits until everything is on disk and closes the file; nothing may be appended afterwards.
  void Complete();
  // Gives the complete file its name.
  void Publish() { Publish(target_); }
  void Publish(const std::filesystem::path& target);

 private:
  void Flush();
  void Write(std::span<const uint8_t> bytes, uint64_t offset);

  std::filesystem::path target_;
  std::filesystem::path partial_;
  int descriptor_ = -1;
  bool published_ = false;
  uint64_t written_ = 0;
  std::vector<uint8_t> buffer_;
};

// A file or a folder that other programs and libraries write; OutputFile and WriteFileAtomically are for files of our own.
class PartialPath {
 public:
  // Removes what a killed process has left. partial: beside the target. Throws InputError when that cannot be removed.
  PartialPath(std::filesystem::path target, std::filesystem::path partial);
  // <target>.partial.
  explicit PartialPath(const std::filesystem::path& target) : PartialPath(target, target.string() + ".partial") {}
  ~PartialPath();  // removes it unless it was published
  PartialPath(const PartialPath&) = delete;
  PartialPath& operator=(const PartialPath&) = delete;

  const std::filesystem::path& path() const { return partial_; }
  // As base::Publish.
  void Publish();

 private:
  std::filesystem::path target_, partial_;
  bool published_ = false;
};

}  // namespace skyquilt::base
