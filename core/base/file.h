// Reads and writes whole files, and turns system errors into messages with advice. Writing is atomic, so that a killed or failed run never leaves
// half a file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace skyquilt::base {

// Throws InputError if the file cannot be read.
std::string ReadFile(const std::filesystem::path& file);
// Writes a temporary file in the same folder, fsyncs it, renames it to `file` and fsyncs the folder: at any moment `file` has its old or its new
// content. Throws InputError (disk full, no permission); the old file is then untouched.
void WriteFileAtomically(const std::filesystem::path& file, std::string_view content);
// Gives a file or a folder another name on the same disk in one step; replaces a file by a file, and an empty folder by a folder. Throws InputError
// that names `to`; both are then untouched.
void Rename(const std::filesystem::path& from, const std::filesystem::path& to);
// The same for what is complete: waits until it is on disk before, and until its name is afterwards.
void Publish(const std::filesystem::path& from, const std::filesystem::path& to);
// Waits until a file or a folder is on disk (fsync). Throws InputError.
void SyncPath(const std::filesystem::path& path);
// Creates the folder (and its parents) and checks with a test file that it can be written. Throws InputError with advice.
void RequireWritableFolder(const std::filesystem::path& folder);
// 64-bit FNV-1a hash of the bytes as 16 hex digits. Used to notice changed configurations; not safe against attackers.
std::string HashHex(std::string_view bytes);
// Throws InputError for a failed system call: file, finding, the system's message for the errno `code`, and how to fix it.
[[noreturn]] void ThrowFileError(const std::filesystem::path& file, const std::string& finding, int code);

}  // namespace skyquilt::base
