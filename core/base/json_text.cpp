#include "core/base/json_text.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace skyquilt::base {

nlohmann::json ParseJson(std::string_view text) {
  return nlohmann::json::parse(text);
}

nlohmann::ordered_json ParseOrderedJson(std::string_view text) {
  return nlohmann::ordered_json::parse(text);
}

nlohmann::json TryParseJson(std::string_view text) {
  return nlohmann::json::parse(text, nullptr, false);
}

std::string JsonText(const nlohmann::json& value, int indent) {
  return value.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string JsonText(const nlohmann::ordered_json& value, int indent) {
  return value.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

nlohmann::ordered_json NumberOrNull(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

double NanIfNull(const nlohmann::json& value) {
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

}  // namespace skyquilt::base
