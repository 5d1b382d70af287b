// The first 512 bytes of an archive: plain text that names the kind, and guards the bytes behind it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace skyquilt::checkpoint {

inline constexpr size_t kUserBlockBytes = 512;

struct FileGuard {
  uint64_t n_bytes = 0;  // of the whole file, user block included
  uint64_t digest = 0;   // of the bytes behind the user block
};

// Reads the whole file once. Throws base::InputError if it cannot be read.
FileGuard MeasureFile(const std::filesystem::path& file);
// Exactly kUserBlockBytes bytes.
std::string UserBlockText(const std::string& kind, int version, const FileGuard& guard);
// Writes it over the file's first bytes. Throws base::InputError.
void WriteUserBlock(const std::filesystem::path& file, const std::string& text);
// The block as stored, after comparing length and digest with the file's bytes.
// Throws base::InputError: missing, foreign, written by a newer program, cut off, damaged.
std::string VerifiedUserBlock(const std::filesystem::path& file, FileGuard* guard);

}  // namespace skyquilt::checkpoint
