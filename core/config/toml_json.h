// TOML files that are no configurations of the program.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace skyquilt::config {

// As JSON: tables are objects; dates, infinite numbers and NaN are texts. Throws base::InputError for a file that cannot be read or parsed (with the
// line).
nlohmann::json TomlAsJson(const std::filesystem::path& file);

}  // namespace skyquilt::config
