// TOML without the options of the program: files that are no configurations, and which keys a configuration names.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace skyquilt::config {

// As JSON: tables are objects; dates, infinite numbers and NaN are texts. Throws base::InputError for a file that cannot be read or parsed (with the
// line).
nlohmann::json TomlAsJson(const std::filesystem::path& file);
// The same of a text; origin: its name for messages.
nlohmann::json TomlTextAsJson(const std::string& text, const std::string& origin);

}  // namespace skyquilt::config
