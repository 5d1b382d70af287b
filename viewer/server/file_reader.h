// Reads a file piece by piece, for sending.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace skyquilt::viewer::server {

class FileReader {
 public:
  // Nothing when there is no such regular file or it cannot be read.
  static std::optional<FileReader> Open(const std::filesystem::path& file);
  ~FileReader();
  FileReader(FileReader&& other) noexcept;
  FileReader& operator=(FileReader&& other) noexcept;

  // Bytes not read yet, by the size that the file had when it was opened.
  uint64_t left() const { return left_; }
  // The next bytes, at most 64 KiB. False on an error, also when the file has become shorter.
  bool Read(std::string& bytes);

 private:
  FileReader(int descriptor, uint64_t left) : descriptor_(descriptor), left_(left) {}
  int descriptor_ = -1;
  uint64_t left_ = 0;
};

}  // namespace skyquilt::viewer::server
