// Whole-file reading and atomic writing.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace skyquilt::base {

// Throws InputError if the file cannot be read.
std::string ReadFile(const std::filesystem::path& file);
// Writes beside, fsyncs, renames, fsyncs the folder: the file is complete or absent. Throws InputError (disk full, no permission).
void WriteFileAtomically(const std::filesystem::path& file, std::string_view content);
// fsyncs a file or a folder. Throws InputError.
void SyncPath(const std::filesystem::path& path);
// Creates the folder (and parents) and proves it writable. Throws InputError with how to fix it.
void RequireWritableFolder(const std::filesystem::path& folder);
// 64-bit FNV-1a of the bytes as 16 hex digits: identity of configurations, not a defence against attackers.
std::string HashHex(std::string_view bytes);
// Throws InputError: file, finding, the system's words for the error number `code`, and how to fix it.
[[noreturn]] void ThrowFileError(const std::filesystem::path& file, const std::string& finding, int code);

}  // namespace skyquilt::base
