// Reads members of JSON objects that may be missing or of another kind, as in files of other versions.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>

namespace skyquilt::evaluate {

// Null where a key is missing, and for what is not an object.
inline const nlohmann::ordered_json& MemberAt(const nlohmann::ordered_json& json, const char* key) {
  static const nlohmann::ordered_json kNone;
  const auto found = json.is_object() ? json.find(key) : json.end();
  return found == json.end() ? kNone : *found;
}

// The value stays as it is where there is none of its kind.
template <typename T>
void TakeValue(const nlohmann::ordered_json& json, const char* key, T* value) {
  const nlohmann::ordered_json& member = MemberAt(json, key);
  const bool of_kind = std::is_same_v<T, std::string> ? member.is_string()
                       : std::is_same_v<T, bool>      ? member.is_boolean()
                       : std::is_integral_v<T>        ? member.is_number_integer()
                                                      : member.is_number();
  if (of_kind) *value = member.get<T>();
}

}  // namespace skyquilt::evaluate
