// JSON to text and back, compiled once: each file that calls nlohmann's parser or writer costs seconds of compilation.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace skyquilt::base {

// Throws nlohmann::json::parse_error for what is not JSON.
nlohmann::json ParseJson(std::string_view text);
nlohmann::ordered_json ParseOrderedJson(std::string_view text);
// A discarded value (is_discarded()) for what is not JSON.
nlohmann::json TryParseJson(std::string_view text);

// With line breaks and `indent` spaces per level; -1: on one line. Bytes that are not UTF-8 are replaced.
std::string JsonText(const nlohmann::json& value, int indent = -1);
std::string JsonText(const nlohmann::ordered_json& value, int indent = -1);

// JSON has no NaN and no infinity: null is written instead.
nlohmann::ordered_json NumberOrNull(double value);
// The reverse. Throws nlohmann::json::exception for what is neither.
double NanIfNull(const nlohmann::json& value);

}  // namespace skyquilt::base
