// The first 512 bytes of an archive: plain text with the kind of file, and the length and digest by which damage is found.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace skyquilt::checkpoint {

inline constexpr size_t kUserBlockBytes = 512;

struct FileGuard {
  uint64_t n_bytes = 0;  // length of the whole file, user block included
  uint64_t digest = 0;   // XXH64 of the bytes after the user block
};

// Reads the whole file once. Throws base::InputError if it cannot be read.
FileGuard MeasureFile(const std::filesystem::path& file);
// Exactly kUserBlockBytes bytes.
std::string UserBlockText(const std::string& kind, int version, const FileGuard& guard);
// Overwrites the first bytes of the file. Throws base::InputError.
void WriteUserBlock(const std::filesystem::path& file, const std::string& text);
// Reads the block and compares its length and digest with the file; returns its text, and *guard as measured.
// Throws base::InputError: missing, not an archive, written by a newer program, truncated, damaged.
std::string VerifiedUserBlock(const std::filesystem::path& file, FileGuard* guard);

}  // namespace skyquilt::checkpoint
