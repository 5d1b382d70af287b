// Files of an exported tour as scripts: what a page may not fetch from file://, it may load as a classic script. Each calls
// skyquiltData("NAME", "BASE64"), with the bytes of one file in base64 (RFC 4648, with padding).
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace skyquilt::tour {

// Names are paths below data/: letters, digits, '_', '-', '.' and '/', which need no escapes. Throws std::logic_error for others.
void RequireDataName(std::string_view name);
// Of the script with a file of so many bytes.
int64_t ScriptBytes(std::string_view name, int64_t bytes);
// "<folder>/NAME.js".
std::filesystem::path ScriptFile(const std::filesystem::path& folder, std::string_view name);

// Write the script below the folder; it is complete or absent. Return its bytes. Throw base::InputError (disk full, no permission).
int64_t WriteScript(const std::filesystem::path& folder, std::string_view name, std::string_view content);
// The same for the content of a file, of which only a piece is in memory at a time. Throws base::Interrupted between pieces.
int64_t WriteScriptOf(const std::filesystem::path& folder, std::string_view name, const std::filesystem::path& file);

std::string Base64(std::string_view bytes);

}  // namespace skyquilt::tour
